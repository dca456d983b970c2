#include "solvers/scene/triangle_cloth.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "solvers/io/input_error.h"
#include "solvers/scene/bending.h"
#include "solvers/scene/condition_damping.h"
#include "solvers/scene/quantities.h"

namespace springstab {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double shortest_side = 1e-60, longest_side = 1e60;  // [m]

void check_triangle(const Mesh& mesh, const FaceTriangle& t) {
  const auto x = positions(mesh, t);
  std::string name = "triangle ";
  for (int c = 0; c < 3; ++c) name += (c ? "-" : "") + std::to_string(mesh.face_vertices[t.corners[c]] + 1);
  for (int c = 0; c < 3; ++c)
    if (const double side = (x[(c + 1) % 3] - x[c]).norm(); !(side >= shortest_side && side <= longest_side))
      fail_at_face(mesh, t.face,
                   name + " has a side of " + shown(side) + " m, expected a length between 1e-60 and 1e60 m");
  if (!has_area(x[1] - x[0], x[2] - x[0]))
    fail_at_face(mesh, t.face, name + " has no area, expected corners that are not on a line");
}

// --- hinges ---

/// The edge low < high of a triangle and its corner opposite to it.
struct TriangleSide {
  int low, high, opposite;
};

double rest_angle(const std::vector<Vector3d>& rest, const std::array<int, 4>& particles, bool flat) {
  CornerVectors<4> x;
  for (int c = 0; c < 4; ++c) {
    const Vector3d& p = rest[particles[c]];
    x.set(c, 0, {p.x(), p.y(), p.z()});
  }
  const HingeShape shape = hinge_shape(x, 0);
  return std::atan2(flat ? 0.0 : shape.sin, shape.cos);
}

std::vector<Hinge> find_hinges(const std::vector<RestTriangle>& triangles, const std::vector<Vector3d>& rest,
                               bool flat, const std::string& source) {
  std::vector<TriangleSide> sides;
  sides.reserve(3 * triangles.size());
  for (const auto& [p, uv] : triangles)
    for (int c = 0; c < 3; ++c) {
      const auto [low, high] = std::minmax(p[(c + 1) % 3], p[(c + 2) % 3]);
      sides.push_back({low, high, p[c]});
    }
  std::stable_sort(sides.begin(), sides.end(), [](const TriangleSide& s, const TriangleSide& t) {
    return std::tie(s.low, s.high) < std::tie(t.low, t.high);
  });
  std::vector<Hinge> hinges;
  for (auto first = sides.begin(), last = first; first != sides.end(); first = last)
    for (; last != sides.end() && last->low == first->low && last->high == first->high; ++last) {
      if (last - first == most_faces_at_edge)
        throw InputError(source, 0,
                         "more than " + std::to_string(most_faces_at_edge) + " triangles at the edge " +
                             std::to_string(first->low + 1) + "-" + std::to_string(first->high + 1) +
                             ", expected at most that many");
      for (auto other = first; other != last; ++other) {
        if (other->opposite == last->opposite) continue;
        const std::array<int, 4> particles{first->low, first->high, other->opposite, last->opposite};
        hinges.push_back({particles, rest_angle(rest, particles, flat)});
      }
    }
  return hinges;
}

/// Keeps of the elements what the material needs.
void finish(TriangleCloth& cloth, std::vector<RestTriangle> triangles, bool flat, const std::string& source) {
  if (cloth.material.stiffness.bending > 0) cloth.hinges = find_hinges(triangles, cloth.rest, flat, source);
  if (cloth.material.stiffness.any_in_plane()) cloth.triangles = std::move(triangles);
}

template <class Element>
std::vector<Element> select(const std::vector<Element>& elements, const std::vector<int>& number,
                            int free_count) {
  std::vector<Element> selected;
  for (Element element : elements) {
    for (int& p : element.particles) p = number[p];
    if (*std::ranges::min_element(element.particles) < free_count) selected.push_back(element);
  }
  return selected;
}

}  // namespace

TriangleCloth make_cloth(const Grid& grid, const ClothMaterial& material) {
  check(grid, "grid");
  check(material, "material");
  if (grid.rows < 2 || grid.columns < 2)
    throw InputError("grid", 0,
                     "the grid is " + std::to_string(grid.rows) + " x " + std::to_string(grid.columns) +
                         ", expected at least 2 x 2 for a cloth of triangles");
  if (!(grid.spacing >= shortest_side && grid.spacing <= longest_side))
    throw InputError(
        "grid", 0,
        "the spacing is " + shown(grid.spacing) + " m, expected a length between 1e-60 and 1e60 m");
  const double mass = material.particle_mass.value_or(material.area_density * grid.spacing * grid.spacing);
  if (!positive(mass))
    throw InputError("grid", 0,
                     "each particle weighs " + shown(mass) + " kg, expected a positive finite mass");

  TriangleCloth cloth;
  cloth.material = material;
  cloth.mass.assign(static_cast<std::size_t>(grid.particles()), mass);
  cloth.rest.reserve(cloth.mass.size());
  for (int p = 0; p < grid.particles(); ++p) cloth.rest.push_back(grid.place(p));
  const auto triangle = [&](int a, int b, int c) {
    const auto uv = [&](int p) { return Vector2d(cloth.rest[p].x(), cloth.rest[p].z()); };
    return RestTriangle{{a, b, c}, {uv(a), uv(b), uv(c)}};
  };
  std::vector<RestTriangle> triangles;
  for (int i = 0; i + 1 < grid.rows; ++i)
    for (int j = 0; j + 1 < grid.columns; ++j) {
      const int p = i * grid.columns + j, q = p + grid.columns;
      const bool other = grid.diagonals == Diagonals::alternating && (i + j) % 2 != 0;
      triangles.push_back(triangle(p, p + 1, other ? q : q + 1));
      triangles.push_back(triangle(other ? p + 1 : p, q + 1, q));
    }
  finish(cloth, std::move(triangles), true, "grid");
  return cloth;
}

TriangleCloth make_cloth(const Mesh& mesh, const ClothMaterial& material) {
  check(material, "material");
  check(mesh);
  const std::vector<FaceTriangle> parts = fans(mesh);
  for (const FaceTriangle& t : parts) check_triangle(mesh, t);
  const RestCoordinates rest = rest_coordinates(mesh, parts, material.texture_unit);

  TriangleCloth cloth;
  cloth.material = material;
  cloth.rest = mesh.vertices;
  cloth.rest_shape = rest.shape;
  cloth.texture_map = rest.map;
  cloth.mass.assign(cloth.rest.size(), material.particle_mass.value_or(0));
  std::vector<RestTriangle> triangles;
  for (std::size_t t = 0; t < parts.size(); ++t) {
    RestTriangle triangle{{}, rest.uv[t]};
    for (int c = 0; c < 3; ++c) {
      triangle.particles[c] = mesh.face_vertices[parts[t].corners[c]];
      if (!material.particle_mass)
        cloth.mass[triangle.particles[c]] += material.area_density * area(rest.uv[t]) / 3;
    }
    triangles.push_back(triangle);
  }
  for (int v = 0; v < static_cast<int>(cloth.mass.size()); ++v)
    if (!positive(cloth.mass[v]))
      fail_at_vertex(mesh, v,
                     "has a mass of " + shown(cloth.mass[v]) +
                         " kg from the area of its faces, expected a positive finite one");
  finish(cloth, std::move(triangles), rest.shape == RestShape::plane, mesh.source);
  return cloth;
}

void check(const ClothMaterial& material, const std::string& source, long line) {
  const auto require = [&](bool good, const std::string& name, double value, const std::string& expected) {
    if (!good) throw InputError(source, line, name + " is " + shown(value) + ", expected " + expected);
  };
  require(positive(material.area_density), "area density", material.area_density,
          "a positive number of kg/m²");
  if (const auto& mass = material.particle_mass)
    require(positive(*mass), "particle mass", *mass, "a positive number of kg");
  if (const auto& unit = material.texture_unit)
    require(positive(*unit), "texture unit", *unit, "a positive number of m");
  for (const double rest : {material.rest_stretch.u, material.rest_stretch.v})
    require(positive(rest), "rest stretch", rest, "a positive number");
  const std::string per = material.scaling == AreaScaling::continuum ? "/m" : "/m³";
  const struct {
    double PerCondition::*of;
    std::string name, stiffness_unit, damping_unit;
  } conditions[] = {{&PerCondition::stretch_u, "stretch u", "N" + per, "N·s" + per},
                    {&PerCondition::stretch_v, "stretch v", "N" + per, "N·s" + per},
                    {&PerCondition::shear, "shear", "N" + per, "N·s" + per},
                    {&PerCondition::bending, "bending", "N·m", "N·m·s"}};
  for (const auto& c : conditions) {
    const double k = material.stiffness.*c.of, d = material.damping.*c.of;
    require(k == 0 || positive(k), c.name + " stiffness", k,
            "zero or a positive number of " + c.stiffness_unit);
    require(d == 0 || positive(d), c.name + " damping", d, "zero or a positive number of " + c.damping_unit);
    require(d == 0 || k > 0, c.name + " damping", d,
            "zero, since without stiffness there is no such condition");
  }
}

SceneTerms make_terms(const TriangleCloth& cloth, const std::vector<int>& number, int free_count) {
  SceneTerms terms;
  const ClothMaterial& material = cloth.material;
  if (const auto triangles = select(cloth.triangles, number, free_count); !triangles.empty()) {
    const auto shared = std::make_shared<TriangleConditions>(triangles, material.scaling, free_count);
    if (material.stiffness.any_in_plane())
      terms.elastic.push_back(
          std::make_unique<StretchShear>(shared, material.stiffness.in_plane(), material.rest_stretch));
    if (material.damping.any_in_plane())
      terms.damping.push_back(std::make_unique<StretchShearDamping>(shared, material.damping.in_plane()));
  }
  if (const auto hinges = select(cloth.hinges, number, free_count); !hinges.empty()) {
    const auto shared = std::make_shared<HingeAngles>(hinges, free_count);
    if (material.stiffness.bending > 0)
      terms.elastic.push_back(std::make_unique<Bending>(shared, material.stiffness.bending));
    if (material.damping.bending > 0)
      terms.damping.push_back(std::make_unique<BendingDamping>(shared, material.damping.bending));
  }
  return terms;
}

}  // namespace springstab
