// `springstab complexity`: runs the studies of what methods cost and holds them against the paper's claims.
#include <bit>
#include <filesystem>
#include <iostream>
#include <memory>

#include "experiments/command/output.h"
#include "experiments/command/shared_options.h"
#include "experiments/runs/identity.h"
#include "experiments/runs/journal.h"
#include "experiments/studies/complexity/complexity_figures.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

struct ComplexityOptions {
  bool quick = false;
  std::string plots, output;  // folders; without output nothing is written
  EarlierRun earlier;
};

/// The first row is the heading.
using Table = std::vector<std::vector<std::string>>;

Table exponents(const StudyResult& n, const StudyResult& k0) {
  Table table{{"CPU time grows like", "the paper says", "measured, exponent of n", "of √k0"}};
  const auto cell = [](const StudyResult& study, const Series& series) {
    const PowerLaw law = fit_seconds(study.study, series);
    return text("%.3f ± %.3f", law.exponent, law.half_width);
  };
  for (const Series& series : n.series)
    table.push_back({series.name, "n √k0", cell(n, series), cell(k0, k0.of(series.name))});
  return table;
}

// At the sides that are powers of two from 16 on.
Table ratios(const StudyResult& n) {
  const struct {
    std::string of, over, paper;
  } rows[] = {{"LEU", "IMP", "about ½"},
              {"LEU", "IMP, D of LEU", "about ½"},
              {"LEU", "IMP SSOR", ""},
              {"LEU", "IMP SSOR 1e-6", ""},
              {"RK4 linear", "EU", "less than 1"}};
  Table table{{"CPU time of … over that of …", "the paper says"}};
  for (const auto& row : rows) table.push_back({row.of + " over " + row.over, row.paper});
  const std::vector<HeatResult>& sheets = n.series.front().points;
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    const unsigned side = static_cast<unsigned>(sheets[i].heat.drape.side);
    if (side < 16 || !std::has_single_bit(side)) continue;
    table[0].push_back(text("%u²", side));
    for (std::size_t r = 0; r < std::size(rows); ++r)
      table[r + 1].push_back(text("%.2f", n.of(rows[r].of).points[i].median_seconds() /
                                              n.of(rows[r].over).points[i].median_seconds()));
  }
  return table;
}

Table iterations(const StudyResult& h) {
  Table table{{"IMP, h [s]", "CG iterations", "predicted (Eq. 35)", "with LEU's D", "predicted", "IMP SSOR",
               "CPU time of IMP [s]"}};
  const auto &imp = h.of("IMP").points, &damped = h.of("IMP, D of LEU").points,
             &ssor = h.of("IMP SSOR").points;
  const auto predicted = [](const HeatResult& p) {
    return text("%.0f", predicted_iterations(p) * static_cast<double>(p.steps));
  };
  for (std::size_t i = 0; i < imp.size(); ++i)
    table.push_back({text("%g", imp[i].heat.interval), text("%ld", imp[i].counts.cg_iterations),
                     predicted(imp[i]), text("%ld", damped[i].counts.cg_iterations), predicted(damped[i]),
                     text("%ld", ssor[i].counts.cg_iterations), text("%.3g", imp[i].median_seconds())});
  return table;
}

Table tolerances(const StudyResult& cg) {
  Table table{{"CPU time [s] (CG iterations) at a tolerance of"}};
  for (const HeatResult& p : cg.series.front().points)
    table[0].push_back(text("%g", p.heat.contestant.cg_tolerance));
  for (const Series& series : cg.series) {
    table.push_back({series.name});
    for (const HeatResult& p : series.points)
      table.back().push_back(text("%.3g (%ld)", p.median_seconds(), p.counts.cg_iterations));
  }
  return table;
}

std::string markdown(const Table& table) {
  std::string all;
  for (std::size_t i = 0; i < table.size(); ++i) {
    all += '|';
    for (const std::string& cell : table[i]) all += " " + cell + " |";
    all += '\n';
    if (i > 0) continue;
    for (std::size_t c = 0; c < table[0].size(); ++c) all += "|---";
    all += "|\n";
  }
  return all;
}

Json json_of(const HeatResult& p, Study study) {
  Json seconds = Json::array();
  for (double s : p.cpu_seconds) seconds.push_back(number(s));
  return {{"x", number(abscissa(study, p))},
          {"k0", number(p.heat.k0.value)},
          {"step", number(p.h)},
          {"alpha", number(p.alpha)},
          {"steps", p.steps},
          {"median_seconds", number(p.median_seconds())},
          {"cpu_seconds", seconds},
          {"counts", json_of(p.counts)},
          {"predicted_iterations", number(predicted_iterations(p) * static_cast<double>(p.steps))},
          {"rollbacks", p.rollbacks},
          {"halved_steps", p.halved_steps},
          {"finished", p.finished}};
}

Json json_of(const StudyResult& result) {
  Json list = Json::array();
  for (const Series& series : result.series) {
    const PowerLaw law = fit_seconds(result.study, series);
    Json points = Json::array();
    for (const HeatResult& p : series.points) points.push_back(json_of(p, result.study));
    list.push_back({{"name", series.name},
                    {"exponent", number(law.exponent)},
                    {"half_width", number(law.half_width)},
                    {"points", points}});
  }
  return {{"name", study_file(result.study)}, {"rounds", result.rounds}, {"series", list}};
}

int run_complexity(const CommonOptions& common, const ComplexityOptions& options) {
  if (!options.output.empty()) {
    if (!std::filesystem::is_regular_file(options.plots + "/complexity.gp"))
      throw InputError(options.plots, 0,
                       "has no complexity.gp, expected the folder of the gnuplot scripts (--plots)");
    make_folder(options.output);
  }
  Journal journal(options.output,
                  identity_of("complexity", {{"quick", options.quick}, {"seed", common.seed}}, {}),
                  options.earlier, common.quiet);
  std::vector<StudyResult> studies;
  Json files = Json::array(), list = Json::array();
  bool finished = true;
  long rollbacks = 0;
  for (Study study : {Study::particles, Study::stiffness, Study::time_step, Study::cg_tolerance}) {
    const StudyResult& result = studies.emplace_back(run_study(study, options.quick, common, journal));
    finished = finished && result.all_finished();
    rollbacks += result.rollbacks();
    list.push_back(json_of(result));
    if (options.output.empty()) continue;
    const std::string base = options.output + "/" + study_file(study);
    for (const std::string& file : write_study(result, {base, base}, options.plots)) files.push_back(file);
  }
  const std::string verdict =
      text("%s; %ld divergences were seen and undone",
           finished ? "every run stayed finite" : "not every run finished", rollbacks);
  const StudyResult &n = studies[0], &k0 = studies[1], &h = studies[2], &cg = studies[3];
  const std::vector<Table> tables{exponents(n, k0), ratios(n), iterations(h), tolerances(cg)};
  if (common.json) {
    print_json(Json{{"tables", tables},
                    {"studies", list},
                    {"all_finished", finished},
                    {"rollbacks", rollbacks},
                    {"provenance", provenance()},
                    {"files", files}});
  } else {
    for (const Table& table : tables) std::cout << markdown(table) << '\n';
    const std::vector<HeatResult>& sheets = n.series.front().points;
    std::cout << text("k0 from %.5g 1/s² at n = %.0f to %.5g 1/s² at n = %.0f\n%s\n%s\n",
                      sheets.front().heat.k0.value, abscissa(n.study, sheets.front()),
                      sheets.back().heat.k0.value, abscissa(n.study, sheets.back()), verdict.c_str(),
                      provenance().c_str());
  }
  if (std::cout.flush()) journal.finish();
  return finished ? done : no_answer;
}

}  // namespace

Subcommand complexity_command() {
  const auto o = std::make_shared<ComplexityOptions>();
  return {
      .name = "complexity",
      .title = "What the methods cost on a draping cloth",
      .footer =
          "CPU time against the number of particles, the square root of k0 [1/s] and implicit Euler's step "
          "[s]: "
          "the\n"
          "exponent of its growth with a 95 % confidence interval, medians of five interleaved rounds, in 5 "
          "to 7 "
          "minutes.\n"
          "JSON: tables[] (as printed), studies[] {name, series[] {name, exponent, half_width, points[]}}, "
          "all_finished,\n"
          "rollbacks, provenance, files. Exit status 3: a run did not come to its end.\n\n"
          "example: springstab complexity --output figures\n"
          "         springstab complexity --output figures --resume    (after Ctrl-C or a crash)",
      .options =
          {Option("--quick", &o->quick, "smaller cloths, a shorter time, three rounds: within a minute"),
           Option("--output", &o->output, "folder for Figures 5 to 7 and every run as CSV").shown_as("DIR"),
           plots_option(o->plots), resume_option(o->earlier), overwrite_option(o->earlier)},
      .run = [o](const CommonOptions& common) { return run_complexity(common, *o); }};
}

}  // namespace springstab
