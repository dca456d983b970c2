// The questions of the paper's §5 as races: how cost grows with the number of particles, with the stiffness,
// and implicit Euler's with its step; and how tight implicit Euler's conjugate gradients should be.
#pragma once

#include <string>
#include <vector>

#include "analysis/errors/power_law.h"
#include "experiments/studies/complexity/race.h"

namespace springstab {

enum class Study {
  particles,     // Fig. 5: CPU time against n at one k0
  stiffness,     // Fig. 6: against √k0 at one n
  time_step,     // Fig. 7: implicit Euler against h
  cg_tolerance,  // implicit Euler against the tolerance of its conjugate gradients
};

/// All of a contestant's heats in one study, by ascending abscissa.
struct Series {
  std::string name;
  std::vector<HeatResult> points;
};

struct StudyResult {
  Study study;
  std::vector<Series> series;
  int rounds = 0;

  const Series& of(const std::string& name) const;
  bool all_finished() const;
  long rollbacks() const;
};

/// The abscissa of a study: particles, √k0 [1/s], h [s] or tolerance.
double abscissa(Study study, const HeatResult& result);

/// The law that a series' CPU seconds follow in its abscissa.
PowerLaw fit_seconds(Study study, const Series& series);

/// Conjugate gradient iterations a step after the paper's Eq. 35, its sign corrected: ½ √σ ln(2/ε) with the
/// condition number σ ≈ 1 + h d + h² k0, d = d0 + alpha k0, of the system without its preconditioner.
double predicted_iterations(const HeatResult& result);

/// `quick` takes fewer and smaller drapes, a shorter time and three rounds instead of five.
/// Each run is a piece of the journal.
StudyResult run_study(Study study, bool quick, const CommonOptions& common,
                      Journal& journal = Journal::none());

/// One row a run, in the order of series, points and rounds.
void write_runs(const std::string& path, const StudyResult& result);

/// For gnuplot: a block of rows per series with the abscissa, the median, least and most CPU seconds, the
/// median over that of the first series, block products, CG iterations and predicted ones of the whole run;
/// two blank lines between blocks.
void write_medians(const std::string& path, const StudyResult& result);

}  // namespace springstab
