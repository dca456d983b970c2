#include "experiments/mpi/limits.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <utility>

#include "analysis/constants.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/inputs/size_report.h"
#include "experiments/limits_report.h"
#include "experiments/mpi/agreement.h"
#include "experiments/mpi/proof.h"
#include "experiments/mpi/range.h"
#include "experiments/mpi/system.h"
#include "solvers/io/input_error.h"
#include "solvers/team.h"

namespace springstab::mpi {
namespace {

// What the work of all ranks took.
struct Cost {
  double assembly = 0, k0 = 0, proofs = 0, methods = 0;  // [s]
  double bytes = 0;                                      // the most that a rank had in memory
};

class Clock {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

double most_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  double bytes = 1024 * static_cast<double>(usage.ru_maxrss);
  MPI_Allreduce(MPI_IN_PLACE, &bytes, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  return bytes;
}

void expect_served(const LimitsOptions& options, const std::vector<Method>& methods) {
  const std::pair<const char*, bool> unserved[] = {
      {"--error", options.error.has_value()},
      {"--frame-rate", options.frame_rate.has_value()},
      {"--substeps", options.substeps != 0},
      {"--for-step", options.for_step.has_value()},
      {"--explain", options.explain},
      {"--mode", !options.mode.empty()},
      {"--implicit-damping-matrix", !options.input.implicit_damping_matrix.empty()}};
  for (const auto& [option, given] : unserved)
    if (given)
      throw InputError(option, 0, "is not served by springstab-mpi, expected springstab limits for it");
  for (const Method& method : methods)
    if (method.info().implicit_damping && *method.info().implicit_damping != DampingPart::all)
      throw InputError("--method", 0,
                       method.name() +
                           " takes a part of the damping implicitly, which is not served by "
                           "springstab-mpi, expected springstab limits for it");
  check(options.input);
  if (!options.input.stiffness.empty() || !is_scene_file(options.input.file)) return;
  if (describe(options.input).contact)
    throw InputError(options.input.file, 0,
                     "has contact, which is not served by springstab-mpi, expected springstab limits for it");
}

// As many as the machine's ranks can have each.
int threads_a_rank(int wanted) {
  MPI_Comm here = MPI_COMM_NULL;
  int count = 1;
  MPI_Comm_split_type(PETSC_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  MPI_Comm_size(here, &count);
  MPI_Comm_free(&here);
  return std::max(1, wanted / count);
}

// Whether K is indefinite, and the bound on k0: what analysis/spectra/spectrum.h does where one has the
// matrices.
void prove(const SlepcRange& range, double loss, DistributedProof& proof, StiffestMode& mode) {
  if (!mode.converged || mode.value == 0) return;
  mode.indefinite = !proof.stiffness_is_semidefinite().value_or(true);
  if (mode.indefinite) mode.lowest = range.lowest();
  const bool by_pieces = proof.pieces() > 0;
  const double scale = std::abs(mode.value);
  const double gap = std::max({mode.residual, 1e-10 * scale, by_pieces ? loss * scale : 0});
  tighten_bound(
      mode, gap, [&](double sigma) { return proof.holds(sigma, 0, 1); },
      [&] { return by_pieces ? BoundKind::pieces : BoundKind::inertia; });
}

// Nothing beyond the size that MUMPS is asked of.
std::optional<long> second_opinion(const System& system, const StiffestMode& mode) {
  if (!mode.converged || mode.bound_kind == BoundKind::gershgorin) return std::nullopt;
  const std::optional<long> above = eigenvalues_above(mode.upper_bound, system);
  if (above.value_or(0) > 0)
    throw std::logic_error(std::to_string(*above) + " eigenvalues are above the bound on k0, as MUMPS finds");
  return above;
}

Json ranks_json(const Cost& cost, long pieces, const std::optional<long>& above) {
  return {
      {"ranks", ranks()},
      {"pieces", pieces},
      {"eigenvalues_above_bound", above ? Json(*above) : Json()},
      {"seconds",
       {{"assembly", cost.assembly}, {"k0", cost.k0}, {"proofs", cost.proofs}, {"methods", cost.methods}}},
      {"largest_rank_bytes", cost.bytes}};
}

void print_ranks(const Cost& cost, long pieces, const std::optional<long>& above) {
  if (above) std::cout << "\nMUMPS finds no eigenvalue above the bound on k0\n";
  std::cout << text("\n%d %s: assembly %.3g s, k0 %.3g s, proofs %.3g s", ranks(),
                    ranks() == 1 ? "rank" : "ranks", cost.assembly, cost.k0, cost.proofs);
  if (pieces > 0) std::cout << text(" by %ld pieces", pieces);
  std::cout << text(", methods %.3g s; at most %.3g GB a rank\n", cost.methods, cost.bytes / 1e9);
}

void add_scene(const System& system, Json& json) {
  const auto& size = system.scene_size;
  json["extent"] = size ? Json{size->extent.x(), size->extent.y(), size->extent.z()} : Json();
  json["total_mass"] = size ? number(size->mass) : Json();
  json["springs"] = system.mesh ? Json(size->springs) : Json();
}

std::string scene_text(const System& system) {
  if (system.mesh) return size_text(*system.mesh);
  if (!system.scene_size) return {};
  const SceneSize& size = *system.scene_size;
  return text("%.4g x %.4g x %.4g m, %.4g kg", size.extent.x(), size.extent.y(), size.extent.z(), size.mass);
}

std::unique_ptr<GeneralDamping> general_damping(const System& system, std::shared_ptr<const SlepcRange> range,
                                                DistributedProof& proof, const StiffestMode& mode,
                                                double safety) {
  if (system.model.kind != DampingModel::Kind::general) return nullptr;
  const double tolerance = range->tolerance();
  return std::make_unique<GeneralDamping>(
      std::move(range), [&proof](double c, double a, double b) { return proof.holds(c, a, b); },
      proof.coupling_ratio(), mode, system.model, safety, ArpackOptions{.tolerance = tolerance});
}

StructureLimitsOptions wanted_of(const CommonOptions& common, const LimitsOptions& options,
                                 const System& system) {
  StructureLimitsOptions wanted{.safety = options.safety,
                                .seed = common.seed,
                                .digits = options.digits,
                                .certify_loss = options.certify_loss,
                                .max_step = options.max_step};
  if (wanted.digits == 0 && system.size >= many_unknowns) wanted.digits = usual_digits;
  return wanted;
}

void check_mass(const System& system, DistributedProof& proof) {
  if (!system.mass || proof.pieces() > 0 || proof.holds(1, 0, 0)) return;
  together([] {
    throw std::invalid_argument("the mass matrix is not positive definite, expected a positive definite one");
  });
}

void tell(const System& system, StructureLimits& limits, const std::vector<LimitsRow>& rows, double safety,
          const Cost& cost, long pieces, const std::optional<long>& above, bool as_json) {
  const MatricesSize size{system.size};
  if (!as_json) {
    print_limits(std::cout, limits, size, rows, safety, scene_text(system));
    return print_ranks(cost, pieces, above);
  }
  Json json = limits_json(limits, size, rows, safety, system.mesh ? mesh_json(*system.mesh) : Json());
  add_scene(system, json);
  json["mpi"] = ranks_json(cost, pieces, above);
  print_json(json);
}

int answer(const CommonOptions& common, const LimitsOptions& options, const std::vector<Method>& methods) {
  Clock clock;
  Cost cost;
  Waiting waiting("limits", common.quiet || rank() > 0);
  waiting.now("assembly");
  set_loop_threads(1);
  const System system = read_system(options.input);
  if (system.mesh) print_mesh_notes(*system.mesh), print_size_warning(*system.mesh);
  cost.assembly = clock.lap();

  waiting.now("k0");
  const StructureLimitsOptions wanted = wanted_of(common, options, system);
  const auto range = std::make_shared<const SlepcRange>(
      system, search_tolerance(wanted.digits, wanted.k0_tolerance), common.seed);
  StiffestMode mode = range->stiffest_mode();
  cost.k0 = clock.lap();

  waiting.now("proofs");
  set_loop_threads(threads_a_rank(common.threads));
  const double loss = 2 * options.certify_loss;
  DistributedProof proof(system, loss);
  check_mass(system, proof);
  prove(*range, loss, proof, mode);
  const std::optional<long> above = second_opinion(system, mode);
  cost.proofs = clock.lap();

  StructureLimits limits(system.model, wanted, mode,
                         general_damping(system, range, proof, mode, options.safety));
  const std::vector<LimitsRow> rows = rows_of(limits, methods, waiting);
  cost.methods = clock.lap();
  cost.bytes = most_bytes();
  tell(system, limits, rows, options.safety, cost, proof.pieces(), above, common.json);
  return status_of(limits, rows, options);
}

}  // namespace

int run_distributed_limits(const CommonOptions& common, const LimitsOptions& options) {
  check_limits_options(common, options);
  const std::vector<Method> methods = methods_of(options);
  expect_served(options, methods);
  return guarded([&] { return answer(common, options, methods); });
}

}  // namespace springstab::mpi
