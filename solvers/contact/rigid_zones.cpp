#include "solvers/contact/rigid_zones.h"

#include <numeric>

namespace springstab {

RigidZones::RigidZones(std::span<const double> inverse_mass)
    : inverse_mass_(inverse_mass), parent_(inverse_mass.size()) {
  std::iota(parent_.begin(), parent_.end(), 0);
}

int RigidZones::root(int node) {
  while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
  return node;
}

bool RigidZones::join(const std::array<int, 4>& nodes) {
  bool joined = false;
  for (const int node : nodes) {
    const int a = root(nodes[0]), b = root(node);
    if (a == b) continue;
    parent_[std::max(a, b)] = std::min(a, b);
    joined = true;
  }
  return joined;
}

bool RigidZones::apply(std::span<Eigen::Vector3d> v) {
  struct Zone {
    Eigen::Vector3d momentum{0, 0, 0};
    double mass = 0;
    int members = 0;
    int held = -1;  // a node that cannot be moved
  };
  const int nodes = static_cast<int>(parent_.size());
  std::vector<Zone> zones(parent_.size());
  for (int i = 0; i < nodes; ++i) {
    Zone& zone = zones[root(i)];
    ++zone.members;
    if (inverse_mass_[i] > 0) {
      zone.momentum += v[i] / inverse_mass_[i];
      zone.mass += 1 / inverse_mass_[i];
    } else if (zone.held < 0) {
      zone.held = i;
    } else if (v[zone.held] != v[i]) {
      return false;
    }
  }
  for (int i = 0; i < nodes; ++i) {
    const Zone& zone = zones[root(i)];
    if (zone.members == 1) continue;
    v[i] = zone.held >= 0 ? v[zone.held] : Eigen::Vector3d(zone.momentum / zone.mass);
  }
  return true;
}

long RigidZones::count() {
  std::vector<int> members(parent_.size());
  for (int i = 0; i < static_cast<int>(parent_.size()); ++i) ++members[root(i)];
  long zones = 0;
  for (const int of_zone : members) zones += of_zone > 1;
  return zones;
}

}  // namespace springstab
