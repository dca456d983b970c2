#include "solvers/scene/every_pose.h"

#include <algorithm>

namespace springstab {

StructuralMatrices every_pose(const SpringNet& net, const std::vector<int>& pinned,
                              const RayleighDamping& damping) {
  const int particles = static_cast<int>(net.rest.size());
  std::vector<int> place(particles);
  int free = 0;
  for (int i = 0; i < particles; ++i)
    place[i] = std::binary_search(pinned.begin(), pinned.end(), i) ? -1 : free++;

  const auto laplacian = [&](double Spring::*weight) {
    std::vector<Eigen::Triplet<double>> entries;
    for (const Spring& spring : net.springs) {
      const int i = place[spring.i], j = place[spring.j];
      const double w = spring.*weight;
      if (i >= 0) entries.emplace_back(i, i, w);
      if (j >= 0) entries.emplace_back(j, j, w);
      if (i < 0 || j < 0) continue;
      entries.emplace_back(i, j, -w);
      entries.emplace_back(j, i, -w);
    }
    SparseMatrix sum(free, free);
    sum.setFromTriplets(entries.begin(), entries.end());
    return sum;
  };
  StructuralMatrices s;
  s.stiffness = laplacian(&Spring::stiffness);
  Eigen::VectorXd mass(free);
  for (int i = 0; i < particles; ++i)
    if (place[i] >= 0) mass[place[i]] = net.mass[i];
  s.mass = SparseMatrix(mass.asDiagonal());
  const SparseMatrix own = laplacian(&Spring::damping);
  const bool any = damping.d0 > 0 || damping.alpha > 0 || own.norm() > 0;
  if (any) s.damping = damping.d0 * s.mass + damping.alpha * s.stiffness + own;
  return s;
}

}  // namespace springstab
