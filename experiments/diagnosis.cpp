#include "experiments/diagnosis.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "experiments/inputs/frame_unknowns.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t vertices_shown = 10, methods_shown = 5;
constexpr double blown_up = 1e3;  // times the size of the first frame

// What lies apart in the first frame, or where that is a point, the largest number.
double size_of_frame(const Eigen::VectorXd& frame) {
  const double apart = frame.maxCoeff() - frame.minCoeff();
  return apart > 0 ? apart : frame.cwiseAbs().maxCoeff();
}

bool has_blown_up(const Eigen::MatrixXd& positions, Eigen::Index used) {
  if (used < positions.cols()) return true;
  const double first = size_of_frame(positions.col(0));
  return first > 0 && size_of_frame(positions.col(used - 1)) > blown_up * first;
}

void name_vertices(Diagnosis& found, int components) {
  const Eigen::VectorXcd& pattern = found.growth->pattern;
  const Eigen::Index count = pattern.size() / components;
  const auto share = [&](Eigen::Index v) {
    return pattern.segment(v * components, components).squaredNorm();
  };
  std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::ranges::stable_sort(order, std::greater(), share);
  order.resize(std::min(order.size(), vertices_shown));
  for (const Eigen::Index v : order) found.shares.push_back(share(v));
  found.vertices = std::move(order);
}

// The structure in the poses between which the pattern was seen to grow: the one that explains it better.
diagnosis::PatternInStructure in_structure(const Diagnosis& found, const RunFrames& frames, Model& model,
                                           const Subject* scene, const std::string& source,
                                           const std::vector<Method>& methods) {
  const std::vector<Eigen::Index> places = unknowns_in_frame(model, scene, frames.positions.rows(), source);
  const diagnosis::Growth& growth = *found.growth;
  State<Vector> state = model.initial_state();
  StructureLimits answer(model.structure(state), {.certify = false});
  Eigen::VectorXcd pattern(state.x.size());
  for (Eigen::Index i = 0; i < pattern.size(); ++i) pattern[i] = growth.pattern[places[i]];
  state.v.setZero();
  const auto seen_in = [&](Eigen::Index frame) {
    for (Eigen::Index i = 0; i < pattern.size(); ++i) state.x[i] = frames.positions(places[i], frame);
    return diagnosis::explain_growth(model.structure(state), answer, pattern,
                                     {growth.factor, found.run.h, found.run.every}, methods);
  };
  diagnosis::PatternInStructure first = seen_in(growth.first);
  if (model.is_linear()) return first;
  diagnosis::PatternInStructure last = seen_in(growth.last);
  return last.methods[0].off < first.methods[0].off ? last : first;
}

Json complex_json(Complex value) { return {number(value.real()), number(value.imag())}; }

Json method_json(const diagnosis::MethodOfGrowth& one) {
  return {{"method", one.method.name()},
          {"step_over_limit", number(one.step_over_limit)},
          {"factor", complex_json(one.factor)},
          {"distance", number(one.distance)},
          {"stiffness", number(one.stiffness)}};
}

void add_structure(const Diagnosis& found, Json& json) {
  const auto& seen = *found.seen;
  json["pattern"] = {{"stiffness", number(seen.stiffness)},
                     {"damping", number(seen.damping)},
                     {"of_stiffest", number(seen.of_stiffest)},
                     {"overlap_with_stiffest_mode", number(seen.overlap)}};
  if (const auto* fit = found.fit()) json["fits"] = method_json(*fit);
  for (const auto& one : seen.methods)
    if (json["methods"].size() < methods_shown || one.fits) json["methods"].push_back(method_json(one));
}

}  // namespace

const char* name(Diagnosis::Status status) {
  switch (status) {
    case Diagnosis::Status::growing:
      return "growing";
    case Diagnosis::Status::too_fast:
      return "too fast";
    default:
      return "no growth";
  }
}

const char* kind_of(Complex factor) {
  if (factor.imag() != 0) return "ringing";
  return factor.real() < 0 ? "alternating" : "one sign";
}

const diagnosis::MethodOfGrowth* Diagnosis::fit() const {
  return seen && !seen->methods.empty() && seen->methods[0].fits ? &seen->methods[0] : nullptr;
}

std::optional<Complex> Diagnosis::factor() const {
  if (!growth) return std::nullopt;
  if (run.every == 1) return growth->factor;
  if (!fit()) return std::nullopt;
  // The root of that modulus whose angle is nearest to the method's.
  const double m = run.every, turn = 2 * std::numbers::pi / m, angle = std::arg(growth->factor) / m;
  if (growth->factor.imag() == 0 && fit()->factor.imag() == 0)
    return std::copysign(std::pow(std::abs(growth->factor), 1 / m), fit()->factor.real());
  const double near = angle + turn * std::round((std::arg(fit()->factor) - angle) / turn);
  return std::polar(std::pow(std::abs(growth->factor), 1 / m), near);
}

Diagnosis diagnose(const RunFrames& frames, const DiagnosisOptions& options, Model* model,
                   const Subject* scene, const std::string& source, const std::vector<Method>& methods) {
  if (!(options.h > 0 && std::isfinite(options.h)))
    throw std::invalid_argument("the step is " + std::to_string(options.h) +
                                ", expected a positive number of seconds");
  if (options.every < 1)
    throw std::invalid_argument("a frame every " + std::to_string(options.every) +
                                " steps, expected at least 1");
  if (model) unknowns_in_frame(*model, scene, frames.positions.rows(), source);
  Diagnosis found;
  found.run = options;
  found.frames = frames.positions.cols();
  found.used = diagnosis::usable_frames(frames.positions);
  if (found.used == 0)
    throw InputError(source, 0, "has no finite position in its first frame, expected finite ones");
  found.growth = diagnosis::find_growth(frames.positions.leftCols(found.used));
  if (!found.growth) {
    if (has_blown_up(frames.positions, found.used)) found.status = Diagnosis::Status::too_fast;
    return found;
  }
  found.status = Diagnosis::Status::growing;
  name_vertices(found,
                scene && frames.components == 1 && frames.positions.rows() % 3 == 0 ? 3 : frames.components);
  if (model) found.seen = in_structure(found, frames, *model, scene, source, methods);
  return found;
}

Json json_of(const Diagnosis& found) {
  const double seconds = found.run.h * found.run.every;
  Json json{{"status", name(found.status)}, {"frames", found.frames},    {"used", found.used},
            {"step", found.run.h},          {"every", found.run.every},  {"grows_from", nullptr},
            {"grows_from_time", nullptr},   {"grows_to", nullptr},       {"factor", nullptr},
            {"frame_factor", nullptr},      {"growth_of_step", nullptr}, {"kind", nullptr},
            {"e_foldings", nullptr},        {"residual", nullptr},       {"vertices", Json::array()},
            {"shares", found.shares},       {"pattern", nullptr},        {"fits", nullptr},
            {"methods", Json::array()}};
  if (!found.growth) return json;
  const diagnosis::Growth& growth = *found.growth;
  json["grows_from"] = growth.from;
  json["grows_from_time"] = seconds * static_cast<double>(growth.from);
  json["grows_to"] = growth.to;
  const auto factor = found.factor();
  if (factor) json["factor"] = complex_json(*factor);
  json["frame_factor"] = complex_json(growth.factor);
  json["growth_of_step"] = std::pow(std::abs(growth.factor), 1.0 / found.run.every);
  if (factor) json["kind"] = kind_of(*factor);
  json["e_foldings"] = growth.e_foldings;
  json["residual"] = growth.residual;
  json["vertices"] = found.vertices;
  if (found.seen) add_structure(found, json);
  return json;
}

}  // namespace springstab
