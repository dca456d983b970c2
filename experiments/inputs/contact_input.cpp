#include "experiments/inputs/contact_input.h"

#include <filesystem>
#include <map>
#include <numeric>

#include "solvers/contact/cuts.h"
#include "solvers/contact/surface_pairs.h"
#include "solvers/io/input_error.h"
#include "solvers/io/mesh_file.h"
#include "solvers/scene/mesh_repair.h"
#include "solvers/scene/quantities.h"

namespace springstab {
namespace {

constexpr double rounding_of_decimals = 1e-9;  // relative

// Whether every edge has a face on either side.
bool is_watertight(const std::vector<std::array<int, 3>>& triangles) {
  std::map<std::pair<int, int>, int> passed;  // how often from the first to the second
  for (const auto& t : triangles)
    for (int c = 0; c < 3; ++c) ++passed[{t[c], t[(c + 1) % 3]}];
  return std::all_of(passed.begin(), passed.end(), [&](const auto& edge) {
    const auto back = passed.find({edge.first.second, edge.first.first});
    return edge.second == 1 && back != passed.end() && back->second == 1;
  });
}

MeshObstacle mesh_obstacle(const MeshObstacleDescription& description, std::vector<std::string>& notes) {
  AnyMesh any = read_mesh(description.path);
  const Mesh* mesh = std::get_if<Mesh>(&any);
  if (!mesh) throw InputError(description.path, 0, "has tetrahedra, expected a surface as an obstacle");
  Mesh mended = repaired(*mesh).mesh;
  check(mended);
  std::vector<int> same(mended.vertices.size());
  std::iota(same.begin(), same.end(), 0);
  MeshObstacle obstacle{std::move(mended.vertices), triangles_of(mended, same), description.velocity};
  if (!is_watertight(obstacle.triangles))
    notes.push_back(description.path + ": is not watertight: it is met as a surface, and has no inside");
  return obstacle;
}

long line_of_surfaces(const ContactDescription& d) {
  return d.contact.self ? d.self_line : d.meshes[0].place.line;
}

// What is found at the start, and how to say it.
class Apart {
 public:
  Apart(const ContactDescription& description, const Contact& contact, const ClothSurface& surface,
        const Vector& x, const SurfaceNames& names)
      : description_(description), contact_(contact), surface_(surface), names_(names) {
    for (Eigen::Index i = 0; i < x.size(); i += 3) places_.push_back(x.segment<3>(i));
    free_ = static_cast<int>(places_.size());
    places_.insert(places_.end(), surface.pinned.begin(), surface.pinned.end());
    of_cloth_ = static_cast<int>(places_.size());
  }

  void expect_self() {
    const Location at{description_.source, description_.self_line};
    if (const auto cut = first_cut(surface_.triangles, surface_.triangles, places_))
      at.fail(face(cut->first) + " of the cloth cuts its " + face(cut->second) + " at the start, " +
              springstab::shown(cut->depth) + " m deep, expected none to");
    const auto near = first_near(SurfacePairs(make_surface(surface_.triangles), free_, distances()));
    if (near)
      at.fail("the cloth is " + springstab::shown(near->gap) + " m from itself at the start, at " +
              names_.particle(near->particles[0]) + " and " + names_.particle(near->particles[3]) +
              expected());
  }

  void expect_mesh(const MeshObstacle& mesh, const MeshObstacleDescription& written) {
    const Location at{description_.source, written.place.line};
    const std::string obstacle = "obstacle " + std::to_string(written.place.number) + " (" +
                                 std::filesystem::path(written.path).filename().string() + ")";
    places_.resize(of_cloth_);
    places_.insert(places_.end(), mesh.vertices.begin(), mesh.vertices.end());
    std::vector<std::array<int, 3>> triangles = mesh.triangles;
    for (auto& triangle : triangles)
      for (int& corner : triangle) corner += of_cloth_;
    if (const auto cut = first_cut(surface_.triangles, triangles, places_))
      at.fail(obstacle + " cuts " + face(cut->first) + " of the cloth at the start, " +
              springstab::shown(cut->depth) + " m deep, expected them apart");
    const auto near = first_near(
        SurfacePairs(make_surface(surface_.triangles), make_surface(triangles), free_, distances()));
    if (!near) return;
    const int mine = *std::min_element(near->particles.begin(), near->particles.end());
    at.fail(obstacle + " is " + springstab::shown(near->gap) + " m from the cloth at the start, at " +
            names_.particle(mine) + expected());
  }

 private:
  std::string face(int triangle) const { return "face " + std::to_string(names_.face[triangle]); }
  std::string expected() const {
    return ", expected at least the thickness of " + springstab::shown(contact_.thickness) + " m";
  }
  PairDistances distances() const { return {contact_.thickness, contact_.thickness}; }

  std::optional<SurfaceContact> first_near(SurfacePairs pairs) const {
    for (const SurfaceContact& c : pairs.proximities(places_, contact_.thickness))
      if (c.gap < contact_.thickness * (1 - rounding_of_decimals)) return c;
    return std::nullopt;
  }

  const ContactDescription& description_;
  const Contact& contact_;
  const ClothSurface& surface_;
  const SurfaceNames& names_;
  std::vector<Eigen::Vector3d> places_;  // of the cloth, then of a mesh
  int free_, of_cloth_;
};

}  // namespace

Contact contact_of(const ContactDescription& description, std::vector<std::string>& notes) {
  Contact contact = description.contact;
  for (const MeshObstacleDescription& mesh : description.meshes)
    contact.meshes.push_back(mesh_obstacle(mesh, notes));
  if (contact.has_surfaces() && !has_embree())
    throw InputError(description.source, line_of_surfaces(description), embree_is_missing);
  return contact;
}

void expect_faces(const ContactDescription& description, const ClothSurface& surface) {
  if (surface.triangles.empty())
    throw InputError(description.source, line_of_surfaces(description),
                     "the cloth has no faces, expected some for contact of surfaces");
}

void expect_surfaces_apart(const ContactDescription& description, const Contact& contact,
                           const ClothSurface& surface, const Vector& x, const SurfaceNames& names) {
  expect_faces(description, surface);
  Apart apart(description, contact, surface, x, names);
  if (contact.self) apart.expect_self();
  for (std::size_t m = 0; m < contact.meshes.size(); ++m)
    apart.expect_mesh(contact.meshes[m], description.meshes[m]);
}

}  // namespace springstab
