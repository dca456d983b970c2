// k0 along a drape: how far it rises above its value at the start, which the safety factor has to cover, and
// what it takes to find it again, by the power method (paper §5.3) and by ARPACK, from a random vector and
// from the last one found.
#pragma once

#include <array>
#include <vector>

#include "experiments/command/options.h"
#include "experiments/runs/moments.h"
#include "experiments/studies/complexity/drape.h"
#include "solvers/state.h"
#include "solvers/system.h"

namespace springstab {

/// count + 1 moments, evenly spaced from the start to the end, of a drape run by a method with the step that
/// its rule gives it; linearizations are projected. Throws std::runtime_error if the run does not get there.
std::vector<Moment> moments_of(const Drape& drape, const std::string& method, double duration, int count,
                               const CommonOptions& common);

/// The ways to search, in the order of K0Sample::searches.
inline constexpr std::array<const char*, 4> k0_search_names{"power_cold", "power_warm", "arpack_cold",
                                                            "arpack_warm"};

struct K0Search {
  bool converged = false;
  double value = 0;  // [1/s²]
  long products = 0;
  double cpu_seconds = 0;
};

struct K0Sample {
  double time = 0;     // [s]
  double k0 = 0;       // of the exact Hessian, by ARPACK to 1e-9 [1/s²]
  double stretch = 0;  // of the most stretched edge of the mesh: length over that at rest
  std::array<K0Search, 4> searches{};

  double error(const K0Search& search) const { return search.value / k0 - 1; }
};

/// Every search stops at a residual of `tolerance`, relative to k0. The warm ones start cold at the first
/// moment. Throws std::runtime_error if ARPACK finds no reference.
std::vector<K0Sample> watch_k0(const Drape& drape, const std::vector<Moment>& moments, double tolerance,
                               const CommonOptions& common);

}  // namespace springstab
