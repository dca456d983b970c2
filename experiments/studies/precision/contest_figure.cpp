#include "experiments/studies/precision/contest_figure.h"

#include <algorithm>
#include <cmath>

#include "experiments/command/output.h"
#include "experiments/studies/gnuplot.h"

namespace springstab {
namespace {

std::string cell(const Cheapest& best) {
  if (!best.run) return "–";
  return best.contestant->name + text(", %.3g ms", 1e3 * best.run->median_seconds());
}

// 1 where the step is the largest stable one of the ladder, 0 else.
int at_limit(const ContestSeries& series, const ContestRun& run) {
  const std::optional<double>& limit = series.contestant.limit;
  if (!limit || !std::isfinite(*limit) || run.setting > *limit) return 0;
  return std::ranges::none_of(series.runs, [&](const ContestRun& other) {
    return other.setting <= *limit && other.setting > run.setting;
  });
}

// What is nearer to the reference than can be told is not.
bool is_drawn(const ContestRun& run) { return run.outcome != Outcome::finished || run.compared; }

std::vector<const ContestSeries*> drawn(const ContestResult& result) {
  std::vector<const ContestSeries*> series;
  for (const ContestSeries& s : result.series)
    if (std::ranges::any_of(s.runs, is_drawn)) series.push_back(&s);
  return series;
}

// A block of rows per contestant: x (seconds), least, most, error, equivalents, at the limit, and what
// became of it: 0 finished, 1 diverged or failed, 2 timed out. Without an error, 'NaN' to gnuplot.
void write_points(const std::string& path, const ContestResult& result) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  for (const ContestSeries* s : drawn(result)) {
    out << "# " << s->contestant.name << "\n# seconds,least,most,error,equivalents,at_limit,outcome\n";
    for (const ContestRun& run : s->runs) {
      if (!is_drawn(run)) continue;
      const auto [least, most] = std::ranges::minmax(run.seconds);
      out << run.median_seconds() << ',' << least << ',' << most << ',';
      if (run.errors) out << run.errors->trajectory;
      out << ',' << run.equivalents() << ',' << at_limit(*s, run) << ','
          << (run.outcome == Outcome::finished    ? 0
              : run.outcome == Outcome::timed_out ? 2
                                                  : 1)
          << '\n';
    }
    out << "\n\n";
  }
  file.commit();
}

// Order lines pass through the finest compared run of a method.
const ContestRun* finest(const ContestSeries& s) {
  const ContestRun* found = nullptr;
  for (const ContestRun& run : s.runs)
    if (run.compared && run.errors->trajectory < 1) found = &run;
  return found;
}

std::string settings_of(const ContestResult& result, const std::string& data, std::size_t panel) {
  std::string settings =
      text("data_%zu=", panel) + gnuplot_literal(data) + text("; title_%zu=", panel) +
      gnuplot_literal(result.title + text("; k₀ = %.3g 1/s², %g s simulated; runs of up to %g CPU-s",
                                          result.k0, result.duration, result.options.time_limit)) +
      text("; floor_%zu=%.3g; ", panel, 100 * result.reference.error.trajectory);
  for (const auto& [order, method] : {std::pair{1, "symplectic Euler"}, {4, "Runge-Kutta 4"}}) {
    const ContestRun* run = result.designed ? nullptr : finest(result.of(method));
    settings += text("order%d_%zu=%d; order%d_x_%zu=%.6g; order%d_n_%zu=%.6g; order%d_y_%zu=%.6g; ", order,
                     panel, run != nullptr, order, panel, run ? run->median_seconds() : 1, order, panel,
                     run ? static_cast<double>(run->equivalents()) : 1, order, panel,
                     run ? run->errors->trajectory : 1);
  }
  const std::vector<const ContestSeries*> series = drawn(result);
  settings += text("series_%zu=%zu; ", panel, series.size());
  for (std::size_t j = 0; j < series.size(); ++j)
    settings += text("name_%zu_%zu=", panel, j + 1) + gnuplot_literal(series[j]->contestant.name) + "; ";
  return settings;
}

// Each name once: not every library solves every problem.
std::string keys(const std::vector<ContestResult>& results) {
  std::vector<std::string> names;
  for (const ContestResult& result : results)
    for (const ContestSeries* s : drawn(result))
      if (std::ranges::find(names, s->contestant.name) == names.end()) names.push_back(s->contestant.name);
  std::string settings = text("keys=%zu; ", names.size());
  for (std::size_t j = 0; j < names.size(); ++j)
    settings += text("key_%zu=", j + 1) + gnuplot_literal(names[j]) + "; ";
  return settings;
}

}  // namespace

std::string cheapest_table(const std::vector<ContestResult>& results) {
  std::string table = "| scene | with |";
  for (double wanted : wanted_errors) table += text(" error ≤ %g |", wanted);
  table += "\n|---|---|";
  for (std::size_t i = 0; i < std::size(wanted_errors); ++i) table += "---|";
  table += '\n';
  for (const ContestResult& result : results)
    for (bool libraries : {false, true}) {
      const bool any = std::ranges::any_of(
          result.series, [&](const ContestSeries& s) { return s.contestant.library == libraries; });
      if (!any) continue;
      table += "| " + (libraries ? "" : result.title) + (libraries ? " | a library |" : " | springstab |");
      for (double wanted : wanted_errors) table += " " + cell(cheapest(result, wanted, libraries)) + " |";
      table += '\n';
    }
  return table;
}

std::string reference_table(const std::vector<ContestResult>& results) {
  std::string table =
      text("| scene | reference | its own error | distance of %s |\n|---|---|---|---|\n", reference_check);
  for (const ContestResult& result : results) {
    const Reference& reference = result.reference;
    table += "| " + result.title + " | " + reference.method + text(" | %.2g | ", reference.error.trajectory) +
             (reference.check ? text("%.2g", reference.check->trajectory) : "not there, or not finished") +
             " |\n";
  }
  return table;
}

std::vector<std::string> write_contests(const std::vector<ContestResult>& results, const FigureFiles& files,
                                        const std::string& plots) {
  std::vector<std::string> written;
  std::string settings = text("panels=%zu; repetitions=%d; designed=%d; footer=", results.size(),
                              results.front().options.repetitions, results.front().designed) +
                         gnuplot_literal(provenance()) + "; ";
  for (std::size_t i = 0; i < results.size(); ++i) {
    const std::string part = results.size() == 1 ? files.data : files.data + text("_%zu", i + 1);
    write_runs(part + ".csv", results[i]);
    write_points(part + "_points.csv", results[i]);
    written.insert(written.end(), {part + ".csv", part + "_points.csv"});
    settings += settings_of(results[i], part + "_points.csv", i + 1);
  }
  settings += keys(results);
  const std::vector<std::string> pictures = draw(plots + "/work_precision.gp", settings, files.picture);
  written.insert(written.end(), pictures.begin(), pictures.end());
  return written;
}

}  // namespace springstab
