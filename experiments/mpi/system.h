// What springstab-mpi works on: K, D and M of a structure, each rank with its rows from the start.
#pragma once

#include <optional>

#include "analysis/limits/structure.h"
#include "experiments/inputs/subject.h"
#include "experiments/mpi/petsc.h"

namespace springstab::mpi {

/// Scaled by S = diag(M)^(-1/2) from both sides, so that M has a unit diagonal.
struct System {
  OwnedMat stiffness;       // S K S [1/s²]
  OwnedMat damping;         // S D S [1/s], where it is not Rayleigh's; else none
  OwnedMat mass;            // S M S; none where that is the unit matrix
  bool one_pattern = true;  // D and M have entries only where K has
  int unknowns_a_node = 1;  // that rows of the matrices keep together
  PetscInt size = 0;
  DampingModel model;

  // Of a scene:
  std::optional<SceneSize> scene_size{};
  std::unique_ptr<Subject> mesh{};  // where it is made of a mesh file
};

/// Throws on all ranks for unusable input.
System read_system(const InputOptions& options);

/// Parts of it.
System scene_system(const SceneDescription& description);
System matrix_system(const InputOptions& options);

}  // namespace springstab::mpi
