// Proofs of definiteness by all ranks: up to one piece's size by one factorization, else each rank by its own
// pieces (analysis/proofs/pieces.h), for which it gets the rows of its neighbours once. And what MUMPS says
// of small systems.
#pragma once

#include <memory>
#include <optional>

#include "analysis/proofs/definiteness.h"
#include "analysis/proofs/pieces.h"
#include "experiments/mpi/system.h"

namespace springstab::mpi {

class DistributedProof {
 public:
  /// Up to as many unknowns one factorization proves, on one rank.
  static constexpr PetscInt one_piece = 3 * Pieces::usual_particles;

  /// `system` must outlive it.
  DistributedProof(const System& system, double loss);

  /// Whether c M - a D - b K is proved to be positive definite. All ranks ask the same.
  bool holds(double c, double a, double b);
  /// Of all ranks; 0 where one factorization proves.
  long pieces() const { return pieces_; }
  /// A coupling_ratio of D and K (analysis/proofs/sum_of_couplings.h); 0 where none is known.
  double coupling_ratio() const;
  /// Whether K has no eigenvalue below 0 but for rounding; nothing where that is not tested.
  std::optional<bool> stiffness_is_semidefinite();

 private:
  void take_own_pieces(double loss);

  const System& system_;
  StructuralMatrices around_;             // of this rank's rows and those that its pieces need besides
  IndexRange columns_{0, 0};              // of these, this rank's own
  std::optional<DefinitenessProof> own_;  // this rank's
  long pieces_ = 0;
};

/// Whether D, a matrix like the system's, has no eigenvalue below 0; nothing where that is not tested.
std::optional<bool> is_semidefinite(Mat d, const System& system);

/// How many eigenvalues of M⁻¹K are above sigma, by MUMPS's inertia of sigma M - K: in floating point, no
/// proof. Nothing of more unknowns than `one_piece`.
std::optional<long> eigenvalues_above(double sigma, const System& system);

}  // namespace springstab::mpi
