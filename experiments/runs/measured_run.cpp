#include "experiments/runs/measured_run.h"

#include <fstream>

#include "analysis/method.h"
#include "commit.h"

namespace springstab {
namespace {

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name"))
      if (const auto colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
  return "unknown processor";
}

}  // namespace

Json json_of(const Counts& counts) {
  return {{"force_evaluations", counts.force_evaluations},
          {"hessian_assemblies", counts.hessian_assemblies},
          {"block_products", counts.block_products},
          {"cg_iterations", counts.cg_iterations}};
}

Counts counts_of(const Json& json) {
  return {json.at("force_evaluations"), json.at("hessian_assemblies"), json.at("block_products"),
          json.at("cg_iterations")};
}

std::string provenance() {
  return processor() + "; " SPRINGSTAB_COMPILER "; springstab " SPRINGSTAB_VERSION ", " SPRINGSTAB_COMMIT;
}

MeasuredRun measured_run(System& system, std::string_view method, const StepPlan& plan,
                         const EnergyWatch& watch, const State<Vector>& start, const Observer& observe,
                         const StepPolicy& policy, StepFilter* filter, const UnseenUntil& unseen_until) {
  CountingSystem counted(system);
  const auto stepper = Method(method).stepper();
  MeasuredRun run;
  run.end = start;
  const double before = cpu_seconds();
  run.result = simulate(counted, *stepper, plan, watch, run.end, observe, policy, filter, unseen_until);
  run.cpu_seconds = cpu_seconds() - before;
  run.counts = counted.counts();
  return run;
}

}  // namespace springstab
