#include "solvers/io/gmsh_binary.h"

#include <vector>

#include "solvers/io/gmsh_elements.h"

namespace springstab {
namespace {

long long gmsh_int(BinaryReader& bytes, const std::string& what) {
  return bytes.integer(NumberType::i32, what);
}
long long gmsh_size(BinaryReader& bytes, const std::string& what) {
  return bytes.integer(NumberType::u64, what);
}
double gmsh_real(BinaryReader& bytes) { return bytes.finite(NumberType::f64, "a coordinate"); }

Eigen::Vector3d gmsh_position(BinaryReader& bytes) {
  const double x = gmsh_real(bytes), y = gmsh_real(bytes), z = gmsh_real(bytes);
  return {x, y, z};
}

/// The numbers of blocks and of things, and the least and greatest number of a thing; then the blocks, each
/// with three integers and a number of things of at least so many bytes each.
template <class Block>
void gmsh_blocks(BinaryReader& bytes, const std::string& things, std::size_t least, const Block& block) {
  const Location at = bytes.at();
  const long long blocks = gmsh_size(bytes, "a number of blocks"),
                  announced = gmsh_size(bytes, "a number of " + things);
  gmsh_size(bytes, "the least number"), gmsh_size(bytes, "the greatest number");
  bytes.expect_room(blocks, 20, "blocks");
  long long found = 0;
  for (long long b = 0; b < blocks; ++b) {
    const Location head_at = bytes.at();
    const long long dimension = gmsh_int(bytes, "a dimension");
    gmsh_int(bytes, "the tag of an entity");
    const long long kind = gmsh_int(bytes, "a kind"), size = gmsh_size(bytes, "a number of " + things);
    if (dimension < 0 || dimension > 3)
      head_at.fail("an entity of dimension " + std::to_string(dimension) + ", expected 0 to 3");
    bytes.expect_room(size, least, things);
    block(dimension, kind, size, head_at);
    found += size;
  }
  check_count(at, things, found, announced);
}

/// The nodes of an element, from numbers of a type.
void gmsh_element(BinaryReader& bytes, NumberType number, long long type, const Location& at,
                  MeshBuilder& builder) {
  std::vector<long long> nodes;
  for (int n = gmsh_nodes(type); n > 0; --n) nodes.push_back(bytes.integer(number, "a node of an element"));
  add_gmsh_element(builder, type, nodes, at);
}

}  // namespace

void read_gmsh_nodes(BinaryReader& bytes, MeshBuilder& builder) {
  gmsh_blocks(
      bytes, "nodes", 32, [&](long long dimension, long long parametric, long long size, const Location&) {
        std::vector<long long> numbers;
        for (long long i = 0; i < size; ++i) numbers.push_back(gmsh_size(bytes, "the number of a node"));
        for (const long long number : numbers) {
          const Location at = bytes.at();
          const Eigen::Vector3d position = gmsh_position(bytes);
          bytes.take(parametric != 0 ? static_cast<std::size_t>(8 * dimension) : 0, "parameters of a node");
          builder.add_vertex(number, position, at);
        }
      });
}

void read_gmsh_elements(BinaryReader& bytes, MeshBuilder& builder) {
  gmsh_blocks(bytes, "elements", 16, [&](long long, long long type, long long size, const Location& head_at) {
    gmsh_shape(type, head_at);
    for (long long i = 0; i < size; ++i) {
      const Location at = bytes.at();
      gmsh_size(bytes, "the number of an element");
      gmsh_element(bytes, NumberType::u64, type, at, builder);
    }
  });
}

void read_gmsh_2_nodes(BinaryReader& bytes, long long count, MeshBuilder& builder) {
  bytes.expect_room(count, 28, "nodes");
  for (long long i = 0; i < count; ++i) {
    const Location at = bytes.at();
    const long long number = gmsh_int(bytes, "the number of a node");
    builder.add_vertex(number, gmsh_position(bytes), at);
  }
}

/// Runs of elements of one type: the type, how many, and how many tags each has before its nodes.
void read_gmsh_2_elements(BinaryReader& bytes, long long count, MeshBuilder& builder) {
  bytes.expect_room(count, 8, "elements");
  for (long long left = count; left > 0;) {
    const Location head_at = bytes.at();
    const long long type = gmsh_int(bytes, "a type of elements"),
                    run = gmsh_int(bytes, "a number of elements"), tags = gmsh_int(bytes, "a number of tags");
    gmsh_shape(type, head_at);
    if (run < 1 || run > left)
      head_at.fail(std::to_string(run) + " elements, expected 1 to the " + std::to_string(left) +
                   " that are left");
    if (tags < 0) head_at.fail(std::to_string(tags) + " tags, expected 0 or more");
    for (long long i = 0; i < run; ++i) {
      const Location at = bytes.at();
      gmsh_int(bytes, "the number of an element");
      bytes.take(static_cast<std::size_t>(4 * tags), "the tags of an element");
      gmsh_element(bytes, NumberType::i32, type, at, builder);
    }
    left -= run;
  }
}

}  // namespace springstab
