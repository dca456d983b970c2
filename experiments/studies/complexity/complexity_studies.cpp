#include "experiments/studies/complexity/complexity_studies.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "experiments/command/output.h"

namespace springstab {
namespace {

// The paper's contestants, and symplectic Euler. LEU and linearized RK4 evaluate forces every 0.01 s.
const Racer eu{"EU", "explicit-euler"};
const Racer leu{"LEU", "linearized-explicit-euler"};
const Racer linear_rk4{"RK4 linear", "linearized-rk4"};
const Racer symplectic{"symplectic Euler", "symplectic-euler"};

// Implicit Euler as in the paper, with LEU's damping, and with the better preconditioner.
Racer implicit(const std::string& name, DampingRule damping, Preconditioner preconditioner,
               double tolerance) {
  return {name, "implicit-euler", damping, preconditioner, tolerance};
}
const Racer imp = implicit("IMP", DampingRule::drag, Preconditioner::block_jacobi, 1e-3);
const Racer imp_damped = implicit("IMP, D of LEU", DampingRule::leu, Preconditioner::block_jacobi, 1e-3);
const Racer imp_ssor = implicit("IMP SSOR", DampingRule::drag, Preconditioner::block_ssor, 1e-3);
const Racer imp_tight = implicit("IMP SSOR 1e-6", DampingRule::drag, Preconditioner::block_ssor, 1e-6);

std::vector<Heat> on_drapes(const std::vector<Racer>& contestants, const std::vector<Drape>& drapes,
                            double duration, const CommonOptions& common) {
  std::vector<Heat> heats;
  for (const Drape& drape : drapes) {
    const StiffestMode k0 = k0_of(drape, common);
    for (const Racer& contestant : contestants) heats.push_back({contestant, drape, k0, duration});
  }
  return heats;
}

std::vector<Heat> heats_of(Study study, bool quick, const CommonOptions& common) {
  const double duration = quick ? 0.1 : 0.5;
  const std::vector<Racer> all{imp, imp_damped, imp_ssor, imp_tight, eu, leu, linear_rk4, symplectic};
  std::vector<Drape> drapes;
  switch (study) {
    case Study::particles:
      for (int side : quick ? std::vector{8, 16, 32} : std::vector{8, 12, 16, 23, 32, 45, 64, 90, 128})
        drapes.push_back({.side = side});
      return on_drapes(all, drapes, duration, common);
    case Study::stiffness:  // a factor 1000 in k0
      for (double factor :
           quick ? std::vector{0.1, 1., 10.} : std::vector{0.0316, 0.1, 0.316, 1., 3.16, 10., 31.6})
        drapes.push_back({.side = 16, .stiffness_factor = factor});
      return on_drapes(all, drapes, duration, common);
    case Study::time_step: {
      const Drape drape{.side = quick ? 16 : 32};
      const StiffestMode k0 = k0_of(drape, common);
      std::vector<Heat> heats;
      for (double h :
           quick ? std::vector{0.001, 0.005, 0.02} : std::vector{0.0005, 0.001, 0.002, 0.005, 0.01, 0.02})
        for (const Racer& contestant : {imp, imp_damped, imp_ssor})
          heats.push_back({contestant, drape, k0, duration, h});
      return heats;
    }
    case Study::cg_tolerance: {
      const Drape drape{.side = quick ? 16 : 64};
      const StiffestMode k0 = k0_of(drape, common);
      std::vector<Heat> heats;
      for (double tolerance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-6})
        for (Racer contestant : {imp, imp_damped, imp_ssor}) {
          contestant.cg_tolerance = tolerance;
          heats.push_back({contestant, drape, k0, duration});
        }
      return heats;
    }
  }
  throw std::logic_error("unknown study");
}

const char* name(Preconditioner preconditioner) {
  return preconditioner == Preconditioner::block_ssor ? "block-ssor" : "block-jacobi";
}

}  // namespace

const Series& StudyResult::of(const std::string& name) const {
  const auto found = std::ranges::find(series, name, &Series::name);
  if (found == series.end()) throw std::invalid_argument("no contestant is called " + name);
  return *found;
}

bool StudyResult::all_finished() const {
  return std::ranges::all_of(
      series, [](const Series& s) { return std::ranges::all_of(s.points, &HeatResult::finished); });
}

long StudyResult::rollbacks() const {
  long sum = 0;
  for (const Series& s : series)
    for (const HeatResult& point : s.points) sum += point.rollbacks;
  return sum;
}

double abscissa(Study study, const HeatResult& result) {
  switch (study) {
    case Study::particles:
      return std::pow(result.heat.drape.side, 2);
    case Study::stiffness:
      return std::sqrt(result.heat.k0.value);
    case Study::time_step:
      return result.heat.interval;
    case Study::cg_tolerance:
      break;
  }
  return result.heat.contestant.cg_tolerance;
}

PowerLaw fit_seconds(Study study, const Series& series) {
  std::vector<double> x, y;
  for (const HeatResult& point : series.points) {
    x.push_back(abscissa(study, point));
    y.push_back(point.median_seconds());
  }
  return fit_power_law(x, y);
}

double predicted_iterations(const HeatResult& result) {
  const double h = result.h, k0 = result.heat.k0.value;
  const double d = result.heat.drape.damping.d0 + result.alpha * k0;
  return std::sqrt(1 + h * d + h * h * k0) * std::log(2 / result.heat.contestant.cg_tolerance) / 2;
}

StudyResult run_study(Study study, bool quick, const CommonOptions& common, Journal& journal) {
  static constexpr const char* labels[] = {"cost of particles", "cost of stiffness", "cost of the step",
                                           "cost of accuracy"};
  Progress progress(labels[static_cast<int>(study)], common.quiet);
  StudyResult result{study, {}, quick ? 3 : 5};
  for (HeatResult& heat : race(
           heats_of(study, quick, common), result.rounds, common,
           [&](double fraction) { progress.update(fraction); }, journal)) {
    auto series = std::ranges::find(result.series, heat.heat.contestant.name, &Series::name);
    if (series == result.series.end()) series = result.series.insert(series, {heat.heat.contestant.name, {}});
    series->points.push_back(std::move(heat));
  }
  return result;
}

void write_runs(const std::string& path, const StudyResult& result) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  out << "contestant,method,preconditioner,cg_tolerance,particles,k0,k0_products,duration,interval,step,"
         "alpha,d0,round,cpu_seconds,steps,force_evaluations,hessian_assemblies,block_products,"
         "cg_iterations,rollbacks,halved_steps,finished\n";
  for (const Series& series : result.series)
    for (const HeatResult& p : series.points)
      for (std::size_t round = 0; round < p.cpu_seconds.size(); ++round) {
        const Racer& c = p.heat.contestant;
        const bool implicit = p.counts.cg_iterations > 0;
        out << '"' << c.name << "\"," << c.method << ',' << (implicit ? name(c.preconditioner) : "") << ',';
        if (implicit) out << c.cg_tolerance;
        out << ',' << p.heat.drape.side * p.heat.drape.side << ',' << p.heat.k0.value << ','
            << p.heat.k0.products << ',' << p.heat.duration << ',' << p.heat.interval << ',' << p.h << ','
            << p.alpha << ',' << p.heat.drape.damping.d0 << ',' << round + 1 << ',' << p.cpu_seconds[round]
            << ',' << p.steps << ',' << p.counts.force_evaluations << ',' << p.counts.hessian_assemblies
            << ',' << p.counts.block_products << ',' << p.counts.cg_iterations << ',' << p.rollbacks << ','
            << p.halved_steps << ',' << p.finished << '\n';
      }
  file.commit();
}

void write_medians(const std::string& path, const StudyResult& result) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  const std::vector<HeatResult>& first = result.series.front().points;
  for (const Series& series : result.series) {
    out << "# " << series.name
        << "\n# x,median,least,most,relative,block_products,cg_iterations,predicted_iterations\n";
    for (std::size_t i = 0; i < series.points.size(); ++i) {
      const HeatResult& p = series.points[i];
      const auto [least, most] = std::ranges::minmax(p.cpu_seconds);
      out << abscissa(result.study, p) << ',' << p.median_seconds() << ',' << least << ',' << most << ','
          << p.median_seconds() / first[i].median_seconds() << ',' << p.counts.block_products << ','
          << p.counts.cg_iterations << ',' << predicted_iterations(p) * static_cast<double>(p.steps) << '\n';
    }
    out << "\n\n";
  }
  file.commit();
}

}  // namespace springstab
