#include "analysis/proofs/pieces.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>
#include <numbers>

#include "analysis/constants.h"
#include "analysis/proofs/sparse_cholesky.h"
#include "solvers/team.h"

namespace springstab {
namespace {

// The nodes up to `layers` edges away from a part, with their distances: 0 inside.
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
  return found;
}

}  // namespace

// The loss measured on nets is 0.15 / layers² to 0.4 / layers², the more where stiffnesses vary tenfold.
int Pieces::layers_for(double loss) {
  return std::clamp(static_cast<int>(std::ceil(std::sqrt(0.23 / loss))), 2, 64);
}

Pieces::Pieces(const SparseMatrix& pattern, int particles, int layers) {
  const Graph graph = graph_of(pattern);
  const int parts = (graph.size() + particles - 1) / particles;
  *this = Pieces(graph, parts_of(graph, parts), parts, layers);
}

Pieces::Pieces(const Graph& graph, const std::vector<int>& part, int own, int layers)
    : unknowns_a_node_(graph.unknowns_a_node), weights_(static_cast<std::size_t>(graph.size())) {
  std::vector<std::vector<int>> inside(own);
  for (int node = 0; node < graph.size(); ++node) {
    if (part[node] >= std::ssize(inside)) inside.resize(part[node] + 1);
    inside[part[node]].push_back(node);
  }
  std::vector<char> seen(graph.size(), 0);
  for (int p = 0; p < std::ssize(inside); ++p) {
    add_piece(graph, inside[p], layers, seen);
    if (p < own) own_ = static_cast<int>(nodes_.size());
  }
  normalize();
}

void Pieces::add_piece(const Graph& graph, const std::vector<int>& inside, int layers,
                       std::vector<char>& seen) {
  if (inside.empty()) return;
  const int piece = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  for (const auto& [node, distance] : neighbourhood(graph, inside, layers, seen)) {
    nodes_.back().push_back(node);
    weights_[node].push_back(
        {piece, std::sin(std::numbers::pi / 2 * (1 - static_cast<double>(distance) / (layers + 1)))});
  }
  std::sort(nodes_.back().begin(), nodes_.back().end());
}

void Pieces::normalize() {
  for (std::vector<Weight>& weights : weights_) {
    double sum = 0;
    for (const Weight& w : weights) sum += w.value * w.value;
    for (Weight& w : weights) w.value /= std::sqrt(sum);
  }
}

double Pieces::shared(int i, int j) const {
  double sum = 0;
  const std::vector<Weight>&a = weights_[i], &b = weights_[j];
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
Eigen::VectorXd Pieces::off_pieces(const SparseMatrix& q) const {
  constexpr double weights_rounding = 1e-14;  // of g, far fewer than 40 pieces at a node
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(q.rows());
  for (Eigen::Index j = 0; j < q.cols(); ++j) {
    const int node = static_cast<int>(j) / unknowns_a_node_;
    for (SparseMatrix::InnerIterator it(q, j); it; ++it) {
      const int other = static_cast<int>(it.row()) / unknowns_a_node_;
      const bool inner = weights_[node].size() == 1 && weights_[other].size() == 1 &&
                         weights_[node][0].piece == weights_[other][0].piece;
      const double missing = inner ? 0 : std::abs(1 - shared(node, other));
      sum[j] += (missing + weights_rounding) * std::abs(it.value());
    }
  }
  return sum * (1 + 1e-10);  // of up to 10^5 terms a row
}

// Whether the principal submatrix of q - diag(less) on a piece is positive definite, but for the rounding of
// its own factorization. `place`: -1 for each unknown, before and after.
bool Pieces::prove_piece(const SparseMatrix& q, const Eigen::VectorXd& less, int piece,
                         std::vector<int>& place) const {
  std::vector<Eigen::Index> unknowns;
  for (const int node : nodes_[piece])
    for (int k = 0; k < unknowns_a_node_; ++k)
      unknowns.push_back(static_cast<Eigen::Index>(unknowns_a_node_) * node + k);
  for (std::size_t k = 0; k < unknowns.size(); ++k) place[unknowns[k]] = static_cast<int>(k);
  const auto size = static_cast<Eigen::Index>(unknowns.size());
  SparseMatrix part(size, size);
  for (Eigen::Index k = 0; k < size; ++k) {
    part.startVec(k);
    for (SparseMatrix::InnerIterator it(q, unknowns[k]); it; ++it)
      if (const int row = place[it.row()]; row >= 0) part.insertBack(row, k) = it.value();
  }
  part.finalize();
  for (const Eigen::Index unknown : unknowns) place[unknown] = -1;
  SparseCholesky cholesky;
  if (!cholesky.analyze(part)) return false;
  const double error = cholesky.error() + 4 * unit_roundoff;
  for (Eigen::Index k = 0; k < size; ++k)
    part.coeffRef(k, k) -= less[unknowns[k]] + error * q.coeff(unknowns[k], unknowns[k]);
  return cholesky.factorize(part);
}

// The verdict does not depend on who fails first.
bool Pieces::prove(const SparseMatrix& q) const {
  const Eigen::VectorXd off = off_pieces(q), left = q.diagonal() - off;
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
      std::vector<int> place(q.rows(), -1);
      for (int piece = part; piece < count() && all; piece += parts)
        if (!prove_piece(q, off, piece, place)) all = false;
    } catch (const std::bad_alloc&) {
      all = false;  // not proved
    }
  });
  return all;
}

}  // namespace springstab
