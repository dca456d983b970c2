#include "analysis/proofs/graph_parts.h"

#include <metis.h>

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <type_traits>

namespace springstab {
namespace {

static_assert(std::is_same_v<idx_t, int>, "METIS with 32-bit indices");

// METIS draws from rand(), which it seeds anew at each call: one call at a time, lest two threads share a
// sequence and get others each time.
std::mutex one_call;

// METIS takes what it only reads as not constant.
idx_t* pointer(const std::vector<int>& v) { return const_cast<idx_t*>(v.data()); }

}  // namespace

Graph graph_of(const Eigen::SparseMatrix<double>& a) { return graph_of(a, a.rows() % 3 == 0 ? 3 : 1); }

Graph graph_of(const Eigen::SparseMatrix<double>& a, int together) {
  Graph graph;
  const int nodes = static_cast<int>(a.rows()) / together;
  graph.unknowns_a_node = together;
  std::vector<int> seen(nodes, -1);
  for (int node = 0; node < nodes; ++node) {
    seen[node] = node;
    for (int column = together * node; column < together * (node + 1); ++column)
      for (Eigen::SparseMatrix<double>::InnerIterator it(a, column); it; ++it)
        if (const int other = static_cast<int>(it.row()) / together; seen[other] != node) {
          seen[other] = node;
          graph.neighbour.push_back(other);
        }
    std::sort(graph.neighbour.begin() + graph.start.back(), graph.neighbour.end());
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

std::vector<long> dissection_order(const Eigen::SparseMatrix<double>& a) {
  const Graph graph = graph_of(a);
  const int together = graph.unknowns_a_node;
  idx_t nodes = graph.size();
  std::vector<int> order(nodes), place(nodes);
  const std::lock_guard alone(one_call);
  if (METIS_NodeND(&nodes, pointer(graph.start), pointer(graph.neighbour), nullptr, nullptr, order.data(),
                   place.data()) != METIS_OK)
    return {};
  std::vector<long> unknowns;
  unknowns.reserve(a.rows());
  for (const int node : order)
    for (int k = 0; k < together; ++k) unknowns.push_back(static_cast<long>(together) * node + k);
  return unknowns;
}

std::vector<long> largest_balls(const Graph& graph, long nodes, int layers) {
  constexpr int centres = 8;
  std::vector<long> most;
  std::vector<char> seen(graph.size(), 0);
  for (int c = 0; c < centres; ++c) {
    std::vector<int> found{static_cast<int>((2 * c + 1L) * graph.size() / (2 * centres))};
    seen[found[0]] = 1;
    std::vector<long> ball{1};
    for (long first = 0, beyond = 0; first < ball.back() && beyond <= layers; beyond += ball.back() > nodes) {
      for (const long last = ball.back(); first < last; ++first)
        for (int k = graph.start[found[first]]; k < graph.start[found[first] + 1]; ++k)
          if (const int other = graph.neighbour[k]; !seen[other]) seen[other] = 1, found.push_back(other);
      ball.push_back(std::ssize(found));
    }
    for (const int node : found) seen[node] = 0;
    if (most.size() < ball.size()) most.resize(ball.size(), 0);
    for (std::size_t r = 0; r < most.size(); ++r)
      most[r] = std::max(most[r], ball[std::min(r, ball.size() - 1)]);
  }
  return most;
}

std::vector<int> parts_of(const Graph& graph, int parts) {
  idx_t nodes = graph.size(), constraints = 1, number = parts, cut = 0;
  std::vector<int> part(nodes, 0);
  const std::lock_guard alone(one_call);
  if (parts > 1 && METIS_PartGraphKway(&nodes, &constraints, pointer(graph.start), pointer(graph.neighbour),
                                       nullptr, nullptr, nullptr, &number, nullptr, nullptr, nullptr, &cut,
                                       part.data()) != METIS_OK)
    throw std::runtime_error("METIS could not divide a graph of " + std::to_string(nodes) + " nodes");
  return part;
}

}  // namespace springstab
