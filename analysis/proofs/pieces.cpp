#include "analysis/proofs/pieces.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <new>
#include <numbers>
#include <numeric>

#include "analysis/constants.h"
#include "analysis/proofs/sparse_cholesky.h"
#include "solvers/team.h"

namespace springstab {
namespace {

// The nodes up to `layers` edges away from a part, ascending, with their distances: 0 inside.
std::vector<std::pair<int, int>> neighbourhood(const Graph& graph, const std::vector<int>& inside, int layers,
                                               std::vector<char>& seen) {
  std::vector<std::pair<int, int>> found;
  for (const int node : inside) found.emplace_back(node, 0), seen[node] = 1;
  for (std::size_t next = 0; next < found.size(); ++next) {
    const auto [node, distance] = found[next];
    if (distance == layers) break;
    for (int k = graph.start[node]; k < graph.start[node + 1]; ++k)
      if (const int other = graph.neighbour[k]; !seen[other])
        seen[other] = 1, found.emplace_back(other, distance + 1);
  }
  for (const auto& [node, distance] : found) seen[node] = 0;
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

// The loss measured on nets is 0.15 / layers² to 0.4 / layers², the more where stiffnesses vary tenfold.
int Pieces::layers_for(double loss) {
  return std::clamp(static_cast<int>(std::ceil(std::sqrt(0.23 / loss))), 2, 64);
}

// Seconds a node of parts like balls of radius r, whose pieces are balls of radius r + layers. The largest
// front of a piece is about as wide as a fifth of its last shell; three unknowns a node, ten times the work
// of the last front, 20 GFlop/s. The rest of the work on a piece (to divide, order and analyze it) goes with
// its nodes. Measured on nets and on blocks of tetrahedra.
int Pieces::cheapest_particles(const Graph& graph, int layers) {
  constexpr double shell_cubed = 5e-11, node = 24e-6;  // [s]
  const std::vector<long> ball = largest_balls(graph, usual_particles, layers);
  long cheapest = usual_particles;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t r = 1; r + layers < ball.size() && ball[r] <= usual_particles; ++r) {
    const auto whole = static_cast<double>(ball[r + layers]);
    const double shell = whole - static_cast<double>(ball[r + layers - 1]);
    const double cost = (shell_cubed * shell * shell * shell + node * whole) / static_cast<double>(ball[r]);
    if (cost < least) least = cost, cheapest = ball[r + 1] > usual_particles ? usual_particles : ball[r];
  }
  return static_cast<int>(cheapest);
}

Pieces::Pieces(const SparseMatrix& pattern, int particles, int layers)
    : Pieces(graph_of(pattern), particles, layers) {}

Pieces::Pieces(const SparseMatrix& pattern, int layers) {
  const Graph graph = graph_of(pattern);
  *this = Pieces(graph, cheapest_particles(graph, layers), layers);
}

Pieces::Pieces(const Graph& graph, int particles, int layers) {
  const int parts = (graph.size() + particles - 1) / particles;
  *this = Pieces(graph, parts_of(graph, parts), parts, layers);
}

Pieces::Pieces(const Graph& graph, const std::vector<int>& part, int own, int layers)
    : unknowns_a_node_(graph.unknowns_a_node) {
  std::vector<std::vector<int>> inside(own);
  for (int node = 0; node < graph.size(); ++node) {
    if (part[node] >= std::ssize(inside)) inside.resize(part[node] + 1);
    inside[part[node]].push_back(node);
  }
  std::vector<char> seen(graph.size(), 0);
  std::vector<Distances> pieces;
  for (int p = 0; p < std::ssize(inside); ++p) {
    if (!inside[p].empty()) pieces.push_back(neighbourhood(graph, inside[p], layers, seen));
    if (p < own) own_ = static_cast<int>(pieces.size());
  }
  weigh(pieces, layers, graph.size());
}

void Pieces::weigh(const std::vector<Distances>& pieces, int layers, int nodes) {
  weights_start_.assign(nodes + 1, 0);
  for (const Distances& piece : pieces) {
    std::vector<int>& mine = nodes_.emplace_back();
    for (const auto& [node, distance] : piece) mine.push_back(node), ++weights_start_[node + 1];
  }
  std::partial_sum(weights_start_.begin(), weights_start_.end(), weights_start_.begin());
  weights_.resize(weights_start_.back());
  std::vector<int> next = weights_start_;
  for (int p = 0; p < std::ssize(pieces); ++p)
    for (const auto& [node, distance] : pieces[p])
      weights_[next[node]++] = {
          p, std::sin(std::numbers::pi / 2 * (1 - static_cast<double>(distance) / (layers + 1)))};
  for (int node = 0; node < nodes; ++node) {
    const auto all = weights_.begin();
    double sum = 0;
    for (int k = weights_start_[node]; k < weights_start_[node + 1]; ++k) sum += all[k].value * all[k].value;
    for (int k = weights_start_[node]; k < weights_start_[node + 1]; ++k) all[k].value /= std::sqrt(sum);
  }
}

double Pieces::shared(int i, int j) const {
  double sum = 0;
  const std::span<const Weight> a = weights(i), b = weights(j);
  for (auto p = a.begin(), q = b.begin(); p != a.end() && q != b.end();) {
    if (p->piece == q->piece)
      sum += p++->value * q++->value;
    else if (p->piece < q->piece)
      ++p;
    else
      ++q;
  }
  return sum;
}

// A bound e_i >= Σ_j |E_ij|. E is that of the weights as they are in floating point, which sum up to 1 but
// for rounding, so it has a diagonal, too.
Eigen::VectorXd Pieces::off_pieces(const Formed& q) const {
  constexpr double weights_rounding = 1e-14;  // of g, far fewer than 40 pieces at a node
  constexpr double column_cost = 100;         // [ns]
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(q.pattern.cols());
  share_range(q.pattern.cols(), column_cost, [&](long first, long last) {
    std::vector<double> values(static_cast<std::size_t>(most_in_a_column(q.pattern)));
    for (long j = first; j < last; ++j) {
      q.column(j, values.data());
      const int node = static_cast<int>(j) / unknowns_a_node_;
      const double* value = values.data();
      for (SparseMatrix::InnerIterator it(q.pattern, j); it; ++it) {
        const int other = static_cast<int>(it.row()) / unknowns_a_node_;
        const bool inner = weights(node).size() == 1 && weights(other).size() == 1 &&
                           weights(node)[0].piece == weights(other)[0].piece;
        const double missing = inner ? 0 : std::abs(1 - shared(node, other));
        sum[j] += (missing + weights_rounding) * std::abs(*value++);
      }
    }
  });
  return sum * (1 + 1e-10);  // of up to 10^5 terms a row
}

// Whether the principal submatrix of q - diag(less) on a piece is positive definite, but for the rounding of
// its own factorization. `place`: -1 for each unknown, before and after.
bool Pieces::prove_piece(const Formed& q, const Eigen::VectorXd& less, int piece,
                         std::vector<int>& place) const {
  std::vector<Eigen::Index> unknowns;
  for (const int node : nodes_[piece])
    for (int k = 0; k < unknowns_a_node_; ++k)
      unknowns.push_back(static_cast<Eigen::Index>(unknowns_a_node_) * node + k);
  for (std::size_t k = 0; k < unknowns.size(); ++k) place[unknowns[k]] = static_cast<int>(k);
  const auto size = static_cast<Eigen::Index>(unknowns.size());
  SparseMatrix part(size, size);
  std::vector<double> values(static_cast<std::size_t>(most_in_a_column(q.pattern)));
  for (Eigen::Index k = 0; k < size; ++k) {
    part.startVec(k);
    q.column(unknowns[k], values.data());
    const double* value = values.data();
    for (SparseMatrix::InnerIterator it(q.pattern, unknowns[k]); it; ++it, ++value)
      if (const int row = place[it.row()]; row >= 0) part.insertBack(row, k) = *value;
  }
  part.finalize();
  for (const Eigen::Index unknown : unknowns) place[unknown] = -1;
  SparseCholesky cholesky;
  if (!cholesky.analyze(part)) return false;
  const double error = cholesky.error() + 4 * unit_roundoff;
  for (Eigen::Index k = 0; k < size; ++k)
    part.coeffRef(k, k) = q.diagonal[unknowns[k]] - (less[unknowns[k]] + error * q.diagonal[unknowns[k]]);
  return cholesky.factorize(part);
}

// The verdict does not depend on who fails first.
bool Pieces::prove(const Formed& q) const {
  const Eigen::VectorXd off = off_pieces(q), left = q.diagonal - off;
  for (int piece = 0; piece < own_; ++piece)
    for (const int node : nodes_[piece])
      if (!(left.segment(static_cast<Eigen::Index>(unknowns_a_node_) * node, unknowns_a_node_).array() > 0)
               .all())
        return false;
  std::atomic<bool> all{true};
  const int parts = std::min(loop_threads(), count());
  if (parts == 0) return true;
  share(parts, [&](int part) {
    try {
      std::vector<int> place(q.pattern.rows(), -1);
      for (int piece = part; piece < count() && all; piece += parts)
        if (!prove_piece(q, off, piece, place)) all = false;
    } catch (const std::bad_alloc&) {
      all = false;  // not proved
    }
  });
  return all;
}

bool Pieces::prove(const SparseMatrix& q) const {
  const Eigen::VectorXd diagonal = q.diagonal();
  return prove({q, diagonal, [&](Eigen::Index j, double* values) {
                  const double* const from = q.valuePtr() + q.outerIndexPtr()[j];
                  std::copy(from, from + (q.outerIndexPtr()[j + 1] - q.outerIndexPtr()[j]), values);
                }});
}

}  // namespace springstab
