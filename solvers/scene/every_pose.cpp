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

  Eigen::VectorXi entries = Eigen::VectorXi::Ones(free);  // of a column at most: no list of all is made
  for (const Spring& spring : net.springs)
    for (const int p : {place[spring.i], place[spring.j]})
      if (p >= 0) ++entries[p];

  const auto laplacian = [&](double Spring::*weight) {
    SparseMatrix sum(free, free);
    sum.reserve(entries);
    for (const Spring& spring : net.springs) {
      const int i = place[spring.i], j = place[spring.j];
      const double w = spring.*weight;
      if (i >= 0) sum.coeffRef(i, i) += w;
      if (j >= 0) sum.coeffRef(j, j) += w;
      if (i < 0 || j < 0) continue;
      sum.coeffRef(i, j) -= w;
      sum.coeffRef(j, i) -= w;
    }
    sum.makeCompressed();
    return sum;
  };
  StructuralMatrices s;
  s.stiffness = laplacian(&Spring::stiffness);
  Eigen::VectorXd mass(free);
  for (int i = 0; i < particles; ++i)
    if (place[i] >= 0) mass[place[i]] = net.mass[i];
  s.mass = SparseMatrix(mass.asDiagonal());
  const bool own = std::ranges::any_of(net.springs, [&](const Spring& spring) {
    return spring.damping != 0 && std::max(place[spring.i], place[spring.j]) >= 0;
  });
  if (own || damping.d0 > 0 || damping.alpha > 0)
    s.damping = damping.d0 * s.mass + damping.alpha * s.stiffness + laplacian(&Spring::damping);
  return s;
}

}  // namespace springstab
