#include "experiments/studies/precision/reference.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <stdexcept>

#include "analysis/errors/linear_motion.h"
#include "analysis/gsl/adaptive_integrator.h"
#include "experiments/command/output.h"
#include "experiments/runs/fnv1a.h"
#include "experiments/studies/precision/peers.h"
#include "experiments/studies/precision/scales.h"
#include "solvers/cpu_time.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

constexpr Eigen::Index largest_decomposed = 2000;  // unknowns
constexpr double loose = 1e-10, tight = 1e-12, third = 1e-13;
constexpr double check_seconds = 120;  // CPU

bool has_modes(Problem& problem) {
  return problem.is_linear() && problem.damping().kind != DampingModel::Kind::general &&
         problem.system().size() <= largest_decomposed;
}

Trajectory by_modes(const Problem& problem, std::uint64_t seed) {
  const LinearMotion motion(problem.matrices(), problem.damping().d0, problem.damping().alpha,
                            problem.start(), seed);
  Trajectory trajectory{problem.start()};
  for (double t : sample_times(problem)) trajectory.push_back(motion.at(t));
  return trajectory;
}

Trajectory integrated(Problem& problem, double tolerance, double seconds) {
  const double before = cpu_seconds();
  const Scales scales = scales_of(problem);
  AdaptiveResult result = integrate_adaptively(problem.system(), problem.start(), sample_times(problem),
                                               {.tolerance = tolerance,
                                                .place_scale = scales.place,
                                                .velocity_scale = scales.velocity,
                                                .give_up = [&] { return cpu_seconds() - before > seconds; }});
  if (!result.finished)
    throw InputError(
        "--duration", 0,
        text("is %g s, expected less: the reference could not be integrated to its end", problem.duration()));
  result.at.insert(result.at.begin(), problem.start());
  return std::move(result.at);
}

// Errors are relative to the motion; where there is none but rounding they say nothing.
void expect_motion(Problem& problem, const Trajectory& trajectory) {
  double farthest = 0;
  for (const State<Vector>& s : trajectory)
    farthest = std::max(farthest, (s.x - problem.start().x).cwiseAbs().maxCoeff());
  if (!(farthest > 1e-12 * scales_of(problem).place))
    throw InputError("--duration", 0,
                     text("nothing moves in %g s, expected motion to tell errors from", problem.duration()));
}

std::optional<Errors> check([[maybe_unused]] Problem& problem, [[maybe_unused]] const Trajectory& reference) {
#ifdef SPRINGSTAB_ODEINT
  const Attempt attempt = attempt_bulirsch_stoer(problem, third, check_seconds);
  if (attempt.outcome == Outcome::finished) return errors_of(problem.system(), attempt.trajectory, reference);
#endif
  return std::nullopt;
}

Reference compute(Problem& problem, const ReferenceOptions& options) {
  const bool modes = has_modes(problem);
  Reference reference;
  reference.method = modes ? "closed form, mode by mode" : "GSL rk8pd, tolerances 1e-10 and 1e-12";
  reference.trajectory = modes ? by_modes(problem, 0) : integrated(problem, tight, options.seconds);
  expect_motion(problem, reference.trajectory);
  const Trajectory other = modes ? by_modes(problem, 1) : integrated(problem, loose, options.seconds);
  reference.error = errors_of(problem.system(), other, reference.trajectory);
  // No phase √k0 t is known better than to its rounding, even if both computations round alike.
  const double rounding = std::numeric_limits<double>::epsilon() *
                          (1 + std::sqrt(std::max(problem.k0(), 0.)) * problem.duration());
  for (double* e : {&reference.error.position, &reference.error.velocity, &reference.error.trajectory,
                    &reference.error.energy})
    *e = std::max(*e, rounding);
  if (options.checked) reference.check = check(problem, reference.trajectory);
  return reference;
}

// The file is for one kind of machine only, which a cache is anyway.
constexpr char magic[] = "springstab reference 3\n";

void write(const std::string& path, const Reference& reference) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  const auto put = [&](const void* data, std::size_t bytes) {
    out.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
  };
  put(magic, sizeof magic);
  put(&reference.error, sizeof reference.error);
  const bool checked = reference.check.has_value();
  const Errors check = reference.check.value_or(Errors());
  put(&checked, sizeof checked);
  put(&check, sizeof check);
  for (const State<Vector>& s : reference.trajectory)
    for (const Vector* u : {&s.x, &s.v}) put(u->data(), sizeof(double) * static_cast<std::size_t>(u->size()));
  file.commit();
}

bool read(const std::string& path, Eigen::Index size, Reference& reference) {
  std::ifstream in(path, std::ios::binary);
  const auto get = [&](void* data, std::size_t bytes) {
    in.read(static_cast<char*>(data), static_cast<std::streamsize>(bytes));
    return in.good();
  };
  char found[sizeof magic];
  if (!get(found, sizeof found) || std::memcmp(found, magic, sizeof magic) != 0) return false;
  bool checked = false;
  Errors check;
  if (!get(&reference.error, sizeof reference.error) || !get(&checked, sizeof checked) ||
      !get(&check, sizeof check))
    return false;
  if (checked) reference.check = check;
  reference.trajectory.resize(trajectory_samples + 1);
  for (State<Vector>& s : reference.trajectory)
    for (Vector* u : {&s.x, &s.v}) {
      u->resize(size);
      if (!get(u->data(), sizeof(double) * static_cast<std::size_t>(size))) return false;
    }
  return in.peek() == std::ifstream::traits_type::eof();
}

}  // namespace

bool Errors::all_finite() const {
  return std::isfinite(position) && std::isfinite(velocity) && std::isfinite(trajectory) &&
         std::isfinite(energy);
}

Errors errors_of(System& system, const Trajectory& run, const Trajectory& reference) {
  if (run.size() != reference.size() || run.empty())
    throw std::invalid_argument("trajectories of different lengths cannot be compared");
  const auto squared = [&](const Vector& u) { return 2 * system.kinetic_energy(u); };
  double farthest = 0, fastest = 0, all = 0, off = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const double away = squared(reference[i].x - reference[0].x);
    farthest = std::max(farthest, away);
    fastest = std::max(fastest, squared(reference[i].v));
    all += away;
    off += squared(run[i].x - reference[i].x);
  }
  const State<Vector>&end = run.back(), &true_end = reference.back();
  const double energy = system.kinetic_energy(end.v) + system.potential_energy(end.x);
  const double true_energy = system.kinetic_energy(true_end.v) + system.potential_energy(true_end.x);
  return {std::sqrt(squared(end.x - true_end.x) / farthest), std::sqrt(squared(end.v - true_end.v) / fastest),
          std::sqrt(off / all), std::abs(energy - true_energy) / (fastest / 2)};
}

std::vector<double> sample_times(const Problem& problem) {
  std::vector<double> times;
  for (int i = 1; i <= trajectory_samples; ++i) times.push_back(problem.duration() * i / trajectory_samples);
  return times;
}

Scales scales_of(const Problem& problem) {
  const State<Vector>& start = problem.start();
  const double place = start.x.cwiseAbs().maxCoeff();
  return {place, std::max(start.v.cwiseAbs().maxCoeff(), place / problem.duration())};
}

std::string fingerprint(Problem& problem) {
  System& system = problem.system();
  Fnv1a hash;
  hash.add(problem.duration());
  hash.add(static_cast<double>(trajectory_samples));
  const Scales scales = scales_of(problem);
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  State<Vector> state = problem.start();
  Vector a;
  for (double size : {0., 1e-3, 0.1}) {
    for (double& x : state.x) x += size * scales.place * uniform(engine);
    for (double& v : state.v) v += size * scales.velocity * uniform(engine);
    system.acceleration(state.x, state.v, a);
    hash.add(state.x);
    hash.add(state.v);
    hash.add(a);
    hash.add(system.kinetic_energy(state.v));
    hash.add(system.potential_energy(state.x));
  }
  return hash.hex();
}

Reference reference_motion(Problem& problem, const std::string& cache, const ReferenceOptions& options) {
  problem.set_own_damping();
  if (cache.empty()) return compute(problem, options);
  make_folder(cache);
  const std::string path = cache + "/" + fingerprint(problem);
  Reference reference;
  reference.method =
      has_modes(problem) ? "closed form, mode by mode" : "GSL rk8pd, tolerances 1e-10 and 1e-12";
  if (read(path, problem.system().size(), reference)) return reference;
  reference = compute(problem, options);
  write(path, reference);
  return reference;
}

}  // namespace springstab
