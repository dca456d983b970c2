// The graph of a symmetric matrix, and METIS's answers about it: an order of elimination by nested
// dissection, and a division into parts. One, two or three unknowns in a row are a node, whichever makes the
// smaller graph where nothing else is said: those of a particle.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace springstab {

struct Graph {
  int unknowns_a_node = 1;
  std::vector<int> start{0}, neighbour;  // of each node, ascending, without itself

  int size() const { return static_cast<int>(start.size()) - 1; }
  bool operator==(const Graph&) const = default;
};

/// Both triangles are stored, zeros included.
Graph graph_of(const Eigen::SparseMatrix<double>& a);
Graph graph_of(const Eigen::SparseMatrix<double>& a, int unknowns_a_node);

/// Old numbers of the unknowns, in the order of elimination; empty where memory ran out.
std::vector<long> dissection_order(const Eigen::SparseMatrix<double>& a);

/// ball[r]: how many nodes are at most r edges away from a node, the most of some nodes all over the graph;
/// up to `layers` + 1 beyond the first ball of more than `nodes`, or to where no more are reached.
std::vector<long> largest_balls(const Graph& graph, long nodes, int layers);

/// The part of each node, of `parts` about equal ones.
std::vector<int> parts_of(const Graph& graph, int parts);

}  // namespace springstab
