#include "solvers/contact/surface_touches.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

namespace springstab {
namespace {

constexpr double skin_of_touches = 1;     // how far surfaces are looked for, in thicknesses beyond one
constexpr double farthest = 1e12;         // [m]; what is beyond has diverged, and touches nothing
constexpr double parallel_edges = 1e-12;  // sin²θ up to which what is closest of two edges is not known

// Puts numbers in place of those there are, and says whether they differ.
bool replace(const double* by, std::size_t count, Eigen::Vector3d* places) {
  const std::size_t bytes = 3 * sizeof(double) * count;
  if (count == 0 || std::memcmp(by, places->data(), bytes) == 0) return false;
  std::memcpy(places->data(), by, bytes);
  return true;
}

// Ends of a run of equals, where `same` says what is equal.
template <class List, class Same, class Visit>
void for_each_run(const List& list, const Same& same, const Visit& visit) {
  for (std::size_t first = 0, last; first < list.size(); first = last) {
    last = first + 1;
    while (last < list.size() && same(list[first], list[last])) ++last;
    visit(first, last);
  }
}

}  // namespace

SurfaceTouches::SurfaceTouches(const Contact& contact, int free_count, const ClothSurface& surface)
    : thickness_(contact.thickness),
      free_count_(free_count),
      pinned_(surface.pinned.size()),
      elements_(std::vector<std::array<int, 4>>(), free_count) {
  if (!(thickness_ > 0))
    throw std::invalid_argument("the thickness is " + std::to_string(thickness_) +
                                " m, expected a positive one for surfaces");
  places_.assign(static_cast<std::size_t>(free_count), Eigen::Vector3d::Zero());
  places_.insert(places_.end(), surface.pinned.begin(), surface.pinned.end());
  std::vector<std::array<int, 3>> meshes;
  for (const MeshObstacle& mesh : contact.meshes) {
    if (!mesh.velocity.isZero(0))
      throw std::invalid_argument("an obstacle of a penalty moves, expected one at rest");
    for (auto triangle : mesh.triangles) {
      for (int& corner : triangle) corner += static_cast<int>(places_.size());
      meshes.push_back(triangle);
    }
    places_.insert(places_.end(), mesh.vertices.begin(), mesh.vertices.end());
  }
  const PairDistances distances{thickness_, skin_of_touches * thickness_};
  const Surface cloth = make_surface(surface.triangles);
  if (contact.self) pairs_.emplace_back(cloth, free_count, distances);
  if (!meshes.empty()) pairs_.emplace_back(cloth, make_surface(meshes), free_count, distances);
}

void SurfaceTouches::find(const ParticleField& x) {
  const auto free = static_cast<std::size_t>(free_count_);
  const bool moved = replace(x.free, free, places_.data());
  if (replace(x.pinned, pinned_, places_.data() + free) || moved || !has_found_) find_all();
}

void SurfaceTouches::find(const Vector& x) { find({x.data(), field().pinned, free_count_}); }

void SurfaceTouches::find_all() {
  has_found_ = false;  // until it is done
  touches_.clear();
  const bool diverged = !std::all_of(places_.begin(), places_.end(), [](const Eigen::Vector3d& place) {
    return (place.array().abs() <= farthest).all();
  });
  for (SurfacePairs& pairs : pairs_) {
    if (diverged) break;
    const std::span<const SurfaceContact> near = pairs.proximities(places_, thickness_);
    for_each_run(
        near,
        [](const SurfaceContact& a, const SurfaceContact& b) {
          return a.kind == b.kind && a.particles[0] == b.particles[0];
        },
        [&](std::size_t first, std::size_t last) {
          const FaceContacts run = near.subspan(first, last - first);
          if (near[first].kind == PairKind::vertex_face) return add_vertex(run);
          for (const SurfaceContact& edges : run) add_edge_and_edge(edges);
        });
  }
  elements_ = Elements<4>(touches_, free_count_);
  has_found_ = true;
}

// All of the faces near a vertex.
void SurfaceTouches::add_vertex(FaceContacts faces) {
  const int vertex = faces[0].particles[0];
  features_.clear();
  for (const SurfaceContact& face : faces) add_closest_of_face(face);
  if (faces.size() > 1) {
    add_edges(vertex, faces);
    add_corners(vertex, faces);
  }
  std::stable_sort(features_.begin(), features_.end(),
                   [](const Feature& a, const Feature& b) { return a.key < b.key; });
  for_each_run(
      features_, [](const Feature& a, const Feature& b) { return a.key == b.key; },
      [&](std::size_t first, std::size_t last) {
        int count = 0;
        for (std::size_t i = first; i < last; ++i) count += features_[i].count;
        const auto& [key, c, size, its_own] = features_[first];
        const std::array kinds{TouchKind::vertex_vertex, TouchKind::vertex_edge, TouchKind::vertex_face};
        if (count != 0) touches_.push_back({{vertex, c[0], c[1], c[2]}, kinds[size - 1], count});
      });
}

void SurfaceTouches::add_feature(const std::array<int, 3>& corners, int size, int count) {
  Feature feature{corners, corners, size, count};
  for (int k = size; k < 3; ++k) feature.key[k] = -1;
  for (const int k : {0, 1, 0})
    if (feature.key[k] > feature.key[k + 1]) std::swap(feature.key[k], feature.key[k + 1]);
  features_.push_back(feature);
}

void SurfaceTouches::add_closest_of_face(const SurfaceContact& face) {
  std::array<int, 3> corners{};
  int size = 0, others = 0;
  for (int k = 0; k < 3; ++k)
    corners[face.weights[1 + k] != 0 ? size++ : 2 - others++] = face.particles[1 + k];
  add_feature(corners, size, 1);
}

// An edge of n of the faces counts 1 - n.
void SurfaceTouches::add_edges(int vertex, FaceContacts faces) {
  edges_.clear();
  ends_.clear();
  for (const SurfaceContact& face : faces)
    for (int k = 0; k < 3; ++k) {
      const int p = face.particles[1 + k], q = face.particles[1 + (k + 1) % 3];
      edges_.push_back({std::min(p, q), std::max(p, q), face.particles[1 + (k + 2) % 3]});
    }
  std::sort(edges_.begin(), edges_.end());
  for_each_run(
      edges_, [](const auto& a, const auto& b) { return a[0] == b[0] && a[1] == b[1]; },
      [&](std::size_t first, std::size_t last) {
        ends_.insert(ends_.end(), {edges_[first][0], edges_[first][1]});
        if (last - first > 1) add_closest_of_edge(vertex, edges_[first], 1 - static_cast<int>(last - first));
      });
  std::sort(ends_.begin(), ends_.end());
}

// The vertex at which n faces and e edges meet counts 1 - n - Σ (1 - n of an edge) = 1 + n - e.
void SurfaceTouches::add_corners(int vertex, FaceContacts faces) {
  corners_.clear();
  for (const SurfaceContact& face : faces)
    for (int k = 0; k < 3; ++k)
      corners_.push_back(
          {face.particles[1 + k], face.particles[1 + (k + 1) % 3], face.particles[1 + (k + 2) % 3]});
  std::sort(corners_.begin(), corners_.end());
  for_each_run(
      corners_, [](const auto& a, const auto& b) { return a[0] == b[0]; },
      [&](std::size_t first, std::size_t last) {
        const int corner = corners_[first][0];
        const auto edges = std::equal_range(ends_.begin(), ends_.end(), corner);
        const auto count =
            static_cast<int>(1 + (last - first)) - static_cast<int>(edges.second - edges.first);
        if (count != 0 && (places_[vertex] - places_[corner]).norm() < thickness_)
          add_feature(corners_[first], 1, count);
      });
}

void SurfaceTouches::add_closest_of_edge(int vertex, const std::array<int, 3>& corners, int count) {
  const auto& [p, q, other] = corners;
  const Eigen::Vector3d along = places_[q] - places_[p], d = places_[vertex] - places_[p];
  const double square = along.squaredNorm();
  const double s = square > 0 ? std::clamp(along.dot(d) / square, 0., 1.) : 0;
  if (!((d - s * along).norm() < thickness_)) return;
  if (s == 0) return add_feature({p, q, other}, 1, count);
  if (s == 1) return add_feature({q, p, other}, 1, count);
  add_feature({p, q, other}, 2, count);
}

void SurfaceTouches::add_edge_and_edge(const SurfaceContact& edges) {
  const auto& w = edges.weights;
  if (w[0] == 0 || w[1] == 0 || w[2] == 0 || w[3] == 0) return;
  const Touch touch{edges.particles, TouchKind::edge_edge, 1};
  const PairDirections p = pair_directions(PairKind::edge_edge, places(touch));
  if (p.u.cross(p.w).squaredNorm() > parallel_edges * p.u.squaredNorm() * p.w.squaredNorm())
    touches_.push_back(touch);
}

FourPlaces SurfaceTouches::places(const Touch& touch) const {
  const auto& p = touch.particles;
  return {places_[p[0]], places_[p[1]], places_[p[2]], places_[p[3]]};
}

ParticleField SurfaceTouches::field() const {
  return {places_.data()->data(), places_.data()->data() + 3 * static_cast<long>(free_count_), free_count_};
}

double SurfaceTouches::most_contacts() const {
  std::vector<double> load(static_cast<std::size_t>(free_count_));
  for (const Touch& touch : touches_) {
    if (touch.count < 0) continue;
    const TouchPlaces at = touch_places(touch.kind, places(touch));
    for (int k = 0; k < 4; ++k)
      if (touch.particles[k] < free_count_)
        load[touch.particles[k]] += touch.count * at.share * std::abs(at.weights[k]);
  }
  return *std::max_element(load.begin(), load.end());
}

}  // namespace springstab
