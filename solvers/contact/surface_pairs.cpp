#include "solvers/contact/surface_pairs.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "solvers/contact/closest_places.h"
#include "solvers/contact/pair_list.h"

namespace springstab {

/// Vertices and edges for which a triangle stands, so that each is looked for once: numbers of `Parts`'
/// lists.
struct OwnFeatures {
  std::array<int, 3> vertices, edges;
  int vertex_count = 0, edge_count = 0;
};

namespace {

using PlaceList = std::span<const Eigen::Vector3d>;

constexpr double inside_for_certain = 1 - 1e-6;  // of a radius: rounding is far less
constexpr double beyond_rounding = 1 + 1e-5;     // of a distance along a normal in single precision
constexpr double least_apart = 1e-3;             // of the reach, by which a plane must be clear

void append_own_features(const Surface& surface, int vertex_offset, int edge_offset,
                         std::vector<OwnFeatures>& list) {
  std::vector<bool> vertex_has(surface.vertices.size()), edge_has(surface.edges.size());
  const auto take = [](const auto& sorted, const auto& wanted, std::vector<bool>& has) {
    const auto at = std::lower_bound(sorted.begin(), sorted.end(), wanted) - sorted.begin();
    const bool is_free = !has[at];
    has[at] = true;
    return is_free ? static_cast<int>(at) : -1;
  };
  for (const std::array<int, 3>& t : surface.triangles) {
    OwnFeatures own;
    for (int k = 0; k < 3; ++k) {
      const std::array<int, 2> edge{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])};
      const int v = take(surface.vertices, t[k], vertex_has), e = take(surface.edges, edge, edge_has);
      if (v >= 0) own.vertices[own.vertex_count++] = vertex_offset + v;
      if (e >= 0) own.edges[own.edge_count++] = edge_offset + e;
    }
    list.push_back(own);
  }
}

Eigen::Array4d padded(const Eigen::Vector3d& x) { return {x[0], x[1], x[2], 0}; }

template <std::size_t n>
Box box_around(const std::vector<Box>& of, const std::array<int, n>& particles) {
  Box box = of[particles[0]];
  for (std::size_t k = 1; k < n; ++k) {
    box.low = box.low.min(of[particles[k]].low);
    box.high = box.high.max(of[particles[k]].high);
  }
  return box;
}

FourPlaces places_of(const std::array<int, 4>& p, PlaceList x) {
  return {x[p[0]], x[p[1]], x[p[2]], x[p[3]]};
}

// The distance of the two parts' projections on n.
double gap_along(const Eigen::Vector3d& n, PairKind kind, const std::array<int, 4>& p, PlaceList x) {
  const Eigen::Vector3d& origin = x[p[0]];
  const double b = n.dot(x[p[1]] - origin), c = n.dot(x[p[2]] - origin), d = n.dot(x[p[3]] - origin);
  return kind == PairKind::vertex_face ? -std::max({b, c, d}) : std::min(0., b) - std::max(c, d);
}

}  // namespace

struct SurfacePairs::Parts {
  std::vector<std::array<int, 3>> faces;
  std::vector<std::array<int, 2>> edges;
  std::vector<int> vertices;
  std::vector<OwnFeatures> own;  // of each face
  int first_faces, free_count;
  PairDistances distances;
  std::vector<Eigen::Vector3d> center, way;  // of a particle: where it was, and its way in the step then
  std::vector<double> radius;                // around the center: as long as it is there, what is kept is all
  std::vector<Eigen::Vector3d> face_normal;  // at the centers; zero without one
  std::vector<double> face_radius;
  std::vector<Box> of_particle, of_vertex, of_edge, of_face;
  BoxPairs boxes;
  PairList vertex_face, edge_edge;  // what is kept
  std::vector<SurfaceContact> found;
  PairCounts counts;

  Parts(const Surface& first, const Surface& second, int free, PairDistances at)
      : faces(first.triangles),
        edges(first.edges),
        vertices(first.vertices),
        first_faces(static_cast<int>(first.triangles.size())),
        free_count(free),
        distances(at),
        boxes(first_faces, static_cast<int>(second.triangles.size())) {
    if (!(at.reach > 0 && at.skin > 0))
      throw std::invalid_argument("surfaces are paired with a reach of " + std::to_string(at.reach) +
                                  " m and a skin of " + std::to_string(at.skin) +
                                  " m, expected positive ones");
    append_own_features(first, 0, 0, own);
    append_own_features(second, static_cast<int>(vertices.size()), static_cast<int>(edges.size()), own);
    faces.insert(faces.end(), second.triangles.begin(), second.triangles.end());
    edges.insert(edges.end(), second.edges.begin(), second.edges.end());
    vertices.insert(vertices.end(), second.vertices.begin(), second.vertices.end());
    const std::size_t particles =
        static_cast<std::size_t>(*std::max_element(vertices.begin(), vertices.end())) + 1;
    center.assign(particles, Eigen::Vector3d::Constant(NAN));
    way.assign(particles, Eigen::Vector3d::Zero());
    radius.resize(particles);
    of_particle.resize(particles);
    of_vertex.resize(vertices.size());
    of_edge.resize(edges.size());
    of_face.resize(faces.size());
    face_normal.resize(faces.size());
    face_radius.resize(faces.size());
  }

  std::array<int, 4> particles_of(PairKind kind, int i, int j) const {
    if (kind == PairKind::vertex_face) return {vertices[i], faces[j][0], faces[j][1], faces[j][2]};
    return {edges[i][0], edges[i][1], edges[j][0], edges[j][1]};
  }

  bool is_wanted(PairKind kind, const std::array<int, 4>& p) const {
    if (*std::min_element(p.begin(), p.end()) >= free_count) return false;
    if (kind == PairKind::vertex_face) return p[0] != p[1] && p[0] != p[2] && p[0] != p[3];
    return p[0] != p[2] && p[0] != p[3] && p[1] != p[2] && p[1] != p[3];
  }

  void expect_places(PlaceList x) const {
    if (x.size() < center.size())
      throw std::invalid_argument("there are places of " + std::to_string(x.size()) +
                                  " particles, expected " + std::to_string(center.size()));
  }

  // Boxes of all parts from those of their particles.
  void combine_boxes() {
    for (std::size_t i = 0; i < vertices.size(); ++i) of_vertex[i] = of_particle[vertices[i]];
    for (std::size_t i = 0; i < edges.size(); ++i) of_edge[i] = box_around(of_particle, edges[i]);
    for (std::size_t i = 0; i < faces.size(); ++i) of_face[i] = box_around(of_particle, faces[i]);
  }

  bool all_inside(PlaceList x) const {
    return std::all_of(vertices.begin(), vertices.end(), [&](int i) {
      return (x[i] - center[i]).squaredNorm() <= inside_for_certain * radius[i] * radius[i];
    });
  }

  // Two parts that come within reach are at most that and their largest radii apart at the centers.
  void keep_if_near(PairKind kind, int i, int j) {
    const std::vector<Box>&first = kind == PairKind::vertex_face ? of_vertex : of_edge,
          &second = kind == PairKind::vertex_face ? of_face : of_edge;
    if (!first[i].meets(second[j])) return;
    const std::array<int, 4> p = particles_of(kind, i, j);
    if (!is_wanted(kind, p)) return;
    const int split = kind == PairKind::vertex_face ? 1 : 2;
    double apart = distances.reach;
    apart += radius[*std::max_element(p.begin(), p.begin() + split,
                                      [&](int a, int b) { return radius[a] < radius[b]; })];
    apart += radius[*std::max_element(p.begin() + split, p.end(),
                                      [&](int a, int b) { return radius[a] < radius[b]; })];
    const Eigen::Vector3d difference = closest_places(kind, places_of(p, center)).difference;
    if (difference.squaredNorm() > apart * apart) return;
    (kind == PairKind::vertex_face ? vertex_face : edge_edge).add(i, j, difference.stableNormalized());
  }

  // Whether a face's plane has the other face further away than what could come within reach.
  bool plane_parts(int f, int g) const {
    const std::array<int, 3>&a = faces[f], &b = faces[g];
    const Eigen::Vector3d& n = face_normal[f];
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
      const double height = n.dot(center[b[k]] - center[a[0]]);
      low = std::min(low, height);
      high = std::max(high, height);
    }
    return std::max(low, -high) > distances.reach + face_radius[f] + face_radius[g];
  }

  void keep_of_faces(int f, int g) {
    if (plane_parts(f, g) || plane_parts(g, f)) return;
    for (int k = 0; k < own[f].vertex_count; ++k) keep_if_near(PairKind::vertex_face, own[f].vertices[k], g);
    for (int k = 0; k < own[g].vertex_count; ++k) keep_if_near(PairKind::vertex_face, own[g].vertices[k], f);
    for (int k = 0; k < own[f].edge_count; ++k)
      for (int l = 0; l < own[g].edge_count; ++l)
        keep_if_near(PairKind::edge_edge, std::min(own[f].edges[k], own[g].edges[l]),
                     std::max(own[f].edges[k], own[g].edges[l]));
  }

  // Finds what is to be kept, unless all still are where they may be.
  void cover(PlaceList x0, PlaceList x1) {
    expect_places(x0);
    expect_places(x1);
    if (all_inside(x0) && all_inside(x1)) return;
    ++counts.rebuilds;
    for (const int i : vertices) {
      if (!x0[i].allFinite() || !x1[i].allFinite())
        throw std::invalid_argument("the place of particle " + std::to_string(i) +
                                    " is not finite, expected it so");
      if (x0.data() != x1.data()) way[i] = x1[i] - x0[i];
      center[i] = x0[i] + way[i] / 2;
      radius[i] = distances.skin / 2 + way[i].norm() / 2;
      const Eigen::Array4d reach = padded(Eigen::Vector3d::Constant(radius[i] + distances.reach / 2));
      of_particle[i] = {padded(center[i]) - reach, padded(center[i]) + reach};
    }
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const auto& f = faces[i];
      face_radius[i] = std::max({radius[f[0]], radius[f[1]], radius[f[2]]});
      face_normal[i] = inside_for_certain *
                       (center[f[1]] - center[f[0]]).cross(center[f[2]] - center[f[0]]).stableNormalized();
    }
    combine_boxes();
    vertex_face.clear();
    edge_edge.clear();
    boxes.for_each(of_face, [&](int f, int g) { keep_of_faces(f, g); });
    vertex_face.sort(static_cast<int>(std::max(vertices.size(), faces.size())));
    edge_edge.sort(static_cast<int>(edges.size()));
  }

  // Calls look(kind, particles, kept) for the kept pairs, but those that are further apart than `distance` in
  // the direction in which they last were, before and after the step and so all the time.
  template <class Look>
  void for_each_kept(PlaceList x0, PlaceList x1, double distance, const Look& look) {
    counts.tested += static_cast<long>(vertex_face.size() + edge_edge.size());
    const double apart = beyond_rounding * distance + least_apart * distances.reach;
    for (const PairKind kind : {PairKind::vertex_face, PairKind::edge_edge})
      for (KeptPair& kept : kind == PairKind::vertex_face ? vertex_face : edge_edge) {
        const std::array<int, 4> p = particles_of(kind, kept.parts[0], kept.parts[1]);
        const Eigen::Vector3d n = kept.normal.cast<double>();
        if (gap_along(n, kind, p, x0) > apart &&
            (x0.data() == x1.data() || gap_along(n, kind, p, x1) > apart))
          continue;
        look(kind, p, kept);
      }
  }
};

SurfacePairs::SurfacePairs(Surface surface, int free_count, PairDistances distances)
    : SurfacePairs(std::move(surface), {}, free_count, distances) {}

SurfacePairs::SurfacePairs(Surface first, Surface second, int free_count, PairDistances distances) {
  if (first.triangles.empty()) throw std::invalid_argument("a surface has no triangles, expected some");
  parts_ = std::make_unique<Parts>(first, second, free_count, distances);
}

SurfacePairs::~SurfacePairs() = default;
SurfacePairs::SurfacePairs(SurfacePairs&&) noexcept = default;
SurfacePairs& SurfacePairs::operator=(SurfacePairs&&) noexcept = default;

const PairCounts& SurfacePairs::counts() const { return parts_->counts; }

std::span<const SurfaceContact> SurfacePairs::proximities(PlaceList x, double distance) {
  Parts& p = *parts_;
  if (!(distance >= 0 && distance <= p.distances.reach))
    throw std::invalid_argument("proximities at " + std::to_string(distance) +
                                " m, expected at most the reach, " + std::to_string(p.distances.reach) +
                                " m");
  p.found.clear();
  p.cover(x, x);
  p.for_each_kept(x, x, distance, [&](PairKind kind, const std::array<int, 4>& particles, KeptPair& kept) {
    const FourPlaces at = places_of(particles, x);
    const ClosestPlaces closest = closest_places(kind, at);
    const Eigen::Vector3d n = direction_between(kind, at, closest);
    kept.normal = n.cast<float>();
    if (closest.difference.squaredNorm() > distance * distance) return;
    const Eigen::Vector3d normal = n.isZero(0) ? normal_of_touch(kind, at) : n;
    p.found.push_back({particles, closest.weights, normal, normal.dot(closest.difference), 0});
  });
  return p.found;
}

std::span<const SurfaceContact> SurfacePairs::collisions(PlaceList x0, PlaceList x1) {
  Parts& p = *parts_;
  p.found.clear();
  p.cover(x0, x1);
  p.for_each_kept(x0, x1, 0, [&](PairKind kind, const std::array<int, 4>& particles, KeptPair&) {
    const auto impact = first_impact(kind, places_of(particles, x0), places_of(particles, x1));
    if (!impact) return;
    p.found.push_back({particles, impact->places.weights, impact->normal,
                       impact->normal.dot(impact->places.difference), impact->time});
  });
  return p.found;
}

}  // namespace springstab
