// What a run's frames say of it, for the command and for Python.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/diagnosis/growth.h"
#include "analysis/diagnosis/method_of_growth.h"
#include "experiments/command/output.h"
#include "experiments/inputs/run_frames.h"
#include "experiments/inputs/subject.h"

namespace springstab {

struct DiagnosisOptions {
  double h = 0;   // the step [s]
  int every = 1;  // steps from one frame to the next
};

struct Diagnosis {
  enum class Status {
    growing,
    no_growth,
    too_fast  // it blew up, within too few frames for a factor
  };
  Status status = Status::no_growth;
  DiagnosisOptions run;
  Eigen::Index frames = 0, used = 0;  // used: up to the first that is not finite
  std::optional<diagnosis::Growth> growth{};
  std::vector<Eigen::Index> vertices{};                 // the ten with most of the pattern, from 0
  std::vector<double> shares{};                         // of it, in squares
  std::optional<diagnosis::PatternInStructure> seen{};  // by the structure, where one is given

  /// Of a step; nothing where frames are further apart than that and no method fits, which would say how
  /// often it turned between two.
  std::optional<std::complex<double>> factor() const;
  /// The first of the methods, if it fits.
  const diagnosis::MethodOfGrowth* fit() const;
};

/// `model` may be null; `scene` too, where it has no vertices. Throws InputError for frames of another size
/// than the model's, and std::invalid_argument for a step or a number of steps that is not positive.
Diagnosis diagnose(const RunFrames& frames, const DiagnosisOptions& options, Model* model,
                   const Subject* scene, const std::string& source, const std::vector<Method>& methods);

const char* name(Diagnosis::Status status);
/// "alternating", "ringing" or "one sign".
const char* kind_of(std::complex<double> factor);
Json json_of(const Diagnosis& found);

}  // namespace springstab
