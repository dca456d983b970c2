// What was mended in a mesh file and what is unusual in it, for people and for programs.
#pragma once

#include <string>
#include <vector>

#include "experiments/command/output.h"
#include "experiments/inputs/subject.h"

namespace springstab {

/// A line for each thing that its reader left out, one for what was mended, one for what is
/// unusual, one for a texture map that strains the cloth or cannot be used, one for a texture_unit without a
/// map; nothing for a mesh without these, for grids without that unit and for matrices.
std::vector<std::string> mesh_notes(const Subject& subject);
/// On stderr.
void print_mesh_notes(const Subject& subject);

/// The same with every count; null for grids and matrices.
Json mesh_json(const Subject& subject);

}  // namespace springstab
