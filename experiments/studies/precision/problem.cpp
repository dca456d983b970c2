#include "experiments/studies/precision/problem.h"

#include "experiments/runs/measured_run.h"
#include "solvers/io/input_error.h"

namespace springstab {

Problem::Problem(std::string title, Subject subject, double duration, const CommonOptions& common)
    : title_(std::move(title)), subject_(std::move(subject)), duration_(duration) {
  start_ = subject_->initial_state(common.seed);
  watch_ = subject_->energy_watch(start_);
  structure_ = subject_->structure(start_);
  damping_ = subject_->damping();
  if (damping_.kind == DampingModel::Kind::designed)
    throw InputError("damping", 0,
                     "'designed' leaves open which motion is the true one, expected a number for alpha");
  prepare(common);
}

Problem::Problem(std::string title, SpringChain chain, const Vector& x, double duration,
                 const CommonOptions& common)
    : title_(std::move(title)),
      chain_(std::make_unique<SpringChain>(std::move(chain))),
      duration_(duration),
      start_{x, Vector::Zero(x.size())} {
  watch_.initial_energy = watch_.initial_total = chain_->potential_energy(x);
  structure_ = chain_->matrices();
  const auto [d0, alpha] = chain_->damping();
  damping_ = {d0 == 0 && alpha == 0 ? DampingModel::Kind::none : DampingModel::Kind::rayleigh, d0, alpha};
  prepare(common);
}

void Problem::prepare(const CommonOptions& common) {
  seed_ = common.seed;
  const double before = cpu_seconds();
  k0_ = estimated_stiffest_mode(structure_, {.seed = common.seed});
  set_up_seconds_ = cpu_seconds() - before;
}

System& Problem::system() {
  if (chain_) return *chain_;
  return subject_->system();
}

void Problem::design_damping() {
  if (subject_) subject_->design_damping();
  designed_ = true;
}

void Problem::set_alpha(double alpha) {
  if (chain_)
    chain_->set_damping({damping_.d0, alpha});
  else
    subject_->set_alpha(alpha);
}

void Problem::set_damping_for(std::string_view method, double h) {
  if (designed_) set_alpha(designed_alpha(stability_region(method), h, damping_.d0));
}

void Problem::set_own_damping() {
  if (designed_) set_alpha(damping_.alpha);
}

std::optional<double> Problem::limit(std::string_view method) {
  if (!k0_.converged) return std::nullopt;
  if (designed_) return springstab::design_damping(stability_region(method), k0_.value, damping_.d0).h_max;
  const bool general = damping_.kind == DampingModel::Kind::general;
  if (general && !general_damping_)
    general_damping_ =
        std::make_unique<GeneralDamping>(structure_, k0_, damping_, 1, false, ArpackOptions{.seed = seed_});
  const MethodLimits limits =
      general ? general_damping_->limits(method) : method_limits(method, k0_, damping_, 1);
  if (limits.status == LimitStatus::unknown) return std::nullopt;
  if (limits.status == LimitStatus::unlimited) return std::numeric_limits<double>::infinity();
  return limits.h_max.value_or(0);
}

}  // namespace springstab
