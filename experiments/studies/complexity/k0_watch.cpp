#include "experiments/studies/complexity/k0_watch.h"

#include <algorithm>
#include <stdexcept>

#include "analysis/spectra/power_iteration.h"
#include "analysis/spectra/spectrum.h"
#include "experiments/command/output.h"
#include "experiments/runs/step_run.h"
#include "solvers/cpu_time.h"

namespace springstab {
namespace {

double largest_stretch(Subject& subject, const State<Vector>& rest, const State<Vector>& state) {
  const auto before = subject.vertices(rest.x), now = subject.vertices(state.x);
  double largest = 0;
  for (const std::vector<int>& face : subject.faces())
    for (std::size_t c = 0; c < face.size(); ++c) {
      const int i = face[c], j = face[(c + 1) % face.size()];
      largest = std::max(largest, (now[i] - now[j]).norm() / (before[i] - before[j]).norm());
    }
  return largest;
}

// Leaves the vector found in `start`.
K0Search by_power(const LinearOperator& s, double tolerance, std::uint64_t seed, Vector& start) {
  const double before = cpu_seconds();
  const PowerIteration found =
      power_iteration(s, {.tolerance = tolerance, .seed = seed, .start = std::move(start)});
  start = found.vector;
  return {found.converged, found.value, found.products, cpu_seconds() - before};
}

K0Search by_arpack(const LinearOperator& s, double tolerance, std::uint64_t seed, Vector& start) {
  const double before = cpu_seconds();
  const SymmetricEigenpairs found = largest_eigenpairs(
      s, 1, {.tolerance = tolerance, .basis_size = 20, .seed = seed, .start = std::move(start)});
  if (found.converged) start = found.vectors.col(0);
  return {found.converged, found.converged ? found.values[0] : 0.0, found.products, cpu_seconds() - before};
}

}  // namespace

std::vector<Moment> moments_of(const Drape& drape, const std::string& method, double duration, int count,
                               const CommonOptions& common) {
  Subject subject(describe(drape));
  subject.scene()->set_hessian(Hessian::projected);
  SimulateOptions options;
  options.method = method;
  options.duration = duration;
  StepChooser chooser(subject, step_options(common, options));
  const std::optional<StepPlan> plan = chooser.first_plan();
  if (!plan) throw std::runtime_error("a drape cannot start: " + reason_text(chooser));
  MomentsOfRun run = moments_of(subject, chooser, *plan, duration, count, common);
  if (!run.done) throw std::runtime_error(text("a drape by %s ended at %g s", method.c_str(), run.time));
  return std::move(run.moments);
}

std::vector<K0Sample> watch_k0(const Drape& drape, const std::vector<Moment>& moments, double tolerance,
                               const CommonOptions& common) {
  Subject subject(describe(drape));
  const State<Vector> rest = subject.scene()->rest_state();
  std::vector<K0Sample> samples;
  Vector power, arpack;  // found last
  for (const Moment& moment : moments) {
    const StructuralMatrices structure = subject.structure(moment.state).matrices;
    const LinearOperator s = scaled_stiffness(structure);
    const SymmetricEigenpairs reference =
        largest_eigenpairs(s, 1, {.tolerance = 1e-9, .seed = common.seed, .start = arpack});
    if (!reference.converged) throw std::runtime_error(text("k0 at %g s did not converge", moment.time));
    K0Sample& sample = samples.emplace_back();
    sample.time = moment.time;
    sample.k0 = reference.values[0];
    sample.stretch = largest_stretch(subject, rest, moment.state);
    Vector cold_power, cold_arpack;
    sample.searches = {
        by_power(s, tolerance, common.seed, cold_power), by_power(s, tolerance, common.seed, power),
        by_arpack(s, tolerance, common.seed, cold_arpack), by_arpack(s, tolerance, common.seed, arpack)};
  }
  return samples;
}

}  // namespace springstab
