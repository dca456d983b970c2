// What limits, simulate and --explain say of contact.
#pragma once

#include <string>
#include <vector>

#include "experiments/command/output.h"
#include "experiments/inputs/subject.h"
#include "solvers/contact/contact_filter.h"

namespace springstab {

/// The counts of a run, for a checkpoint.
Json json_of(const ContactCounts& counts);
ContactCounts contact_counts_of(const Json& json);

/// `counts.contact` and `energy.contact` of a run's report, which has `counts` and `energy` already.
void add_contact(Json& report, const ContactCounts& counts);
/// The same for people. `last_step`: of the run [s].
std::string contact_text(const ContactCounts& counts, double last_step);

/// Whether contact leaves the method's limit as it is, by proof (solvers/contact/impulses.h); else it was
/// measured.
bool is_proved(const Contact& contact, const std::string& method);

/// What `limits` says of contact: the model, for which of the methods the limits are proved with it and for
/// which not, and of a penalty (analysis/limits/penalty_contact.h) the step that no contact makes too long.
class ContactLimits {
 public:
  ContactLimits(Subject& subject, const State<Vector>& start, const std::vector<std::string>& methods,
                double safety);
  Json json() const;
  std::string text_of() const;

 private:
  const Contact& contact_;
  std::vector<std::string> proved_, measured_;
  std::optional<long> contacts_;       // of surfaces at a particle, of which that is told
  std::optional<double> any_contact_;  // proved for symplectic Euler [s]
};

}  // namespace springstab
