// Which numbers of a frame are a model's unknowns.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "experiments/inputs/subject.h"

namespace springstab {

/// For each unknown its place among the numbers of a frame: all vertices of a scene's mesh file, or its
/// particles, three numbers each, or the unknowns alone. Throws InputError(source, ...) for frames of another
/// size.
std::vector<Eigen::Index> unknowns_in_frame(Model& model, const Subject* scene, Eigen::Index numbers,
                                            const std::string& source);

}  // namespace springstab
