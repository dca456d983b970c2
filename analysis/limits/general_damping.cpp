#include "analysis/limits/general_damping.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "analysis/constants.h"
#include "analysis/limits/split_damping.h"
#include "analysis/spectra/generator_spectrum.h"
#include "analysis/spectra/transition_limit.h"

namespace springstab {
namespace {

constexpr Eigen::Index shift_invert_limit = 20'000;
constexpr double near_enough = 0.9;  // certified / estimate
const StructuralMatrices unknown_matrices;
constexpr std::string_view no_step = "no positive step is stable";

// The step to which oscillations that grow by themselves are followed, not outgrown: that of their mirror
// images in time, which decay.
double following_step(const Method& method, const std::vector<std::complex<double>>& modes) {
  double h = infinity;
  for (const std::complex<double> mu : modes)
    if (mu.real() > 0 && mu.imag() > 0)
      h = std::min(h, stability_region(method).critical_step(std::norm(mu), 2 * mu.real()));
  return h;
}

StructuralMatrices stiffened(const StructuralMatrices& s, const Stiffening& stiffening) {
  StructuralMatrices stiffer = s;
  stiffer.stiffness *= stiffening.factor;
  if (stiffening.added_damping > 0) stiffer.damping += stiffening.added_damping * s.stiffness;
  return stiffer;
}

}  // namespace

GeneralDamping::GeneralDamping(const StructuralMatrices& s, const StiffestMode& k0,
                               const DampingModel& damping, double safety, bool proofs,
                               const ArpackOptions& options)
    : k0_(k0),
      damping_(damping),
      safety_(safety),
      proofs_(proofs),
      first_gap_(proof_gap(options)),
      s_(s),
      size_(s.size()),
      options_(options),
      certified_(s, options) {
  know_bound();
}

GeneralDamping::GeneralDamping(std::shared_ptr<const ExtremePoints> range, DefinitenessTest proof,
                               double coupling_ratio, const StiffestMode& k0, const DampingModel& damping,
                               double safety, const ArpackOptions& options)
    : k0_(k0),
      damping_(damping),
      safety_(safety),
      proofs_(true),
      first_gap_(proof_gap(options)),
      s_(unknown_matrices),
      size_(std::numeric_limits<Eigen::Index>::max()),
      options_(options),
      certified_(std::move(range), std::move(proof), coupling_ratio) {
  know_bound();
}

// Where K is symmetric a bound on k0 is one for matrices.
void GeneralDamping::know_bound() {
  if (proofs_ && s_.symmetric && k0_.converged && k0_.upper_bound > 0 && std::isfinite(k0_.upper_bound))
    certified_.know(k0_.upper_bound, 0, 1);
}

// One result serves all methods whose eigenvalues follow from the same region in the same way.
MethodLimits GeneralDamping::limits(const Method& method) {
  const StabilityRegion& region = stability_region(method);
  const bool shared = region.matrix_form() != MatrixForm::none && !takes_part(method, s_);
  for (const auto& [other, limits] : known_)
    if (shared && region.matrix_form() == other->matrix_form() && region.same_conditions(*other))
      return limits;
  MethodLimits limits = compute(method);
  keep_margin(safety_, limits);
  if (shared) known_.emplace_back(&region, limits);
  return limits;
}

MethodLimits GeneralDamping::compute(const Method& method) {
  MethodLimits limits = method_limits(method, k0_, damping_, safety_);
  if (!k0_.converged) return limits;
  if (!s_.symmetric) {
    limits = {};
    limits.unproved = "K or D is not symmetric";
  }
  if (takes_part(method, s_)) {
    if (&s_ == &unknown_matrices)
      limits.unproved = "the part of the damping that is implicit is not known apart";
    else if (limits.unproved.empty())
      add_split(method, limits);
    return limits;
  }
  if (!limits.unproved.empty()) {
    add_estimate(method, limits);
    return limits;
  }
  if (limits.status != LimitStatus::unknown) return limits;
  if (stability_region(method).matrix_form() == MatrixForm::none) {
    limits.unproved = "the method's eigenvalues under this damping are not those of scalar modes";
    if (size_ <= transition_limit_rows / method.size()) add_estimate(method, limits);
    add_proved_at_one_step(method, limits);
    return limits;
  }
  if (const std::optional<HalfPlane> condition = stability_region(method).exact_condition()) {
    add_exact(*condition, limits);
  } else {
    add_certified(method, limits);
    if (size_ <= generator_limit) {
      add_estimate(method, limits);
      add_lyapunov(method, limits);
    } else {
      add_estimate_near_boundary(method, limits);
    }
  }
  return limits;
}

std::vector<Stiffening> GeneralDamping::stiffenings() const {
  std::vector<Stiffening> all{{}};
  if (safety_ > 1) all.push_back({safety_, 0});
  if (safety_ > 1 && damping_.alpha > 0) all.push_back({safety_, (safety_ - 1) * damping_.alpha});
  return all;
}

void GeneralDamping::set_certified(std::optional<double> h, Proof proof, MethodLimits& limits) {
  limits.h_certified = h;
  if (h) {
    limits.proof = proof;
    limits.unproved = {};
  } else {
    limits.unproved = s_.size() > SparseCholesky::unknowns_limit
                          ? "there are too many unknowns to factorize a matrix"
                          : "no convex part of the region was proved to hold the damping and stiffness";
  }
}

void GeneralDamping::add_exact(const HalfPlane& condition, MethodLimits& limits) {
  double least = infinity;
  for (const Stiffening& stiffening : stiffenings()) {
    const std::optional<double> h = exact_limit(certified_.range(), condition, stiffening);
    if (!h) return;
    if (!limits.h_max) limits.h_max = *h;
    least = std::min(least, *h);
  }
  limits.status = std::isinf(*limits.h_max) ? LimitStatus::unlimited : LimitStatus::limited;
  if (proofs_)
    set_certified(proved_limit(certified_.proof(), condition, *limits.h_max, first_gap_),
                  Proof::matrix_condition, limits);
  if (std::isfinite(least)) limits.recommended = least;
}

// What is implicit of the damping enters the condition with the other sign.
void GeneralDamping::add_split(const Method& method, MethodLimits& limits) {
  if (!is_semidefinite(implicit_damping(s_, *method.info().implicit_damping), s_.mass)) {
    limits.unproved = "the damping to be taken implicitly is indefinite";
    return;
  }
  const HalfPlane condition = explicit_condition(method);
  double least = infinity;
  for (const Stiffening& stiffening : stiffenings()) {
    const StructuralMatrices s = with_effective_damping(method, stiffened(s_, stiffening));
    const std::optional<double> h = exact_limit(NumericalRange(s, options_), condition, {}, true);
    if (!h) return;
    if (!limits.h_max) {
      limits.h_max = *h;
      DefinitenessProof proof(&s);
      if (proofs_) set_certified(proved_limit(proof.test(), condition, *h), Proof::matrix_condition, limits);
    }
    least = std::min(least, *h);
  }
  limits.status = std::isinf(*limits.h_max) ? LimitStatus::unlimited : LimitStatus::limited;
  if (std::isfinite(least)) limits.recommended = least;
}

void GeneralDamping::add_certified(const Method& method, MethodLimits& limits) {
  if (proofs_) set_certified(certified_.certified(method), Proof::polygon, limits);
  double least = limits.h_certified.value_or(infinity);
  const std::vector<Stiffening> all = stiffenings();
  for (const Stiffening& stiffening : std::span(all).subspan(limits.h_certified ? 1 : 0)) {
    const std::optional<double> h = certified_.estimated(method, stiffening);
    if (!h) return;
    least = std::min(least, *h);
  }
  if (std::isfinite(least)) limits.recommended = least;
}

const std::optional<std::vector<std::complex<double>>>& GeneralDamping::own_spectrum() {
  if (spectra_.empty())
    for (const Stiffening& stiffening : stiffenings()) {
      spectra_.push_back(generator_spectrum(stiffened(s_, stiffening)));
      if (!spectra_.back()) break;
    }
  return spectra_.front();
}

std::optional<double> GeneralDamping::growth() {
  if (size_ > generator_limit || !own_spectrum()) return std::nullopt;
  return growth_rate(*own_spectrum());
}

// The true critical step, from eigenvalues, where there are few enough unknowns; the recommended step then
// is the smallest of such.
void GeneralDamping::add_estimate(const Method& method, MethodLimits& limits) {
  own_spectrum();
  double least = infinity;
  std::vector<double> steps;
  const bool semidefinite = s_.symmetric && !k0_.indefinite && damping_.semidefinite;
  const std::vector<Stiffening> all = stiffenings();
  for (std::size_t i = 0; i < spectra_.size() && spectra_[i]; ++i) {
    if (semidefinite && growth_rate(*spectra_[i]) > 0) return;  // which cannot be: rounding is large
    const bool has_function = stability_region(method).matrix_form() == MatrixForm::stability_function;
    std::optional<double> h = has_function ? critical_step(method, *spectra_[i])
                                           : transition_limit(method, stiffened(s_, all[i]), *spectra_[i]);
    if (h && semidefinite && !has_function) h = std::min(*h, undamped_limit(method, *spectra_[i]));
    if (h == 0 && i == 0) {
      limits.status = LimitStatus::none;
      limits.unproved = no_step;
    }
    if (!h || !(*h > 0)) return;
    steps.push_back(*h);
    least = std::min({least, *h, following_step(method, *spectra_[i])});
  }
  if (steps.size() < all.size()) return;
  limits.h_max = steps.front();
  limits.status = std::isinf(steps.front()) ? LimitStatus::unlimited : LimitStatus::limited;
  limits.source = LimitSource::estimate;
  if (std::isfinite(least)) limits.recommended = least;
  if (limits.h_certified) limits.h_certified = std::min(*limits.h_certified, *limits.h_max);
}

// Of many unknowns only the eigenvalues near those scalar modes of W that bind first. The true limit is not
// larger than theirs, nor smaller than what is proved: an estimate where the two are near each other, else
// nothing.
void GeneralDamping::add_estimate_near_boundary(const Method& method, MethodLimits& limits) {
  if (!limits.h_certified || size_ > shift_invert_limit) return;
  struct Near {
    double limit;  // [s]
    std::complex<double> mu;
  };
  std::vector<Near> shifts;
  for (const ModePoint& p : certified_.outline()) {
    const std::complex<double> root = std::sqrt(std::complex<double>(p.d * p.d - 4 * p.k));
    for (const std::complex<double> mu : {(-p.d + root) / 2.0, (-p.d - root) / 2.0})
      if (mu.imag() >= 0 && std::abs(mu) > 0)
        shifts.push_back({critical_step(method, {mu}, std::abs(mu)).value_or(infinity), mu});
  }
  std::sort(shifts.begin(), shifts.end(), [](const Near& p, const Near& q) { return p.limit < q.limit; });
  constexpr std::size_t most_shifts = 3;
  constexpr Eigen::Index modes_a_shift = 8;
  double least = infinity;
  for (std::size_t i = 0; i < std::min(most_shifts, shifts.size()) && shifts[i].limit < least; ++i) {
    const std::vector<std::complex<double>> modes =
        modes_near(s_, shifts[i].mu, modes_a_shift, {.tolerance = 1e-9, .basis_size = 40, .max_restarts = 6});
    const std::optional<double> h = critical_step(method, modes, std::sqrt(k0_.value));
    if (!h) return;
    least = std::min(least, *h);
  }
  if (!(least >= *limits.h_certified && near_enough * least <= *limits.h_certified)) return;
  limits.h_max = least;
  limits.status = LimitStatus::limited;
  limits.source = LimitSource::estimate;
}

// Of methods whose eigenvalues here are not those of scalar modes: where the limit is not known, the modes
// only guess a step to be proved.
void GeneralDamping::add_proved_at_one_step(const Method& method, MethodLimits& limits) {
  if (!proofs_ || !method.has_magnitude()) return;
  if (size_ > LyapunovSteps::unknowns_limit) {
    limits.unproved =
        "the method's eigenvalues under this damping are not those of scalar modes, and there are too many "
        "unknowns for a Lyapunov proof";
    return;
  }
  double least = limits.h_max.value_or(infinity);
  if (!limits.h_max)
    for (const Stiffening& stiffening : stiffenings())
      least = std::min(least, certified_.estimated(method, stiffening).value_or(0));
  if (!std::isfinite(least)) return;
  if (!lyapunov_) lyapunov_.emplace(s_);
  if (const std::optional<double> h = lyapunov_->certified(method, 0, least)) {
    set_certified(h, Proof::lyapunov, limits);
    if (!limits.h_max) limits.recommended = *h;
  } else {
    limits.unproved = "no norm was proved to fall at every step, which none does where a motion is undamped";
  }
}

// Where the polygons prove much less than what is true, and there are few unknowns.
void GeneralDamping::add_lyapunov(const Method& method, MethodLimits& limits) {
  if (!proofs_ || !limits.h_max || size_ > LyapunovSteps::unknowns_limit) return;
  const double known = limits.h_certified.value_or(0);
  if (known > 0.999 * *limits.h_max) return;
  if (!lyapunov_) lyapunov_.emplace(s_);
  if (const std::optional<double> h = lyapunov_->certified(method, known, *limits.h_max)) {
    set_certified(h, Proof::lyapunov, limits);
  } else if (!limits.h_certified && !method.has_magnitude()) {
    limits.unproved =
        "no convex part of the region was proved to hold the damping and stiffness, and a step that asks for "
        "more than accelerations has no Lyapunov proof";
  }
}

}  // namespace springstab
