#include "experiments/inputs/size_report.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <stdexcept>

namespace springstab {
namespace {

constexpr double largest = 20, smallest = 1e-3;  // of cloths in metres [m]
constexpr double steps_per_time = 20;
constexpr double rigid = 1e-9;  // of k0: less is a motion that nothing brings back

}  // namespace

std::string size_text(const Subject& subject) {
  const std::optional<SceneSize>& size = subject.scene_size();
  if (!size) return {};
  std::string all =
      text("%.4g x %.4g x %.4g m, %.4g kg", size->extent.x(), size->extent.y(), size->extent.z(), size->mass);
  const auto add = [&](long number, const char* one, const char* many) {
    if (number > 0) all += text(", %ld %s", number, number == 1 ? one : many);
  };
  add(size->springs, "spring", "springs");
  add(size->triangles, "triangle", "triangles");
  add(size->hinges, "hinge", "hinges");
  return all;
}

void add_size(Json& report, const Subject& subject) {
  const std::optional<SceneSize>& size = subject.scene_size();
  report["extent"] = size ? Json{size->extent.x(), size->extent.y(), size->extent.z()} : Json();
  report["total_mass"] = size ? number(size->mass) : Json();
  report["springs"] = size ? Json(size->springs) : Json();
}

std::string size_warning(const Subject& subject) {
  if (!subject.scene_size()) return {};
  const double across = subject.scene_size()->extent.maxCoeff();
  const std::string place = subject.mesh_file() ? subject.mesh_file()->path : "grid";
  const std::string is = text("warning: %s: is %.4g m across, ", place.c_str(), across);
  if (across > largest)
    return is +
           "more than 20 m: are its lengths metres? --scale 0.001 (in a scene \"scale\": 0.001) takes them "
           "as "
           "millimetres";
  if (across < smallest && across > 0)
    return is +
           "less than 1 mm: are its lengths metres? --scale 1000 (in a scene \"scale\": 1000) takes them as "
           "kilometres, --scale 0.001 is for millimetres";
  return {};
}

void print_size_warning(const Subject& subject) {
  if (const std::string warning = size_warning(subject); !warning.empty())
    std::cerr << "springstab: " << warning << '\n';
}

std::optional<double> slowest_period(const StiffestMode& k0) {
  if (!k0.smallest || !(*k0.smallest > rigid * k0.value)) return std::nullopt;
  return 2 * std::numbers::pi / std::sqrt(*k0.smallest);
}

std::optional<double> slowest_period(Subject& subject, const State<Vector>& state) {
  if (subject.system().size() > dense_limit) return std::nullopt;
  try {
    return slowest_period(estimated_stiffest_mode(subject.structure(state).matrices));
  } catch (const std::invalid_argument&) {  // rates of motion beyond double precision
    return std::nullopt;
  }
}

std::vector<TimeScale> time_scales(const Subject& subject, std::optional<double> slowest_period) {
  std::vector<TimeScale> scales;
  if (const Scene* scene = subject.scene())
    if (const double g = scene->gravity().norm(); g > 0 && subject.scene_size()->shortest_edge)
      scales.push_back({std::sqrt(2 * *subject.scene_size()->shortest_edge / g),
                        "time in which a particle falls by its shortest edge"});
  if (slowest_period) scales.push_back({*slowest_period, "slowest period"});
  return scales;
}

std::string exceeded(double step, const std::vector<TimeScale>& scales) {
  const auto least = std::ranges::min_element(scales, {}, &TimeScale::seconds);
  if (least == scales.end() || step * steps_per_time <= least->seconds) return {};
  return text("a twentieth of the %s (%.4g s)", least->name, least->seconds);
}

}  // namespace springstab
