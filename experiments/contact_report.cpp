#include "experiments/contact_report.h"

#include <algorithm>

#include "analysis/limits/penalty_contact.h"
#include "analysis/structure_limits.h"

namespace springstab {
namespace {

const char* name(const ContactModel& model) {
  static constexpr const char* names[] = {"impulses", "inelastic", "penalty"};
  return names[model.index()];
}

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

}  // namespace

Json json_of(const ContactCounts& c) {
  Json json{{"pairs_tested", c.pairs},
            {"impulses", c.impulses},
            {"lifts", c.lifts},
            {"passes", c.passes},
            {"unresolved", c.unresolved},
            {"normal_work", c.normal_work},
            {"friction_work", c.friction_work},
            {"obstacle_work", c.obstacle_work},
            {"largest_rise", c.largest_rise}};
  if (c.surfaces) {
    json["zones"] = c.surfaces->zones;
    json["blocked"] = c.surfaces->blocked;
  }
  if (c.springs) {
    json["contacts"] = c.springs->contacts;
    json["plans"] = c.springs->plans;
  }
  return json;
}

ContactCounts contact_counts_of(const Json& json) {
  ContactCounts counts{json.at("pairs_tested"),  json.at("impulses"),      json.at("lifts"),
                       json.at("passes"),        json.at("unresolved"),    json.at("normal_work"),
                       json.at("friction_work"), json.at("obstacle_work"), json.at("largest_rise")};
  if (json.contains("zones")) counts.surfaces = {json.at("zones"), json.at("blocked")};
  if (json.contains("contacts")) counts.springs = {json.at("contacts"), json.at("plans")};
  return counts;
}

void add_contact(Json& report, const ContactCounts& counts) {
  const Json all = json_of(counts);
  for (const auto& [key, value] : all.items())
    report[value.is_number_integer() ? "counts" : "energy"]["contact"][key] = value;
}

std::string contact_text(const ContactCounts& c, double last_step) {
  if (c.springs) {
    std::string out = text("contact: at most %ld at a particle", c.springs->contacts);
    if (c.springs->plans > 0)
      out += text(", for which steps were planned anew %ld times; the last was %.6g s", c.springs->plans,
                  last_step);
    if (c.friction_work != 0) out += text("; friction took %.4g J", 0 - c.friction_work);
    return out + '\n';
  }
  std::string out = text("contact: %ld impulses, %ld particles put back on a surface; it took %.4g J",
                         c.impulses, c.lifts, 0 - c.normal_work);
  if (c.friction_work != 0) out += text(", friction %.4g J", 0 - c.friction_work);
  if (c.obstacle_work != 0) out += text("; moving obstacles gave %.4g J", c.obstacle_work);
  if (c.unresolved > 0)
    out += text("; %ld times ", c.unresolved) +
           (c.surfaces ? "they did not settle" : "obstacles left a particle no room");
  if (c.surfaces && c.surfaces->zones > 0)
    out += text("; %ld times particles had to move as one", c.surfaces->zones);
  return out + '\n';
}

bool is_proved(const Contact& contact, const std::string& method) {
  const auto proved = [](const Obstacle& o) { return is_flat(o) && o.velocity.isZero(0); };
  return method == "symplectic-euler" && !contact.has_surfaces() &&
         std::holds_alternative<LandingImpulses>(contact.model) &&
         std::all_of(contact.obstacles.begin(), contact.obstacles.end(), proved);
}

ContactLimits::ContactLimits(Subject& subject, const State<Vector>& start,
                             const std::vector<std::string>& methods, double safety)
    : contact_(*subject.contact()) {
  for (const std::string& method : methods)
    (is_proved(contact_, method) ? proved_ : measured_).push_back(method);
  if (subject.counts_contacts()) contacts_ = subject.contacts(start.x);
  const auto bound = subject.contact_bound(contacts_.value_or(1));
  if (bound)
    any_contact_ = StructureLimits(in_any_contact(subject.structure(start), *bound),
                                   {.safety = safety, .certify = true, .seed = 1})
                       .limits("symplectic-euler")
                       .h_certified;
}

Json ContactLimits::json() const {
  Json json{{"model", name(contact_.model)},
            {"obstacles", contact_.obstacles.size() + contact_.meshes.size()},
            {"thickness", contact_.thickness},
            {"friction", contact_.friction},
            {"proved", proved_},
            {"measured", measured_}};
  if (contact_.self) json["self"] = true;
  if (std::holds_alternative<Penalty>(contact_.model))
    json["any_contact"] = {{"method", "symplectic-euler"}, {"h_certified", number(any_contact_)}};
  if (contacts_) json["any_contact"]["contacts"] = *contacts_;
  return json;
}

std::string ContactLimits::text_of() const {
  std::string out;
  if (std::holds_alternative<Penalty>(contact_.model)) {
    out = "\ncontact by springs: these limits are for the contact there is at the state given";
    if (any_contact_) out += text("; symplectic-euler is stable below %.6g s in any contact", *any_contact_);
    if (any_contact_ && contacts_)
      out += text(" with at most %ld at a particle, while normals and weights stay", *contacts_);
    if (any_contact_) out += ": proved";
    return out + '\n';
  }
  const std::string model = std::string("\ncontact (") + name(contact_.model) + "): ";
  if (!proved_.empty())
    out += model +
           "proved, at every step below its limit contact never raises the energy: " + joined(proved_) + '\n';
  if (!measured_.empty())
    out += model + "measured, no proof that the limit holds in contact: " + joined(measured_) + '\n';
  return out;
}

}  // namespace springstab
