// Damped Hookean springs as terms of a scene. With d = x_i - x_j, l = |d|, n = d/l:
//     E = ½ k_s (l - l0)²,   f_i = -k_s (l - l0) n,                               (course notes Eqs. 1, 5)
//     -∂f_i/∂x_i = k_s [(1 - l0/l)(I - nnᵀ) + nnᵀ],                               (course notes Eq. 17)
//     f_i = -k_d ((v_i - v_j)·n) n,   -∂f_i/∂v_i = k_d nnᵀ,                       (course notes Eqs. 2, 18)
// and the opposite on j. Two particles in one place leave n undefined: the force is then not a number and the
// step reports that it diverged.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "solvers/scene/particle_parts.h"
#include "solvers/scene/spring_cloth.h"
#include "solvers/scene/terms.h"

namespace springstab {

/// Pairs of particles in a scene's own numbers: free ones first, `free_count` of them. Worked on in batches
/// that stay in the first-level cache. Pairs (i, j), (i + 1, j + 1), ... are a run, as a grid is full of
/// them: their particles' vectors are read and added one after another, without looking up any.
class ParticlePairs {
 public:
  static constexpr int batch_size = 192;
  /// One number per pair of a batch, and a vector per pair, three numbers after another.
  using Numbers = double[batch_size];
  using Vectors = double[3 * batch_size];
  /// Of one pair, the block a I + b uuᵀ; u with a zero behind.
  struct Kept {
    double u[4], a, b;
  };

  /// The springs in an order of long runs that keeps neighbours together.
  static std::vector<Spring> in_runs(std::vector<Spring> springs);

  ParticlePairs(const std::vector<Spring>& springs, int free_count);

  int size() const { return size_; }
  Couplings couplings() const;
  void bind(const SharedPattern& pattern);
  /// Frees all that blocks take.
  void unbind();

  /// Calls work(begin, count) for every batch, one after another.
  template <class Work>
  void for_each_batch(const Work& work) const {
    for (int begin = 0; begin < size(); begin += batch_size)
      work(begin, std::min(batch_size, size() - begin));
  }
  /// The same where it is worth it on several threads, each batch on one of them.
  template <class Work>
  void for_each_batch_at_once(const Work& work) const;
  /// Calls work(begin, count, mine) for every batch, where it is worth it on several threads: with each part
  /// of the free particles, `mine`, for the batches that have some of them, which must write to no others.
  template <class Work>
  void share_batches(const Work& work) const;

  /// out = u_i - u_j for the pairs of the batch that begins there.
  void gather(const ParticleField& u, int begin, Vectors& out) const;
  /// The same of free particles' vectors that are zero at the pinned ones.
  void gather(const double* u, int begin, Vectors& out) const;
  /// out_i += u, out_j -= u at those free particles that are `mine`.
  void scatter(const Vectors& u, int begin, const IndexRange& mine, double* out) const;
  /// Blocks B = a I + b uuᵀ are kept until all are known, and then matrix += [[B, -B], [-B, B]] on the free
  /// particles, row by row of the matrix: to scatter them pair by pair misses the caches too often.
  void keep(const Numbers& a, const Numbers& b, const Vectors& u, int begin, int count) const;
  void add_kept_blocks(BlockSparseMatrix& matrix) const;
  /// Makes room for them, before.
  void prepare_blocks() const;

 private:
  static constexpr double pair_cost = 5;  // [ns]

  /// Within one batch; either the first particles of all its pairs are free or none, and so the second ones.
  struct Run {
    int i, j, count;
  };

  /// Calls visit(pair, i, j) for all of them.
  template <class Visit>
  void visit_pairs(const Visit& visit) const;
  template <class At>
  void gather_from(const At& at, int begin, Vectors& out) const;
  std::span<const Run> runs(int begin) const {
    const int batch = begin / batch_size;
    return {runs_.data() + run_start_[batch], runs_.data() + run_start_[batch + 1]};
  }

  bool touches(int batch, const IndexRange& particles) const;

  /// Where the block that a pair of i and another particle stands for is in row i of a pattern; -1 if it lies
  /// above the diagonal or the other one is pinned.
  static long find_place(const BlockPattern& pattern, int i, int other) {
    return other < i ? pattern.find(i, other) : -1;
  }

  int size_, free_count_;
  std::vector<Run> runs_;
  std::vector<int> run_start_;  // of each batch
  /// A pair of a free particle.
  struct Incident {
    int pair, other;
  };
  SharedPattern pattern_;    // that places are known of
  std::vector<long> place_;  // of each incident pair in the pattern
  // Of blocks, none before they are asked for:
  mutable std::vector<long> incident_start_;  // the pairs of each free particle, in compressed rows
  mutable std::vector<Incident> incident_;
  mutable std::vector<Kept> kept_;
  mutable ParticleParts parts_;
};

template <class Work>
void ParticlePairs::for_each_batch_at_once(const Work& work) const {
  const int batches = static_cast<int>(run_start_.size()) - 1;
  share_range(batches, pair_cost * batch_size, [&](long first, long last) {
    for (int begin = static_cast<int>(first) * batch_size; begin < std::min<long>(size(), last * batch_size);
         begin += batch_size)
      work(begin, std::min(batch_size, size() - begin));
  });
}

template <class Work>
void ParticlePairs::share_batches(const Work& work) const {
  const int batches = static_cast<int>(run_start_.size()) - 1;
  parts_.share(
      batches, free_count_, pair_cost * size(), [&](int b, const IndexRange& r) { return touches(b, r); },
      [&](int batch, const IndexRange& mine) {
        const int begin = batch * batch_size;
        work(begin, std::min(batch_size, size() - begin), mine);
      });
}

/// The elastic part.
class Springs final : public ElasticTerm {
 public:
  Springs(const std::vector<Spring>& springs, int free_count);

  std::string_view name() const override { return "springs"; }
  int size() const override { return pairs_.size(); }
  double energy(const ParticleField& x) const override;
  void add_force(const ParticleField& x, double* force) const override;
  void add_stiffness_times(const ParticleField& x, const double* u, double scale, double* out) const override;
  void add_damped_force(const ParticleField& x, const double* v, double alpha, double* force) const override;
  Couplings couplings() const override { return pairs_.couplings(); }
  void bind(const SharedPattern& pattern) override { pairs_.bind(pattern); }
  void unbind() override { pairs_.unbind(); }
  void add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override;
  /// Without the transverse stiffness k_s (1 - l0/l) where a spring is shorter than at rest.
  void add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override;

 private:
  template <class StiffnessOf>
  void add_blocks(const ParticleField& x, BlockSparseMatrix& matrix, const StiffnessOf& block_of) const;

  ParticlePairs pairs_;
  std::vector<double> stiffness_, rest_length_;
};

/// The damping part, over the springs with k_d > 0.
class AxialDamping final : public DampingTerm {
 public:
  AxialDamping(const std::vector<Spring>& springs, int free_count);

  std::string_view name() const override { return "dampers along springs"; }
  int size() const override { return pairs_.size(); }
  void add_force(const ParticleField& x, const ParticleField& v, double* force) const override;
  Couplings couplings() const override { return pairs_.couplings(); }
  void bind(const SharedPattern& pattern) override { pairs_.bind(pattern); }
  void unbind() override { pairs_.unbind(); }
  void add_damping(const ParticleField& x, BlockSparseMatrix& damping) const override;

 private:
  ParticlePairs pairs_;
  std::vector<double> damping_;
};

/// The terms of a net in a scene whose numbers of the particles are number[i], free ones first, `free_count`
/// of them. Springs between pinned particles alone and terms without springs are left out.
SceneTerms make_terms(const SpringNet& net, const std::vector<int>& number, int free_count);

}  // namespace springstab
