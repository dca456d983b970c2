#include "experiments/inputs/mesh_input.h"

namespace springstab {

std::vector<Eigen::Vector3d> file_vertices(const MeshFile& file,
                                           const std::vector<Eigen::Vector3d>& particles,
                                           const Eigen::Vector3d& stretch) {
  std::vector<Eigen::Vector3d> all;
  for (std::size_t v = 0; v < file.vertices.size(); ++v) {
    const int particle = file.repair.vertex[v];
    all.push_back(particle < 0 ? stretch.cwiseProduct(file.vertices[v]) : particles[particle]);
  }
  return all;
}

SurfaceInput surface_input(Mesh original) {
  Faces faces;
  for (int f = 0; f < original.faces(); ++f)
    faces.emplace_back(original.face(f).begin(), original.face(f).end());
  RepairedMesh mended = repaired(original);
  return {std::move(mended.mesh),
          {std::move(original.source), false, std::move(original.vertices), std::move(mended.repair),
           std::move(original.notes), std::move(original.attributes)},
          std::move(faces)};
}

SolidInput solid_input(TetMesh original) {
  auto [mesh, repair] = repaired(original);
  std::vector<int> of_file(mesh.vertices.size());  // the first vertex that each one was
  for (std::size_t v = repair.vertex.size(); v-- > 0;)
    if (repair.vertex[v] >= 0) of_file[repair.vertex[v]] = static_cast<int>(v);
  Faces faces;
  for (std::vector<int> face : boundary(mesh)) {
    for (int& v : face) v = of_file[v];
    faces.push_back(std::move(face));
  }
  return {std::move(mesh),
          {std::move(original.source), true, std::move(original.vertices), std::move(repair),
           std::move(original.notes)},
          std::move(faces)};
}

}  // namespace springstab
