// Error against run time as figures: a contest a row of panels, and what long runs show.
#include <algorithm>
#include <filesystem>

#include "experiments/studies/figure_list.h"
#include "experiments/studies/gnuplot.h"
#include "experiments/studies/precision/contest_figure.h"
#include "experiments/studies/precision/long_runs.h"
#include "experiments/studies/precision/scenes.h"

namespace springstab {
namespace {

/// A problem of a figure, and how long a run of it may take [CPU s].
struct ContestRow {
  Problem (*problem)(const CommonOptions&);
  double time_limit;
  bool designed = false;
};

// Those of the tables, and two of the second order that nothing limits.
std::vector<Method> figure_methods() {
  std::vector<Method> methods = all_methods();
  methods.insert(methods.end(), {"sdirk2", "bdf2"});
  return methods;
}

constexpr double stiffer = 900;  // √k0 is 30 times as large

template <Problem (*scene)(double, const CommonOptions&)>
constexpr ContestRow soft(double time_limit, bool designed = false) {
  return {[](const CommonOptions& common) { return scene(1, common); }, time_limit, designed};
}
template <Problem (*scene)(double, const CommonOptions&)>
constexpr ContestRow stiff(double time_limit) {
  return {[](const CommonOptions& common) { return scene(stiffer, common); }, time_limit};
}

// What the figure claims: every reference is good for a thousandth at least, a third integrator is farther
// away than published by its own rounding at most, and every contest has a winner.
bool holds(const std::vector<ContestResult>& results) {
  return std::ranges::all_of(results, [](const ContestResult& r) {
    const double published = r.reference.error.trajectory;
    const bool honest = !r.reference.check || r.reference.check->trajectory <= published + 1e-14;
    return honest && 100 * published <= 1e-3 && cheapest(r, 0.1, false).run;
  });
}

Json draw_rows(const std::vector<ContestRow>& rows, const FigureFiles& files, const CommonOptions& common,
               const FiguresOptions& options) {
  std::vector<ContestResult> results;
  double worst = 0;
  for (const ContestRow& row : rows) {
    Problem problem = row.problem(common);
    if (row.designed) problem.design_damping();
    const double limit = options.quick ? row.time_limit / 20 : row.time_limit;
    results.push_back(run_contest(problem,
                                  std::filesystem::path(files.data).replace_filename("references").string(),
                                  {.time_limit = limit, .methods = figure_methods()}, common));
    worst = std::max(worst, results.back().reference.error.trajectory);
  }
  std::vector<std::string> written = write_contests(results, files, options.plots);
  OutputFile table(files.data + "_cheapest.md");
  table.stream() << cheapest_table(results) << '\n' << reference_table(results);
  table.commit();
  written.push_back(files.data + "_cheapest.md");
  return {{"files", written},
          {"holds", holds(results)},
          {"summary", text("%zu contests, references good to %.2g", results.size(), worst)}};
}

Json draw_long_runs(const FigureFiles& files, const CommonOptions& common, const FiguresOptions& options) {
  const EnergyDrift energy = energy_drift(options.quick ? 2000 : 50000, common);
  const std::vector<PhaseCurve> phase = phase_errors(common);
  OutputFile energies(files.data + "_energy.csv"), phases(files.data + "_phase.csv");
  std::string settings = text("k0=%.4g; h=%.4g; series=%zu; energies=", energy.k0, energy.h, phase.size()) +
                         gnuplot_literal(files.data + "_energy.csv") +
                         "; phases=" + gnuplot_literal(files.data + "_phase.csv") + "; ";
  for (std::size_t i = 0; i < energy.curves.size(); ++i) {
    const EnergyCurve& c = energy.curves[i];
    settings += text("name_%zu=", i + 1) + gnuplot_literal(c.name) + "; ";
    energies.stream() << "# " << c.name << "\n# time,drift,diverges_next\n";
    for (std::size_t j = 0; j < c.time.size(); ++j)
      energies.stream() << c.time[j] << ',' << c.drift[j] << ',' << (c.diverged && j + 1 == c.time.size())
                        << '\n';
    energies.stream() << "\n\n";
    phases.stream() << "# " << phase[i].name << "\n# step_times_sqrt_k0,degrees_a_period\n";
    for (std::size_t j = 0; j < phase[i].degrees.size(); ++j)
      phases.stream() << phase[i].relative_step[j] << ',' << phase[i].degrees[j] << '\n';
    phases.stream() << "\n\n";
  }
  energies.commit();
  phases.commit();
  std::vector<std::string> written = draw(options.plots + "/long_runs.gp", settings, files.picture);
  written.insert(written.end(), {files.data + "_energy.csv", files.data + "_phase.csv"});
  const auto diverged = std::ranges::count_if(energy.curves, &EnergyCurve::diverged);
  return {{"files", written},
          {"holds", true},
          {"summary", text("%td of %zu methods diverge undamped", diverged, energy.curves.size())}};
}

Figure contests(const std::string& name, std::vector<ContestRow> rows) {
  return {.file = "work_precision_" + name,
          .name = "precision-" + name,
          .draw = [rows = std::move(rows)](const FigureFiles& files, const CommonOptions& common,
                                           const FiguresOptions& options) {
            return draw_rows(rows, files, common, options);
          }};
}

}  // namespace

std::vector<Figure> precision_figures() {
  return {
      contests("linear", {{oscillator, 0.02}, {uniform_chain, 0.13}, {stiff_chain, 0.4}}),
      contests("hanging_chain", {soft<hanging_chain>(0.05), stiff<hanging_chain>(0.1)}),
      contests("net", {soft<damped_net>(0.1), stiff<damped_net>(0.2)}),
      contests("cloth", {soft<tense_cloth>(0.1), stiff<tense_cloth>(0.2)}),
      contests("drape", {{spring_drape, 0.2}, {cloth_drape, 0.3}}),
      contests("fitted_damping", {soft<tense_cloth>(0.1, true), {cloth_drape, 0.3, true}}),
      {.file = "long_runs", .name = "long-runs", .draw = draw_long_runs},
  };
}

}  // namespace springstab
