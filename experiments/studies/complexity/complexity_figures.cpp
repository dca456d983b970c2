#include "experiments/studies/complexity/complexity_figures.h"

#include "experiments/studies/figure_list.h"
#include "experiments/studies/gnuplot.h"

namespace springstab {
namespace {

std::string heading(const StudyResult& result) {
  const HeatResult& first = result.series.front().points.front();
  const HeatResult& last = result.series.front().points.back();
  const double simulated = first.heat.duration;
  const int side = first.heat.drape.side;
  switch (result.study) {
    case Study::particles:
      return text("A draping cloth of n particles, %g s simulated; k₀ = %.4g to %.4g 1/s²", simulated,
                  first.heat.k0.value, last.heat.k0.value);
    case Study::stiffness:
      return text("A draping cloth of %d×%d particles, %g s simulated", side, side, simulated);
    default:
      return text("Implicit Euler on a draping cloth of %d×%d particles, %g s simulated; k₀ = %.4g 1/s²",
                  side, side, simulated, first.heat.k0.value);
  }
}

std::string settings_of(const StudyResult& result, const std::string& data) {
  std::string settings = "data=" + gnuplot_literal(data + "_medians.csv") +
                         "; heading=" + gnuplot_literal(heading(result)) +
                         "; footer=" + gnuplot_literal(provenance()) +
                         text("; rounds=%d; series=%zu; ", result.rounds, result.series.size());
  if (result.study == Study::particles) settings += "number='5'; symbol='n'; xlabel='particles n'; ";
  if (result.study == Study::stiffness) settings += "number='6'; symbol='(√k₀)'; xlabel='√k₀   (1/s)'; ";
  for (std::size_t i = 0; i < result.series.size(); ++i) {
    const Series& series = result.series[i];
    const PowerLaw law = fit_seconds(result.study, series);
    settings += text("a_%zu=%.9g; b_%zu=%.9g; exponent_%zu='%.3f ± %.3f'; name_%zu=", i + 1, law.coefficient,
                     i + 1, law.exponent, i + 1, law.exponent, law.half_width, i + 1) +
                gnuplot_literal(series.name) + "; ";
  }
  return settings;
}

Json draw_timing_figure(Study study, const FigureFiles& files, const CommonOptions& common,
                        const FiguresOptions& options) {
  const StudyResult result = run_study(study, options.quick, common);
  return {{"files", write_study(result, files, options.plots)},
          {"holds", result.all_finished()},
          {"summary",
           text("%zu contestants, %d rounds, %s, %ld rollbacks", result.series.size(), result.rounds,
                result.all_finished() ? "every run stayed finite" : "a run failed", result.rollbacks())}};
}

}  // namespace

std::string study_file(Study study) {
  switch (study) {
    case Study::particles:
      return "figure_5_particles";
    case Study::stiffness:
      return "figure_6_stiffness";
    case Study::time_step:
      return "figure_7_time_step";
    case Study::cg_tolerance:
      break;
  }
  return "complexity_cg_tolerance";
}

std::vector<std::string> write_study(const StudyResult& result, const FigureFiles& files,
                                     const std::string& plots) {
  write_runs(files.data + ".csv", result);
  if (result.study == Study::cg_tolerance) return {files.data + ".csv"};
  write_medians(files.data + "_medians.csv", result);
  const char* script = result.study == Study::time_step ? "/time_step.gp" : "/complexity.gp";
  std::vector<std::string> written = draw(plots + script, settings_of(result, files.data), files.picture);
  written.insert(written.end(), {files.data + ".csv", files.data + "_medians.csv"});
  return written;
}

std::vector<Figure> timing_figures() {
  std::vector<Figure> figures;
  const std::pair<Study, const char*> named[] = {
      {Study::particles, "5"}, {Study::stiffness, "6"}, {Study::time_step, "7"}};
  for (const auto& [study, number] : named)
    figures.push_back({.file = study_file(study),
                       .name = number,
                       .draw = [study = study](const FigureFiles& files, const CommonOptions& common,
                                               const FiguresOptions& options) {
                         return draw_timing_figure(study, files, common, options);
                       }});
  return figures;
}

}  // namespace springstab
