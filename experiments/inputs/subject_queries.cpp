// What a subject that is built is asked: its particles by the numbers of its file, its elements, and the
// matrices and contact that no pose exceeds.
#include <algorithm>
#include <numeric>

#include "experiments/inputs/grid.h"
#include "experiments/inputs/subject.h"
#include "solvers/contact/penalty.h"
#include "solvers/contact/surface_penalty.h"
#include "solvers/scene/every_pose.h"

namespace springstab {

std::unique_ptr<ContactFilter> Subject::contact_filter() const {
  if (!contact_) return nullptr;
  if (touches_) return std::make_unique<SurfacePenaltyFilter>(*contact_, scene()->free_masses(), touches_);
  return make_contact_filter(*contact_, scene()->free_masses(),
                             contact_->has_surfaces() ? contact_surface().first : ClothSurface());
}

std::pair<ClothSurface, SurfaceNames> Subject::contact_surface() const { return contact_surface(*scene()); }

std::pair<ClothSurface, SurfaceNames> Subject::contact_surface(const Scene& scene) const {
  const int particles = scene.particles(), free_count = scene.free_particles();
  std::vector<int> node(static_cast<std::size_t>(particles)), particle(node.size());
  for (int i = 0, free = 0, pinned = free_count; i < particles; ++i)
    particle[node[i] = std::ranges::binary_search(pinned_, i) ? pinned++ : free++] = i;
  ClothSurface surface;
  SurfaceNames names;
  const std::vector<Eigen::Vector3d> places = scene.positions(scene.rest_state().x);
  for (const int i : pinned_) surface.pinned.push_back(places[i]);
  const Faces& all = faces();
  for (int f = 0; f < std::ssize(all); ++f)
    for (std::size_t c = 2; c < all[f].size(); ++c) {
      std::array<int, 3> triangle{all[f][0], all[f][c - 1], all[f][c]};
      for (int& corner : triangle) corner = node[mesh_file_ ? mesh_file_->repair.vertex[corner] : corner];
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
      surface.triangles.push_back(triangle);
      names.face.push_back(f);
    }
  names.particle = [this, particle](int i) {
    return (mesh_file_ ? "vertex " : "particle ") + std::to_string(number_in_file(particle[i]));
  };
  return {surface, names};
}

std::vector<Eigen::Vector3d> Subject::vertices(const Vector& x) const {
  std::vector<Eigen::Vector3d> particles = scene()->positions(x);
  return mesh_file_ ? file_vertices(*mesh_file_, particles, stretch_) : particles;
}

std::vector<long> Subject::vertex_numbers() const {
  std::vector<long> first(static_cast<std::size_t>(scene()->particles()));
  std::iota(first.begin(), first.end(), 0);
  if (!mesh_file_) return first;
  const std::vector<int>& particle = mesh_file_->repair.vertex;
  for (long v = std::ssize(particle) - 1; v >= 0; --v)
    if (particle[static_cast<std::size_t>(v)] >= 0)
      first[static_cast<std::size_t>(particle[static_cast<std::size_t>(v)])] = v;
  return first;
}

std::vector<long> Subject::particle_numbers() const {
  if (!scene()) return kept_;
  std::vector<long> numbers;
  const std::vector<long> all = vertex_numbers();
  for (int i = 0; i < std::ssize(all); ++i)
    if (!std::ranges::binary_search(pinned_, i)) numbers.push_back(all[static_cast<std::size_t>(i)]);
  return numbers;
}

std::optional<ElementsOf> Subject::elements(const Vector& x) const {
  if (!scene()) return std::nullopt;
  ElementsOf elements{
      [this, at = scene()->positions(x)](const ElementVisitor& visit) { visit_elements_(at, visit); },
      std::vector<int>(static_cast<std::size_t>(scene()->particles()))};
  int free = 0;
  for (int i = 0; i < scene()->particles(); ++i)
    elements.place[static_cast<std::size_t>(i)] = std::ranges::binary_search(pinned_, i) ? -1 : free++;
  return elements;
}

std::function<StructuralMatrices()> Subject::every_pose() const {
  if (!net_ || touches_) return {};
  const RayleighDamping rayleigh{damping().d0, damping().alpha};
  return [net = net_, pinned = pinned_, rayleigh, contact = contact_bound()] {
    StructuralMatrices all = springstab::every_pose(*net, pinned, rayleigh);
    return contact ? in_any_contact(std::move(all), *contact, rayleigh.alpha) : all;
  };
}

const Faces& Subject::faces() const {
  if (faces_.empty() && grid_) faces_ = grid_faces(*grid_);
  return faces_;
}

long Subject::contacts(const Vector& x) const {
  touches_->find(x);
  return whole_contacts(touches_->most_contacts());
}

std::optional<ContactBound> Subject::contact_bound(long contacts) const {
  const auto* penalty = contact_ ? std::get_if<Penalty>(&contact_->model) : nullptr;
  if (!penalty) return std::nullopt;
  auto most = static_cast<double>(contact_->obstacles.size());
  if (touches_) most += (contact_->self ? 2. : 1.) * static_cast<double>(contacts);
  return ContactBound{most * penalty->stiffness, most * penalty->damping};
}

}  // namespace springstab
