#include "experiments/stiffest_report.h"

#include <cmath>
#include <ostream>

#include "analysis/constants.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

constexpr const char* no_motion =
    "the stiffest mode was not found, expected a symmetric K and something that is stiff";

/// Of symplectic Euler without damping; that of every method goes with 1/√k0.
double step_of(double k0) { return 2 / std::sqrt(k0); }
double unused_part(double bound, double k0) { return 1 - std::sqrt(k0 / bound); }

Json bound_json(const std::optional<double>& bound, double k0) {
  if (!bound) return nullptr;
  return {
      {"k0", number(*bound)}, {"step", number(step_of(*bound))}, {"unused", number(unused_part(*bound, k0))}};
}

}  // namespace

StiffestReport::StiffestReport(const LimitsOptions& options, const CommonOptions& common,
                               StructureLimits& answer, const Subject& subject, const State<Vector>& start)
    : answer_(answer), k0_(answer.k0().value), explain_(options.explain) {
  const bool asked = options.explain || !options.mode.empty();
  const StructuralMatrices& s = answer.structure().matrices;
  if (!answer.k0().converged || !(asked || (common.json && s.size() < many_unknowns))) return;
  numbers_ = subject.scene() ? subject.vertex_numbers() : subject.particle_numbers();
  motion_ = stiffest_motion(s, subject.elements(start.x), {.seed = common.seed});
  if (options.mode.empty()) return;
  if (!motion_) throw InputError("--mode", 0, no_motion);
  write_mode(options.mode, subject, start);
}

std::vector<long> StiffestReport::numbers_of(const Carrier& carrier) const {
  std::vector<long> numbers;
  for (const int particle : carrier.particles)
    numbers.push_back(numbers_[static_cast<std::size_t>(particle)]);
  return numbers;
}

void StiffestReport::add_to(Json& json) const {
  json["stiffest"] = json["cheap_bounds"] = Json();
  if (!motion_) return;
  json["stiffest"] = Json::array();
  for (const Carrier& each : motion_->carriers) {
    const std::vector<long> numbers = numbers_of(each);
    const bool unknown = each.kind == "unknown";
    json["stiffest"].push_back({{"kind", each.kind},
                                {"index", unknown ? numbers.front() : each.index},
                                {"share", number(each.share)},
                                {"vertices", unknown ? Json() : Json(numbers)},
                                {"stiffness", number(each.stiffness)},
                                {"mass", number(each.mass)}});
  }
  json["cheap_bounds"] = {{"nodal", bound_json(motion_->nodal, k0_)},
                          {"element", bound_json(motion_->element, k0_)}};
}

void StiffestReport::print(std::ostream& out) const {
  if (!explain_) return;
  if (!motion_) {
    out << '\n' << no_motion << '\n';
    return;
  }
  out << text(
      "\nthe stiffest mode, k0 = %.6g 1/s²: most of its energy is in\n%-10s %10s %9s %16s %12s   %s\n", k0_,
      "", "number", "share", "stiffness [N/m]", "mass [kg]", "between");
  for (const Carrier& each : motion_->carriers) {
    std::string vertices;
    const bool unknown = each.kind == "unknown";
    const std::vector<long> numbers = numbers_of(each);
    for (const long v : numbers) vertices += (vertices.empty() ? "" : " ") + std::to_string(v);
    out << text("%-10s %10ld %8.3f%% %16.6g %12.4g   %s\n", std::string(each.kind).c_str(),
                unknown ? numbers.front() : each.index, 100 * each.share, each.stiffness, each.mass,
                unknown ? "" : vertices.c_str());
  }
  const auto bound = [&](const char* what, const std::optional<double>& value) {
    if (value)
      out << text("k0 is at most %.6g 1/s² by %s, which leaves %.3g %% of the step unused\n", *value, what,
                  100 * unused_part(*value, k0_));
  };
  out << '\n';
  bound("the stiffest node", motion_->nodal);
  bound("the stiffest element", motion_->element);
}

// The mode with φᵀMφ = 1; `share` is of φᵀMφ, as large as that of the energy where M is diagonal.
void StiffestReport::write_mode(const std::string& path, const Subject& subject,
                                const State<Vector>& start) const {
  OutputFile file(path);
  std::ostream& out = file.stream();
  out << (subject.scene() ? "vertex,x,y,z,ux,uy,uz,share\n" : "unknown,u,share\n");
  const Eigen::VectorXd& u = motion_->mode;
  const Eigen::VectorXd share = u.cwiseProduct(answer_.structure().matrices.mass * u);
  if (!subject.scene()) {
    for (Eigen::Index i = 0; i < u.size(); ++i)
      out << text("%ld,%.17g,%.17g\n", numbers_[static_cast<std::size_t>(i)], u[i], share[i]);
    return file.commit();
  }
  const std::vector<Eigen::Vector3d> at = subject.scene()->positions(start.x);
  const std::vector<int> place = subject.elements(start.x)->place;
  for (std::size_t p = 0; p < at.size(); ++p) {
    const Eigen::Index first = 3 * static_cast<Eigen::Index>(place[p]);
    const Eigen::Vector3d moved = first < 0 ? Eigen::Vector3d::Zero().eval() : u.segment<3>(first).eval();
    out << text("%ld,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", numbers_[p], at[p].x(), at[p].y(),
                at[p].z(), moved.x(), moved.y(), moved.z(), first < 0 ? 0 : share.segment<3>(first).sum());
  }
  file.commit();
}

}  // namespace springstab
