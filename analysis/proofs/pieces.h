// A proof of definiteness by pieces that overlap, each a small factorization, for matrices too large to be
// factorized at once. With weights χ_p of particles, Σ_p χ_p² = 1, and g_ij = Σ_p χ_p(i) χ_p(j),
//     Q = Σ_p χ_p Q χ_p + E,   E_ij = (1 - g_ij) Q_ij,
// exactly; E lives where pieces overlap and is of second order in an edge's length over the overlap's. As
// diag(e) + E is positive semidefinite for e_i >= Σ_j |E_ij|, Q is positive definite if every Q - diag(e) on
// the particles of a piece is. Memory beside the matrix is that of one piece, and the work grows with n.
#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "analysis/proofs/graph_parts.h"
#include "solvers/linear/structural_matrices.h"

namespace springstab {

class Pieces {
 public:
  /// Of the graph of a symmetric matrix, both triangles stored: parts of about `particles` nodes, and
  /// `layers` of neighbours around each.
  Pieces(const SparseMatrix& pattern, int particles, int layers);
  /// The same of parts that cost least, of at most `usual_particles`.
  Pieces(const SparseMatrix& pattern, int layers);

  /// Some of the pieces of a larger matrix, whose others are proved elsewhere: those around the first `own`
  /// parts, of the parts that its nodes are in. `graph` is the larger one's, of all nodes up to
  /// 2 layers + 1 from these parts.
  Pieces(const Graph& graph, const std::vector<int>& part, int own, int layers);

  static constexpr int usual_particles = 20'000;
  /// How many nodes a part has whose proof costs least for each of its nodes, at most `usual_particles`: what
  /// surrounds a part is eliminated as well, which in a solid grows faster than in a net.
  static int cheapest_particles(const Graph& graph, int layers);
  /// How many layers lose about `loss` of an eigenvalue.
  static int layers_for(double loss);

  /// A symmetric matrix of the graph whose columns are formed when they are asked for, by several threads at
  /// a time: the entries of the pattern, of which that on the diagonal does not count.
  struct Formed {
    const SparseMatrix& pattern;
    const Eigen::VectorXd& diagonal;
    std::function<void(Eigen::Index j, double* values)> column;
  };

  int count() const { return own_; }
  /// Whether `q`, of that graph, is proved to be positive definite, rounding included; of a larger matrix,
  /// what these pieces contribute. Threads share the pieces (solvers/team.h).
  bool prove(const Formed& q) const;
  bool prove(const SparseMatrix& q) const;

 private:
  struct Weight {
    int piece;
    double value;  // χ_piece of the node
  };
  using Distances = std::vector<std::pair<int, int>>;  // of nodes from a part, ascending by the nodes
  Pieces(const Graph& graph, int particles, int layers);
  double shared(int i, int j) const;  // g_ij
  std::span<const Weight> weights(int node) const {
    return {weights_.data() + weights_start_[node], weights_.data() + weights_start_[node + 1]};
  }
  void weigh(const std::vector<Distances>& pieces, int layers, int nodes);
  Eigen::VectorXd off_pieces(const Formed& q) const;
  bool prove_piece(const Formed& q, const Eigen::VectorXd& less, int piece, std::vector<int>& place) const;

  int unknowns_a_node_, own_ = 0;
  std::vector<std::vector<int>> nodes_;  // of each piece, ascending
  std::vector<int> weights_start_;       // of each node
  std::vector<Weight> weights_;          // by pieces
};

}  // namespace springstab
