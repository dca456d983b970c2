#include "solvers/io/gmsh_elements.h"

#include <array>

namespace springstab {
namespace {

struct GmshType {
  int type, nodes;
  GmshShape shape;
};

/// Points and lines, of any order; the types of first order; and curved surfaces, which have nodes within
/// their edges. Null for any other.
const GmshType* gmsh_type(long long type) {
  using enum GmshShape;
  static constexpr GmshType types[] = {
      {1, 2, skipped},          {8, 3, skipped},          {15, 1, skipped},         {26, 4, skipped},
      {27, 5, skipped},         {28, 6, skipped},         {2, 3, triangle},         {3, 4, quadrangle},
      {4, 4, tetrahedron},      {9, 6, curved_surface},   {10, 9, curved_surface},  {16, 8, curved_surface},
      {20, 9, curved_surface},  {21, 10, curved_surface}, {22, 12, curved_surface}, {23, 15, curved_surface},
      {24, 15, curved_surface}, {25, 21, curved_surface}};
  const auto* const found = std::ranges::find(types, type, &GmshType::type);
  return found == std::end(types) ? nullptr : found;
}

constexpr auto gmsh_curved_tetrahedra = std::to_array<long long>({11, 29, 30, 31});

std::string gmsh_kind(long long type) { return "an element of type " + std::to_string(type); }

constexpr const char* gmsh_order =
    ", which has nodes between its corners, expected first order (gmsh -order 1)";

}  // namespace

GmshShape gmsh_shape(long long type, const Location& at) {
  if (is_among(gmsh_curved_tetrahedra, type)) at.fail(gmsh_kind(type) + gmsh_order);
  const GmshType* const known = gmsh_type(type);
  if (!known) at.fail(gmsh_kind(type) + ", expected triangles, quadrangles or tetrahedra (types 2, 3 and 4)");
  return known->shape;
}

int gmsh_nodes(long long type) { return gmsh_type(type)->nodes; }

void add_gmsh_element(MeshBuilder& builder, long long type, std::span<const long long> nodes,
                      const Location& at) {
  const GmshShape shape = gmsh_shape(type, at);
  using enum GmshShape;
  if (shape == curved_surface) builder.add_unusable_face(at, gmsh_kind(type) + gmsh_order);
  if (shape == tetrahedron) builder.add_tet({nodes[0], nodes[1], nodes[2], nodes[3]}, at);
  if (shape == triangle || shape == quadrangle) builder.add_face(nodes, at);
}

}  // namespace springstab
