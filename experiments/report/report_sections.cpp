// The sections of a report with pictures of their own: regions, error against run time, k0 along a motion.
#include <algorithm>
#include <functional>

#include "experiments/report/pictures.h"
#include "experiments/report/report_page.h"
#include "experiments/report/studies.h"
#include "experiments/report/svg_figure.h"
#include "experiments/runs/measured_run.h"
#include "experiments/simulate_report.h"
#include "experiments/studies/precision/contest_figure.h"

namespace springstab {
namespace {

constexpr std::size_t most_regions = 2;
constexpr const char* without_gnuplot = "No picture: gnuplot was not found.";

}  // namespace

// Of the recommended methods: those that cost least, one of several with the same region.
std::vector<const LimitsRow*> ReportPage::recommended() const {
  std::vector<const LimitsRow*> chosen;
  const auto add = [&](const LimitsRow& row) {
    const bool known = std::ranges::any_of(chosen, [&](const LimitsRow* other) {
      return stability_region(other->method).same_conditions(stability_region(row.method));
    });
    if (row.limits.recommended && !known && chosen.size() < most_regions) chosen.push_back(&row);
  };
  if (best_) add(*best_);
  std::vector<const LimitsRow*> others;  // the longest steps first, those that nothing limits last
  for (const LimitsRow& row : answer_.rows())
    if (row.limits.recommended && !row.method.info().linearized) others.push_back(&row);
  std::ranges::stable_sort(others, std::greater(), [](const LimitsRow* row) {
    return row->limits.status == LimitStatus::limited ? *row->limits.recommended : 0.;
  });
  for (const LimitsRow* row : others) add(*row);
  return chosen;
}

// One method's, as a part of the page. Where the modes are left out, why.
std::string ReportPage::region_figure(const LimitsRow& row, const std::string& id, bool& is_line,
                                      std::string& left_out) {
  const double h = *row.limits.recommended, k0 = answer_.limits().k0().value;
  const Told<ModeShape> modes = mode_shape(answer_, row.method, h);
  if (!modes.value) {
    left_out = modes.left_out;
    return {};
  }
  is_line = modes.value->is_line;
  std::string said =
      text("X = h d across, Y = h² k up. The modes reach to Y = %.4g at the step to use", h * h * k0);
  std::optional<ModesAtStep> users;
  if (const auto wanted = options_.limits.for_step) {
    users = {*wanted, text("at your step, %.4g s", *wanted), *mode_shape(answer_, row.method, *wanted).value};
    said += text(", and to %.4g at your step", *wanted * *wanted * k0);
  }
  return svg_figure(region_picture(options_.plots, row.method,
                                   {h, text("at the step to use, %.4g s", h), *modes.value}, users),
                    id, row.method.info().title + ": its stable region with the modes in it", said + '.');
}

void ReportPage::add_regions() {
  page_.section("regions", "Where the modes are");
  if (!draws_) return page_.paragraph(without_gnuplot, "note");
  std::vector<std::string> pictures;
  std::string left_out = "Left out: no method here has a step to use.";
  bool is_line = true;
  for (const LimitsRow* row : recommended())
    if (std::string picture = region_figure(*row, text("region-%zu", pictures.size() + 1), is_line, left_out);
        !picture.empty())
      pictures.push_back(std::move(picture));
  if (pictures.empty()) return page_.paragraph(left_out, "note");
  page_.figure(
      pictures,
      std::string("Every mode is a point of this plane, at (h d, h² k); those of this structure lie ") +
          (is_line ? "on the thick line"
                   : "within the outlined set, its joint numerical range seen from within") +
          ". What lies in the coloured region stays bounded.");
}

void ReportPage::add_ladder() {
  page_.section("errors", "Error against run time");
  const Told<ContestResult> ladder = quick_ladder(common_, options_.limits, answer_, options_.duration);
  if (!ladder.value) return page_.paragraph(ladder.left_out, "note");
  const std::string svg = draws_ ? ladder_picture(options_.plots, *ladder.value) : "";
  if (!svg.empty())
    page_.figure(
        {svg_figure(svg, "ladder", "Error against CPU time of each method",
                    "A line a method: the relative error of the trajectory falls as steps are halved "
                    "and CPU time rises.")},
        text("Each method over %.4g s of this motion, with steps from its limit down, halved each time.",
             ladder.value->duration));
  if (!draws_) page_.paragraph(without_gnuplot, "note");
  std::vector<std::vector<std::string>> rows;
  for (const double wanted : wanted_errors) {
    const Cheapest best = cheapest(*ladder.value, wanted, false);
    rows.push_back({text("at most %g", wanted), best.run ? best.contestant->name : "none of these runs",
                    best.run ? text("%.4g s", best.run->setting) : "–",
                    best.run ? text("%.3g ms", 1e3 * best.run->median_seconds()) : "–"});
  }
  page_.table("The cheapest method for an error", {"error", "method", "step", "CPU time"}, rows, false);
  page_.paragraph(
      text("Errors are relative, against %s, which is off by %.1g itself. Measured once on %s: a quick "
           "look, springstab work-precision measures with care.",
           ladder.value->reference.method.c_str(), ladder.value->reference.error.trajectory,
           provenance().c_str()),
      "note");
}

void ReportPage::add_motion() {
  page_.section("motion", "The stiffness along a motion");
  if (!best_) return page_.paragraph("Left out: no run can start, for no stable step is known.", "note");
  const Told<K0AlongMotion> along =
      k0_along_motion(common_, answer_, best_->method, *best_->limits.recommended, options_.duration);
  if (!along.value) return page_.paragraph(along.left_out, "note");
  const auto highest = std::ranges::max_element(along.value->points, {}, &std::pair<double, double>::second);
  const double safety = options_.limits.safety;
  const std::string said =
      text(
          "%.4g s by %s with steps of %.4g s: k0 rises to at most %.4g times its value at the start, at %.4g "
          "s; ",
          along.value->points.back().first, along.value->method.c_str(), along.value->step, highest->second,
          highest->first) +
      (highest->second <= safety
           ? text("the safety factor %g covers that.", safety)
           : text("that is beyond the safety factor %g: take a larger one (--safety).", safety));
  if (draws_)
    page_.figure({svg_figure(k0_picture(options_.plots, along.value->points, safety), "motion-k0",
                             "k0 along a motion, relative to that of the start", said)},
                 said);
  else
    page_.paragraph(said + ' ' + without_gnuplot);
  if (!along.value->done)
    page_.paragraph(text("The run did not come to its end: %s at %.4g s of %.4g s.",
                         outcome(along.value->status), along.value->end, along.value->duration),
                    "warnings");
}

}  // namespace springstab
