#include "experiments/studies/precision/problem.h"

#include "experiments/runs/measured_run.h"
#include "solvers/io/input_error.h"

namespace springstab {

Problem::Problem(std::string title, Model model, double duration, const CommonOptions& common)
    : title_(std::move(title)),
      model_(std::move(model)),
      duration_(duration),
      start_(model_.initial_state(common.seed)),
      watch_(model_.energy_watch(start_)),
      damping_(model_.damping()) {
  if (damping_.kind == DampingModel::Kind::designed)
    throw InputError("damping", 0,
                     "'designed' leaves open which motion is the true one, expected a number for alpha");
  limits_.emplace(model_.structure(start_),
                  StructureLimitsOptions{.safety = 1, .certify = false, .seed = common.seed});
  const double before = cpu_seconds();
  limits_->k0();
  set_up_seconds_ = cpu_seconds() - before;
}

void Problem::design_damping() {
  model_.design_damping();
  designed_ = true;
}

void Problem::set_damping_for(std::string_view method, double h) {
  if (designed_) model_.set_alpha(designed_alpha(method, h, damping_.d0));
}

void Problem::set_own_damping() {
  if (designed_) model_.set_alpha(damping_.alpha);
}

std::optional<double> Problem::limit(std::string_view method) {
  const MethodLimits& limits = limits_->limits(method);
  if (designed_ && limits.designed) return limits.designed->h_max;
  if (limits.status == LimitStatus::unknown) return std::nullopt;
  if (limits.status == LimitStatus::unlimited) return std::numeric_limits<double>::infinity();
  return limits.h_max.value_or(0);
}

}  // namespace springstab
