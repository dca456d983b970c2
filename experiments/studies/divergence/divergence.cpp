// `springstab divergence`: stable regions and limits against what simulations do.
#include "experiments/studies/divergence/divergence.h"
#include "analysis/method.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "experiments/command/shared_options.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/region.h"
#include "experiments/runs/identity.h"
#include "experiments/runs/journal.h"
#include "experiments/studies/divergence/cloth.h"
#include "experiments/studies/divergence/examples.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

Json compared(const Method& method, const CommonOptions& common, const DivergenceOptions& options,
              const std::string& path) {
  const CellGrid grid{stability_region(method).natural_window(0.15), options.cells, options.cells};
  const CellComparison c =
      compare_cells(method.name(), grid, options.steps, common.threads, path, CellsWritten::disagreeing);
  return {{"method", method.name()},
          {"cells", c.cells},
          {"steps", c.steps},
          {"diverged", c.diverged},
          {"disagreements", c.disagreements},
          {"band", c.band},
          {"outside_band", c.outside_band}};
}

Json plane(const CommonOptions& common, const DivergenceOptions& options, Journal& journal,
           Progress& progress) {
  Json rows = Json::array();
  long methods = 0;
  for (const Method& each : options.methods) methods += !each.info().linearized;
  for (const Method& each : options.methods) {
    if (each.info().linearized) continue;  // the region of the method inside
    const std::string method(each.name());
    const std::string path = options.output.empty() ? "" : options.output + "/divergence_" + method + ".csv";
    if (journal.has_next(1) && !std::filesystem::exists(path)) compared(each, common, options, path);
    rows.push_back(
        journal.piece("cells of " + method, [&] { return compared(each, common, options, path); }));
    progress.update(0.3 * static_cast<double>(rows.size()) / static_cast<double>(methods));
  }
  return rows;
}

// The ratios h/h_limit that are tried, closer together near 1.
std::vector<double> ratios(bool quick) {
  if (quick) return {0.5, 0.7, 0.9, 0.98, 1.02, 1.2};
  return {0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 1.01, 1.02, 1.05, 1.1, 1.2, 1.35, 1.5};
}

ClothStudyOptions study_of(const CommonOptions& common, const DivergenceOptions& options) {
  ClothStudyOptions study{.ratios = ratios(options.quick), .seed = common.seed, .methods = options.methods};
  if (options.quick) study.duration = 0.2, study.linear_steps = 2000;
  return study;
}

using Scenes = std::vector<std::pair<std::string, Subject>>;

// The built-in scenes, then those that were given.
Scenes subjects(const DivergenceOptions& options) {
  if (options.cells < 1 || options.cells > 10000)
    throw InputError("--cells", 0, text("is %d, expected 1 to 10000 cells per side", options.cells));
  if (options.steps < 100)
    throw InputError("--steps", 0, text("is %ld, expected at least 100", options.steps));
  Scenes all;
  const int side = options.quick ? 8 : 16;
  SceneDescription scene;
  scene.geometry = Grid{side, side};
  scene.pins.kind = Pins::Kind::first_row;
  all.emplace_back(text("spring net %dx%d", side, side), Subject(scene));
  scene.initial.stretch = {1.1, 1, 1.1};
  all.emplace_back(text("stretched net %dx%d", side, side), Subject(scene));
  scene.initial = {};
  scene.material = ClothMaterial{};
  all.emplace_back(text("Baraff-Witkin %dx%d", side, side), Subject(scene));
  for (const std::string& file : options.scenes) {
    InputOptions input;
    input.file = file;
    if (!is_scene_file(file)) input.pin = options.pin;
    Subject subject(input);
    expect_no_contact(subject, file);
    if (subject.scene()->has_own_damping())
      throw InputError(file, 0, "has a material with damping, expected none: this study sets the damping");
    print_mesh_notes(subject);
    const std::size_t slash = file.find_last_of('/');
    all.emplace_back(slash == std::string::npos ? file : file.substr(slash + 1), std::move(subject));
  }
  return all;
}

ClothStudy cloth(const CommonOptions& common, const DivergenceOptions& options, Scenes& scenes,
                 Journal& journal, Progress& progress) {
  const ClothStudyOptions study_options = study_of(common, options);
  ClothStudy all;
  double done_before = 0;
  for (auto& [name, subject] : scenes) {
    const double share = 0.7 / static_cast<double>(scenes.size());
    const ClothStudy one = study_cloth(
        name, subject, study_options, [&](double part) { progress.update(0.3 + done_before + share * part); },
        journal);
    done_before += share;
    all.runs.insert(all.runs.end(), one.runs.begin(), one.runs.end());
    all.needed.insert(all.needed.end(), one.needed.begin(), one.needed.end());
    all.linear_disagreements += one.linear_disagreements;
    all.outside_band += one.outside_band;
  }
  return all;
}

void write(const std::string& folder, const ClothStudy& study, const Pendulum& pendulum) {
  OutputFile runs(folder + "/divergence_cloth.csv");
  runs.stream() << "scene,damping,method,system,ratio,h,steps,diverged\n";
  for (const ClothRun& r : study.runs)
    runs.stream() << r.scene << ',' << r.damping << ',' << r.method << ',' << (r.linear ? "linear" : "scene")
                  << ',' << r.ratio << ',' << r.h << ',' << r.steps << ',' << r.diverged << '\n';
  runs.commit();
  OutputFile needed(folder + "/divergence_safety.csv");
  needed.stream() << "scene,damping,method,h_limit,bounded_ratio,k0_growth,needed_factor\n";
  for (const NeededSafety& n : study.needed) {
    needed.stream() << n.scene << ',' << n.damping << ',' << n.method << ',' << n.h_limit << ',';
    if (n.bounded_ratio) needed.stream() << *n.bounded_ratio;
    needed.stream() << ',' << n.k0_growth << ',';
    if (n.factor) needed.stream() << *n.factor;
    needed.stream() << '\n';
  }
  needed.commit();
  OutputFile swing(folder + "/divergence_pendulum.csv");
  swing.stream() << "t,linearized,symplectic\n";
  for (const Pendulum::Sample& s : pendulum.samples)
    swing.stream() << s.t << ',' << s.linearized << ',' << s.symplectic << '\n';
  swing.commit();
}

Json json(const ClothStudy& study) {
  Json rows = Json::array();
  for (const NeededSafety& n : study.needed)
    rows.push_back({{"scene", n.scene},
                    {"damping", n.damping},
                    {"method", n.method},
                    {"alpha", n.alpha},
                    {"h_limit", n.h_limit},
                    {"bounded_ratio", number(n.bounded_ratio)},
                    {"k0_growth", n.k0_growth},
                    {"needed_factor", number(n.factor)}});
  return rows;
}

void print(const Json& report) {
  std::cout << text("%-18s %9s %7s %10s %12s %14s\n", "X-Y plane", "cells", "steps", "differ", "band",
                    "outside it");
  for (const Json& r : report["plane"])
    std::cout << text("%-18s %9ld %7ld %10ld %12.3g %14ld\n", r["method"].get<std::string>().c_str(),
                      r["cells"].get<long>(), r["steps"].get<long>(), r["disagreements"].get<long>(),
                      r["band"].get<double>(), r["outside_band"].get<long>());
  std::cout << text(
      "\ncloth: %ld runs of linear systems, %ld diverge below the limit or stay bounded above it, %ld of "
      "them "
      "outside the band\n",
      report["linear_runs"].get<long>(), report["linear_disagreements"].get<long>(),
      report["linear_outside_band"].get<long>());
  std::cout << text("\n%-26s %-15s %-26s %12s %9s %9s %9s\n", "scene", "damping", "method", "h_limit [s]",
                    "bounded", "k0 grows", "needs F");
  for (const Json& n : report["safety"]) {
    const auto or_more = [&](const char* key) {
      return n[key].is_null() ? std::string("-") : text("%.3g", n[key].get<double>());
    };
    std::cout << text("%-26s %-15s %-26s %12.6g %9s %9.4g %9s\n", n["scene"].get<std::string>().c_str(),
                      n["damping"].get<std::string>().c_str(), n["method"].get<std::string>().c_str(),
                      n["h_limit"].get<double>(), or_more("bounded_ratio").c_str(),
                      n["k0_growth"].get<double>(), or_more("needed_factor").c_str());
  }
  const Json& s = report["switching"];
  std::cout << text("\nswitching stiffness: steps with radii %.4f and %.4f grow by %.4f a step in turn\n",
                    s["radius_soft"].get<double>(), s["radius_stiff"].get<double>(),
                    s["growth"].get<double>());
  const Json& p = report["pendulum"];
  std::cout << "pendulum, h = " << text("%.4g s: linearized explicit Euler ", p["step"].get<double>())
            << (p["exploded_at"].is_null() ? std::string("stays bounded")
                                           : text("explodes at %.4g s", p["exploded_at"].get<double>()))
            << text(", symplectic Euler has at most %.4g m g l in 20 s\n",
                    p["symplectic_largest_energy"].get<double>());
}

// Pieces of the journal: a method's cells; a scene under one damping by one method.
Json report_of(const CommonOptions& common, const DivergenceOptions& options, Scenes scenes,
               Journal& journal) {
  Progress progress("simulating", common.quiet);
  const Json cells = plane(common, options, journal, progress);
  const ClothStudy study = cloth(common, options, scenes, journal, progress);
  const Switching switching = switching_oscillator();
  const Pendulum pendulum = swinging_pendulum();
  if (!options.output.empty()) write(options.output, study, pendulum);

  Json report;
  for (const char* key : {"cells", "disagreements", "outside_band"}) {
    long sum = 0;
    for (const Json& row : cells) sum += row[key].get<long>();
    report[key] = sum;
  }
  report["plane"] = cells;
  report["duration"] = study_of(common, options).duration;
  report["linear_steps"] = study_of(common, options).linear_steps;
  report["linear_runs"] =
      std::count_if(study.runs.begin(), study.runs.end(), [](const ClothRun& run) { return run.linear; });
  report["linear_disagreements"] = study.linear_disagreements;
  report["linear_outside_band"] = study.outside_band;
  report["safety"] = json(study);
  report["switching"] = {{"radius_soft", switching.radius_soft},
                         {"radius_stiff", switching.radius_stiff},
                         {"growth", switching.growth}};
  report["pendulum"] = {{"step", pendulum.step},
                        {"exploded_at", number(pendulum.exploded_at)},
                        {"symplectic_largest_energy", pendulum.symplectic_largest_energy}};
  return report;
}

}  // namespace

Json divergence(const CommonOptions& common, const DivergenceOptions& options) {
  Scenes scenes = subjects(options);
  if (!options.output.empty()) make_folder(options.output);
  return report_of(common, options, std::move(scenes), Journal::none());
}

static int run_divergence(const CommonOptions& common, const DivergenceOptions& options,
                          const std::string& names) {
  Scenes scenes = subjects(options);
  Json inputs = Json::array();
  for (const std::string& scene : options.scenes)
    inputs.push_back(contents_of(scene, options.earlier.resume));
  Json settings{{"pin", options.pin},
                {"cells", options.cells},
                {"steps", options.steps},
                {"quick", options.quick},
                {"seed", common.seed}};
  settings.update(method_settings(common, names));
  if (!options.output.empty()) make_folder(options.output);
  Journal journal(options.output, identity_of("divergence", settings, inputs), options.earlier, common.quiet);
  const Json report = report_of(common, options, std::move(scenes), journal);
  if (common.json)
    print_json(report);
  else
    print(report);
  if (std::cout.flush()) journal.finish();
  return done;
}

namespace {

// As it is typed: --quick has fewer cells and steps unless they are given.
struct TypedDivergenceOptions : DivergenceOptions {
  std::optional<int> given_cells{};
  std::optional<long> given_steps{};
  std::string method_names{};

  DivergenceOptions resolved() const {
    DivergenceOptions all = *this;
    all.cells = given_cells.value_or(quick ? 100 : cells);
    all.methods = methods_of(method_names);
    all.steps = given_steps.value_or(quick ? 500 : steps);
    return all;
  }
};

}  // namespace

Subcommand divergence_command() {
  const auto o = std::make_shared<TypedDivergenceOptions>();
  return {
      .name = "divergence",
      .title = "Compares regions and limits with simulations",
      .footer =
          "X-Y plane: one oscillator per cell and method. `differ` counts those that diverge where |λ| <= 1 "
          "or "
          "stay\n"
          "bounded where it is larger, `outside it` those of them for which the steps were enough to tell.\n"
          "Cloth: runs at 0.5 to 1.5 of the limit of the linear system at the start, under three dampings: "
          "air "
          "drag,\n"
          "alpha = 1e-4 s, and fitted to the step. A scene's own `damping` is set aside, a material with "
          "damping "
          "refused.\n"
          "`bounded`: up to this ratio no run of the scene diverged. `k0 grows`: largest k0(t)/k0(0).\n"
          "`needs F`: the safety factor on k0 that would have given such a step. - where even the shortest "
          "one "
          "tried\n"
          "diverged.\n"
          "JSON: cells, disagreements, outside_band, plane[], safety[], switching, pendulum.\n\n"
          "example: springstab divergence skirt.obj --pin 0-15 --output results\n"
          "         the same with --resume after Ctrl-C or a crash",
      .options =
          {Option("SCENES", &o->scenes, "scene files and meshes, besides the built-in scenes")
               .shown_as("FILE"),
           Option("--pin", &o->pin, "pins of the meshes: particle numbers like 0,5-9").with_default(),
           Option("--cells", &o->given_cells, "cells of the X-Y plane, per side")
               .with_default(std::to_string(o->cells)),
           Option("--steps", &o->given_steps, "steps of each cell").with_default(std::to_string(o->steps)),
           methods_option(o->method_names),
           Option("--quick", &o->quick, "small scenes, few steps; 100 cells a side unless given"),
           Option("--output", &o->output, "folder for the CSV files").shown_as("DIR"),
           resume_option(o->earlier), overwrite_option(o->earlier)},
      .run = [o](const CommonOptions& common) {
        return run_divergence(common, o->resolved(), o->method_names);
      }};
}

}  // namespace springstab
