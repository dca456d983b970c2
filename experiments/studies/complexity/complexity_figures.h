// Studies of what methods cost as pictures: Figures 5, 6 and 7 of the paper.
#pragma once

#include <string>
#include <vector>

#include "experiments/studies/complexity/complexity_studies.h"
#include "experiments/studies/gnuplot.h"

namespace springstab {

/// The study's name for files and on the command line: figure_5_particles and so on, complexity_cg_tolerance.
std::string study_file(Study study);

/// Writes DATA.csv, a row a run, and but for the tolerance, which has no figure, DATA_medians.csv and the
/// picture by the gnuplot scripts in `plots`. Returns the files' paths.
std::vector<std::string> write_study(const StudyResult& result, const FigureFiles& files,
                                     const std::string& plots);

}  // namespace springstab
