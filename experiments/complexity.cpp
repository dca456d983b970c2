// `springstab complexity`: runs the studies of what methods cost and holds them against the paper's claims.
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "experiments/complexity_figures.h"
#include "experiments/experiments.h"
#include "experiments/output.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

struct Claim {
  std::string claim, paper, measured;
};

std::string joined(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
  return all;
}

std::string exponents(const StudyResult& result) {
  std::vector<std::string> parts;
  for (const Series& series : result.series) {
    const PowerLaw law = fit_seconds(result.study, series);
    parts.push_back(text("%s %.3f ± %.3f", series.name.c_str(), law.exponent, law.half_width));
  }
  return joined(parts);
}

// Seconds of one contestant over the least of some others', at the sizes that the project reports.
std::string ratios(const StudyResult& result, const std::string& name,
                   const std::vector<std::string>& others) {
  std::vector<std::string> parts;
  const std::vector<HeatResult>& points = result.of(name).points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int side = points[i].heat.drape.side;
    if (side < 16 || (side & (side - 1)) != 0) continue;
    std::vector<double> seconds;
    for (const std::string& other : others) seconds.push_back(result.of(other).points[i].median_seconds());
    parts.push_back(
        text("%.2f (%d²)", points[i].median_seconds() / *std::ranges::min_element(seconds), side));
  }
  return joined(parts);
}

std::string iterations(const Series& series) {
  std::vector<std::string> parts;
  for (const HeatResult& p : series.points)
    parts.push_back(text("%ld (%.3g) at %g s", p.counts.cg_iterations,
                         predicted_iterations(p) * static_cast<double>(p.steps), p.heat.interval));
  return joined(parts);
}

std::string cheapest(const StudyResult& result) {
  std::vector<std::string> parts;
  for (const Series& series : result.series)
    for (const HeatResult& p : series.points)
      if (const double t = p.heat.contestant.cg_tolerance; t == 1e-2 || t == 1e-3 || t == 1e-6)
        parts.push_back(text("%s %.3g s at %g", series.name.c_str(), p.median_seconds(), t));
  return joined(parts);
}

std::vector<Claim> claims(const std::vector<StudyResult>& studies) {
  const StudyResult &n = studies[0], &k0 = studies[1], &h = studies[2], &cg = studies[3];
  const auto& sheets = n.of("LEU").points;
  return {
      {"CPU time against n, exponent", "1", exponents(n)},
      {"CPU time against √k0, exponent", "1", exponents(k0)},
      {"LEU's time over IMP's", "about ½", ratios(n, "LEU", {"IMP"})},
      {"… over IMP's with LEU's D", "", ratios(n, "LEU", {"IMP, D of LEU"})},
      {"… over the best implicit Euler's", "", ratios(n, "LEU", {"IMP", "IMP SSOR", "IMP SSOR 1e-6"})},
      {"RK4 with linear force over EU", "< 1", ratios(n, "RK4 linear", {"EU"})},
      {"IMP's CG iterations against h (Eq. 35)", "grow mildly as h shrinks", iterations(h.of("IMP"))},
      {"IMP's seconds against CG tolerance", "", cheapest(cg)},
      {"k0 as the sheet grows [1/s²]", "almost constant",
       text("%.5g to %.5g", sheets.front().heat.k0.value, sheets.back().heat.k0.value)},
  };
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
          {"counts",
           {{"force_evaluations", p.counts.force_evaluations},
            {"hessian_assemblies", p.counts.hessian_assemblies},
            {"block_products", p.counts.block_products},
            {"cg_iterations", p.counts.cg_iterations}}},
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

}  // namespace

int run_complexity(const CommonOptions& common, const ComplexityOptions& options) {
  if (!options.output.empty()) {
    if (!std::filesystem::is_regular_file(options.plots + "/complexity.gp"))
      throw InputError(options.plots, 0,
                       "has no complexity.gp, expected the folder of the gnuplot scripts (--plots)");
    make_folder(options.output);
  }
  std::vector<StudyResult> studies;
  Json files = Json::array(), list = Json::array();
  bool finished = true;
  long rollbacks = 0;
  for (Study study : {Study::particles, Study::stiffness, Study::time_step, Study::cg_tolerance}) {
    const StudyResult& result = studies.emplace_back(run_study(study, options.quick, common));
    finished = finished && result.all_finished();
    rollbacks += result.rollbacks();
    list.push_back(json_of(result));
    if (options.output.empty()) continue;
    for (const std::string& file :
         write_study(result, options.output + "/" + study_file(study), options.plots))
      files.push_back(file);
  }
  const std::string verdict =
      text("%s; %ld divergences were seen and undone",
           finished ? "every run stayed finite" : "not every run finished", rollbacks);
  if (common.json) {
    Json table = Json::array();
    for (const Claim& c : claims(studies))
      table.push_back({{"claim", c.claim}, {"paper", c.paper}, {"measured", c.measured}});
    std::cout << Json{{"claims", table},
                      {"studies", list},
                      {"all_finished", finished},
                      {"rollbacks", rollbacks},
                      {"provenance", provenance()},
                      {"files", files}}
                     .dump(2)
              << '\n';
  } else {
    std::cout << "| | the paper says | measured |\n|---|---|---|\n";
    for (const Claim& c : claims(studies))
      std::cout << "| " << c.claim << " | " << c.paper << " | " << c.measured << " |\n";
    std::cout << '\n' << verdict << "; " << provenance() << '\n';
  }
  return finished ? done : no_answer;
}

}  // namespace springstab
