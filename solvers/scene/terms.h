// The terms that a scene sums: energies and dampings over its particles. One virtual call per term and
// evaluation, plain loops inside. A scene without a term does not have the object.
//
// A term of one's own derives from ElasticTerm or DampingTerm and joins a scene through a TermMaker:
//
//     scene.add([](const std::vector<int>& number, int free_count) {
//       SceneTerms mine;
//       mine.elastic.push_back(std::make_unique<MyAnchor>(number[7], free_count));
//       return mine;
//     });
#pragma once

#include <functional>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "solvers/linear/block_sparse_matrix.h"

namespace springstab {

/// Three numbers per particle: the free particles' from the state, then the pinned ones'.
struct ParticleField {
  const double* free;
  const double* pinned;
  int free_count;

  const double* operator[](int particle) const {
    return particle < free_count ? free + 3 * static_cast<long>(particle)
                                 : pinned + 3 * static_cast<long>(particle - free_count);
  }
};

/// Pairs of free particles that a term couples.
using Couplings = std::vector<std::pair<int, int>>;

/// An elastic energy E(x) [J]. Forces and products are added for free particles only, 3 per particle.
class ElasticTerm {
 public:
  virtual ~ElasticTerm() = default;
  /// What it is made of, in the plural, and how many of them act on free particles.
  virtual std::string_view name() const = 0;
  virtual int size() const = 0;
  virtual double energy(const ParticleField& x) const = 0;
  /// force -= ∂E/∂x [N].
  virtual void add_force(const ParticleField& x, double* force) const = 0;
  /// out += scale · K(x) u with K = ∂²E/∂x², exact, not projected; u and out have 3 entries per free
  /// particle.
  virtual void add_stiffness_times(const ParticleField& x, const double* u, double scale,
                                   double* out) const = 0;
  /// force -= ∂E/∂x + alpha K(x) v, for terms that can share work between the two.
  virtual void add_damped_force(const ParticleField& x, const double* v, double alpha, double* force) const {
    add_force(x, force);
    add_stiffness_times(x, v, -alpha, force);
  }
  virtual Couplings couplings() const = 0;
  /// Of a term whose elements change with x: lets couplings() be those at x, and says whether they are others
  /// than before.
  virtual bool couple_at(const ParticleField&) { return false; }
  /// Lets a term look up where its blocks are: called with each pattern of the matrices that add_stiffness
  /// will be given, and again after `unbind`, which frees what that took.
  virtual void bind(const SharedPattern&) {}
  virtual void unbind() {}
  /// stiffness += K(x) [N/m], exact, not projected to be positive semidefinite.
  virtual void add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const = 0;
  /// stiffness += a positive semidefinite matrix that is K(x) wherever that is positive semidefinite element
  /// by element. Its spectrum is another than K's.
  virtual void add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const = 0;
};

/// A damping force -C(x) v of the material, with C symmetric positive semidefinite.
class DampingTerm {
 public:
  virtual ~DampingTerm() = default;
  virtual std::string_view name() const = 0;
  virtual int size() const = 0;
  /// force -= C(x) v [N].
  virtual void add_force(const ParticleField& x, const ParticleField& v, double* force) const = 0;
  virtual Couplings couplings() const = 0;
  virtual bool couple_at(const ParticleField&) { return false; }
  /// Likewise with the pattern of those that add_damping will be given.
  virtual void bind(const SharedPattern&) {}
  virtual void unbind() {}
  /// damping += C(x) [N·s/m]. The change of C with x is neglected, as everywhere.
  virtual void add_damping(const ParticleField& x, BlockSparseMatrix& damping) const = 0;
};

/// All that acts on a scene's particles but gravity and Rayleigh damping.
struct SceneTerms {
  std::vector<std::unique_ptr<ElasticTerm>> elastic;
  std::vector<std::unique_ptr<DampingTerm>> damping;
};

/// Makes terms in a scene's numbers: particle p of those that the scene was made of is number[p], and the
/// first `free_count` numbers are those of the particles that can move.
using TermMaker = std::function<SceneTerms(const std::vector<int>& number, int free_count)>;

}  // namespace springstab
