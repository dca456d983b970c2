// Contests as files: the runs, a picture, and the table of what is cheapest.
#pragma once

#include <string>
#include <vector>

#include "experiments/studies/gnuplot.h"
#include "experiments/studies/precision/contest.h"

namespace springstab {

/// The errors that the table is about.
inline constexpr double wanted_errors[] = {0.1, 0.01, 0.001, 1e-6};

/// Per contest the cheapest method of the project, and the cheapest library, for each wanted error, with its
/// CPU milliseconds; Markdown.
std::string cheapest_table(const std::vector<ContestResult>& results);

/// Per contest the error of its reference, as published and as the third integrator has it; Markdown.
std::string reference_table(const std::vector<ContestResult>& results);

/// Writes DATA.csv (or DATA_1.csv, DATA_2.csv ...), the points for gnuplot and the picture: a row of panels
/// per contest, error against CPU seconds and against force evaluation equivalents. Returns the paths.
std::vector<std::string> write_contests(const std::vector<ContestResult>& results, const FigureFiles& files,
                                        const std::string& plots);

}  // namespace springstab
