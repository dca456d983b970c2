#include "analysis/proofs/graph_parts.h"

#include <metis.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace springstab {
namespace {

static_assert(std::is_same_v<idx_t, int>, "METIS with 32-bit indices");

// METIS draws from rand(), which it seeds anew at each call: one call at a time, lest two threads share a
// sequence and get others each time.
std::mutex one_call;

// METIS takes what it only reads as not constant.
idx_t* pointer(const std::vector<int>& v) { return const_cast<idx_t*>(v.data()); }

// take(node, other) for each coupling of two nodes, which are so many unknowns each of those that have a
// place.
template <class Take>
void for_each_coupling(const Eigen::SparseMatrix<double>& a, const std::vector<int>& place, int together,
                       const Take& take) {
  std::vector<int> seen(a.rows() / together + 1, -1);
  for (Eigen::Index column = 0; column < a.cols(); ++column) {
    if (place[column] < 0) continue;
    const int node = place[column] / together;
    seen[node] = node;
    for (Eigen::SparseMatrix<double>::InnerIterator it(a, column); it; ++it)
      if (const int other = place[it.row()] / together; seen[other] != node) {
        seen[other] = node;
        take(node, other);
      }
  }
}

std::vector<int> all_in_place(const Eigen::SparseMatrix<double>& a) {
  std::vector<int> place(a.rows());
  std::iota(place.begin(), place.end(), 0);
  return place;
}

// The unknowns of a particle are coupled to much the same others: as one node they have the fewest unknowns
// at the ends of couplings. METIS's time is one of nodes: single unknowns count half as much again.
int unknowns_a_particle(const Eigen::SparseMatrix<double>& a, const std::vector<int>& place, int unknowns) {
  int best = 1;
  double fewest = std::numeric_limits<double>::infinity();
  for (const auto& [together, weight] : {std::pair(1, 1.5), {2, 1.0}, {3, 1.0}}) {
    if (unknowns % together != 0) continue;
    double ends = 0;
    for_each_coupling(a, place, together, [&, by = weight * together](int, int) { ends += by; });
    if (ends <= fewest) fewest = ends, best = together;
  }
  return best;
}

Graph graph_of(const Eigen::SparseMatrix<double>& a, const std::vector<int>& place, int unknowns,
               int together) {
  Graph graph;
  graph.unknowns_a_node = together;
  const auto end_node = [&graph] {
    std::sort(graph.neighbour.begin() + graph.start.back(), graph.neighbour.end());
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  };
  for_each_coupling(a, place, together, [&](int node, int other) {
    while (graph.size() < node) end_node();
    graph.neighbour.push_back(other);
  });
  while (graph.size() < unknowns / together) end_node();
  return graph;
}

// Empty where memory ran out.
std::vector<int> order_of_nodes(const Graph& graph) {
  // The same patterns are asked about again, by each of several proofs about a structure.
  struct Known {
    Graph graph;
    std::vector<int> order;
  };
  constexpr std::size_t remembered = 2;
  static std::vector<Known> known;
  const std::lock_guard alone(one_call);
  for (const Known& k : known)
    if (k.graph == graph) return k.order;
  idx_t nodes = graph.size();
  std::vector<int> order(nodes), place(nodes);
  if (METIS_NodeND(&nodes, pointer(graph.start), pointer(graph.neighbour), nullptr, nullptr, order.data(),
                   place.data()) != METIS_OK)
    return {};
  if (known.size() == remembered) known.erase(known.begin());
  known.push_back({graph, order});
  return order;
}

}  // namespace

Graph graph_of(const Eigen::SparseMatrix<double>& a) {
  const int unknowns = static_cast<int>(a.rows());
  return graph_of(a, unknowns_a_particle(a, all_in_place(a), unknowns));
}

Graph graph_of(const Eigen::SparseMatrix<double>& a, int together) {
  return graph_of(a, all_in_place(a), static_cast<int>(a.rows()), together);
}

// What is coupled to nothing, as sideways in a flat net at rest, comes first and is in nobody's way.
std::vector<long> dissection_order(const Eigen::SparseMatrix<double>& a) {
  std::vector<long> order, coupled;
  std::vector<int> place(a.rows(), -1);
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    const bool alone = a.outerIndexPtr()[j + 1] - a.outerIndexPtr()[j] == 1;
    if (!alone) place[j] = static_cast<int>(coupled.size());
    (alone ? order : coupled).push_back(j);
  }
  const int unknowns = static_cast<int>(coupled.size());
  const Graph graph = graph_of(a, place, unknowns, unknowns_a_particle(a, place, unknowns));
  const std::vector<int> nodes = order_of_nodes(graph);
  if (std::ssize(nodes) < graph.size()) return {};
  for (const int node : nodes)
    for (int k = 0; k < graph.unknowns_a_node; ++k)
      order.push_back(coupled[graph.unknowns_a_node * node + k]);
  return order;
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
