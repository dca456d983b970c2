#include "experiments/report/report_page.h"

#include <algorithm>

#include "experiments/command/programs.h"
#include "experiments/command/shared_options.h"
#include "experiments/inputs/size_report.h"
#include "experiments/limits_words.h"
#include "experiments/report/pictures.h"
#include "experiments/runs/measured_run.h"

namespace springstab {
namespace {

std::string contact_text(const Contact& contact) {
  const std::size_t obstacles = contact.obstacles.size() + contact.meshes.size();
  return text("with %zu obstacle%s%s", obstacles, obstacles == 1 ? "" : "s",
              contact.self ? " and of the cloth with itself" : "");
}

std::string seconds_of(const Json& value) {
  if (value.is_null()) return "–";
  return value.is_string() ? "∞" : text("%.6g", value.get<double>());
}

}  // namespace

ReportPage::ReportPage(const CommonOptions& common, const ReportOptions& options, LimitsAnswer& answer,
                       const std::vector<std::string>& remarks)
    : common_(common),
      options_(options),
      answer_(answer),
      limits_(answer.json()),
      draws_(find_program("gnuplot").has_value()),
      best_(best_row()),
      page_("Stable time steps of " + title_of(options.limits.input), sentence()) {
  page_.list(remarks, "warnings");
  add_scene();
  add_limits();
  if (answer.limits().k0().converged) {
    add_regions();
    add_ladder();
    add_motion();
  }
  add_stiffest();
  add_command();
}

// The cheapest method with a stable step, else the first that has one.
const LimitsRow* ReportPage::best_row() const {
  const auto& rows = answer_.rows();
  if (const MethodCost* best = answer_.cheapest()->best())
    return &*std::ranges::find_if(rows, [&](const LimitsRow& r) { return r.method == best->method; });
  const auto found =
      std::ranges::find_if(rows, [](const LimitsRow& r) { return r.limits.recommended.has_value(); });
  return found == rows.end() ? nullptr : &*found;
}

std::string ReportPage::sentence() const {
  if (!answer_.limits().k0().converged) return "The stiffest mode was not found, so no stable step is known.";
  if (!best_) return "None of these methods has a step that is known to be stable here.";
  const MethodLimits& limits = best_->limits;
  std::string all = "Take " + best_->method.name() + text(" with steps of %.6g s: ", *limits.recommended);
  all += limits.h_certified ? "proved to be stable" : "stable, though that is not proved";
  if (const MethodCost* cheapest = answer_.cheapest()->best())
    all += text(", and the cheapest of the methods here at %.3g CPU-seconds a simulated second",
                *cheapest->cost());
  return all + "." + on_wanted_step();
}

std::string ReportPage::on_wanted_step() const {
  if (!options_.limits.for_step) return {};
  std::string holding, failing, unknown;
  for (const auto& [method, said] : limits_["for_step"].items()) {
    std::string& list = said["holds"].is_null() ? unknown : said["holds"].get<bool>() ? holding : failing;
    list += (list.empty() ? "" : ", ") + method;
  }
  std::string all = text(" At your step of %.6g s ", *options_.limits.for_step);
  all += holding.empty() ? "no method is known to hold" : "these hold: " + holding;
  if (!failing.empty()) all += "; these do not: " + failing;
  if (!unknown.empty()) all += "; not known of " + unknown;
  return all + ".";
}

std::vector<std::vector<long>> ReportPage::stiffest_elements() const {
  std::vector<std::vector<long>> all;
  if (limits_["stiffest"].is_array())
    for (const Json& each : limits_["stiffest"])
      if (each["vertices"].is_array()) all.push_back(each["vertices"].get<std::vector<long>>());
  return all;
}

void ReportPage::add_picture() {
  const Subject& subject = answer_.subject();
  const bool is_scene = subject.scene() != nullptr;
  const std::string png =
      is_scene ? scene_picture(options_.plots, subject, answer_.start().x, stiffest_elements())
               : matrix_picture(options_.plots, answer_.limits().structure().matrices.stiffness);
  if (png.empty()) return page_.paragraph("No picture: there are no faces, or too many to draw.", "note");
  const std::string what = is_scene ? "The scene as it starts" : "Where K is not zero";
  page_.figure({png_image(png, is_scene ? what + ": " + size_text(subject) : what)},
               !is_scene ? what + '.'
                         : what +
                               ". Diamonds: pinned particles. Thick lines: the elements with most of the "
                               "stiffest mode's energy, which decide the step.");
}

void ReportPage::add_scene() {
  const Subject& subject = answer_.subject();
  const StructuralMatrices& s = answer_.limits().structure().matrices;
  page_.section("scene", subject.scene() ? "The scene" : "The matrices");
  if (draws_) add_picture();
  std::vector<std::pair<std::string, std::string>> facts{{"input", input_text()},
                                                         {"size", size_text(subject)}};
  if (const Scene* scene = subject.scene())
    facts.emplace_back("particles", text("%d, %d of them pinned", scene->particles(),
                                         scene->particles() - scene->free_particles()));
  if (!subject.faces().empty()) facts.emplace_back("faces", std::to_string(subject.faces().size()));
  facts.emplace_back("unknowns", std::to_string(s.size()));
  if (!subject.scene()) facts.emplace_back("entries of K", std::to_string(s.stiffness.nonZeros()));
  facts.emplace_back("damping", damping_text());
  if (subject.contact()) facts.emplace_back("contact", contact_text(*subject.contact()));
  page_.facts(facts);
}

std::string ReportPage::input_text() const {
  const InputOptions& in = options_.limits.input;
  return !in.file.empty() ? in.file : !in.grid.empty() ? "a grid of " + in.grid : in.stiffness;
}

std::string ReportPage::damping_text() const {
  const DampingModel& d = answer_.limits().structure().damping;
  switch (d.kind) {
    case DampingModel::Kind::none:
      return "none";
    case DampingModel::Kind::rayleigh:
      return text("Rayleigh, d0 = %g 1/s, alpha = %g s", d.d0, d.alpha);
    case DampingModel::Kind::designed:
      return text("Rayleigh, d0 = %g 1/s, alpha fitted to the step", d.d0);
    case DampingModel::Kind::general:
      break;
  }
  return "general: dampers, or a matrix of its own";
}

std::vector<std::vector<std::string>> ReportPage::limits_rows() const {
  std::vector<std::vector<std::string>> rows;
  for (const Json& m : limits_["methods"]) {
    const Json& designed = m["designed"];
    const bool fitted = !designed.is_null();
    rows.push_back({m["name"], m["status"], seconds_of(m["h_max"]), seconds_of(m["h_certified"]),
                    seconds_of(m["recommended_step"]), fitted ? seconds_of(designed["h_max"]) : "–",
                    fitted ? seconds_of(designed["alpha"]) : "–"});
    if (!options_.limits.for_step) continue;
    const Json& said = limits_["for_step"][m["name"].get<std::string>()];
    rows.back().push_back(said["holds"].is_null()      ? "unknown"
                          : !said["holds"].get<bool>() ? "no"
                          : said["proved"].get<bool>() ? "proved"
                                                       : "yes");
  }
  return rows;
}

void ReportPage::add_limits() {
  const StiffestMode& k0 = answer_.limits().k0();
  const double safety = options_.limits.safety;
  page_.section("limits", "The largest stable steps");
  if (k0.converged) {
    page_.paragraph(
        text("k0 = %.10g 1/s² (%s), the stiffest mode. Every smaller step than h_max keeps every motion "
             "bounded, a "
             "certified one by proof; the step to use leaves room for a stiffness %g times as large.",
             k0.value, value_kind(k0), safety));
    std::vector<std::string> headings{"method",
                                      "status",
                                      "h_max [s]",
                                      "certified [s]",
                                      text("use, F = %g [s]", safety),
                                      "fitted damping: h_max [s]",
                                      "with alpha [s]"};
    if (const auto wanted = options_.limits.for_step) headings.push_back(text("holds at %.6g s", *wanted));
    page_.table("Steps of each method", headings, limits_rows());
  }
  page_.folded_text("All that springstab limits prints", answer_.text_of());
  page_.json("limits-json", limits_.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void ReportPage::add_stiffest() {
  if (!limits_["stiffest"].is_array() || limits_["stiffest"].empty()) return;
  page_.section("stiffest", "What decides the step");
  std::vector<std::vector<std::string>> rows;
  for (const Json& each : limits_["stiffest"]) {
    std::string between;
    if (each["vertices"].is_array())
      for (const Json& vertex : each["vertices"]) between += (between.empty() ? "" : " ") + vertex.dump();
    rows.push_back({each["kind"].get<std::string>() + ' ' + each["index"].dump(),
                    text("%.3f %%", 100 * each["share"].get<double>()),
                    text("%.6g", each["stiffness"].get<double>()), text("%.4g", each["mass"].get<double>()),
                    between.empty() ? "–" : between});
  }
  page_.table("Where the stiffest mode has its energy",
              {"element", "share", "stiffness [N/m]", "mass [kg]", "between vertices"}, rows);
}

void ReportPage::add_command() {
  page_.section("command", "To repeat it");
  page_.preformatted(common_.command_line);
  page_.paragraph("Made on " + provenance() + '.', "note");
}

}  // namespace springstab
