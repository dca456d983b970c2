// The readers of what other programs write by default: PLY, OFF, STL, VTK's XML files, and the binary files
// of Gmsh and VTK. One mesh is the same in every format, to the last bit of the numbers that the file has;
// what is not exactly right is refused with its line or its byte.
#include <algorithm>
#include <bit>
#include <boost/test/unit_test.hpp>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "solvers/io/gmsh.h"
#include "solvers/io/input_error.h"
#include "solvers/io/mesh_file.h"
#include "solvers/io/off.h"
#include "solvers/io/ply.h"
#include "solvers/io/stl.h"
#include "solvers/io/vtk.h"
#include "solvers/io/vtk_xml.h"
#include "solvers/scene/mesh_repair.h"
#include "tests/meshes.h"
#include "tests/places.h"
#include "tests/scratch.h"
#include "tests/texts.h"

BOOST_AUTO_TEST_SUITE(mesh_formats)

using namespace springstab;
using springstab::test::content_of;
using springstab::test::faces_of;
using springstab::test::replaced;
using TestFaces = springstab::test::Faces;

namespace {

using Places = std::vector<Eigen::Vector3d>;

/// What the other programs were given: a surface of a quadrangle and a triangle, and two tetrahedra.
const Places surface{{0, 0, 0}, {1, 0, 0.1}, {1.1, 1, 0}, {0, 0.9, -0.05}, {2, 0.25, 0.3}};
const TestFaces polygons{{0, 1, 2, 3}, {1, 4, 2}}, gmsh_polygons{{1, 4, 2}, {0, 1, 2, 3}},
    triangles{{0, 1, 2}, {0, 2, 3}, {1, 4, 2}},
    vtk_triangles{{2, 3, 1}, {0, 1, 3}, {1, 4, 2}};  // its filter divides along the other diagonal
const Places solid{{0, 0, 0}, {1, 0, 0.1}, {0, 1.1, 0}, {0, 0, 0.7}, {1, 1.5, 1}};
const std::vector<std::array<int, 4>> two_tets{{0, 1, 2, 3}, {1, 2, 3, 4}};

Places in_single_precision(Places places) {
  for (Eigen::Vector3d& p : places) p = p.cast<float>().cast<double>();
  return places;
}

std::string corpus(const std::string& name) { return test::source_folder() + "/tests/fuzz/corpus/" + name; }

/// Bytes of a number in an order.
template <class Number>
std::string bytes(Number value, std::endian order = std::endian::little) {
  std::string text(sizeof value, '\0');
  std::memcpy(text.data(), &value, sizeof value);
  if (order != std::endian::native) std::ranges::reverse(text);
  return text;
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "(read without an error)";
}

using Parse = std::function<void(const std::string& source, std::string_view text)>;

void check_refused(const Parse& parse, const std::string& text, const std::string& place,
                   const std::string& words) {
  const std::string message = message_of([&] { parse("a file", text); });
  BOOST_TEST_CONTEXT("the message\n" << message) {
    BOOST_TEST(message.starts_with("a file" + place + ": "));
    BOOST_TEST(message.find(words) != message.npos);
    BOOST_TEST(message.find("expected") != message.npos);
    BOOST_TEST(message.find('\n') == message.npos);
  }
}

/// Nothing that begins like the file from `from` bytes on is one.
void check_every_cut_is_refused(const Parse& parse, const std::string& text, std::size_t from,
                                std::size_t to) {
  BOOST_CHECK_NO_THROW(parse("a file", text));
  for (std::size_t end = from; end < to; ++end) BOOST_TEST_CONTEXT("cut after " << end) {
      BOOST_CHECK_THROW(parse("a file", text.substr(0, end)), InputError);
    }
}

/// The surface as a PLY file with coordinates of a type and indices of a type.
template <class Real, class Index, class Count>
std::string ply(const std::string& format, const std::string& real, const std::string& index,
                const std::string& count) {
  std::string text = "ply\nformat " + format +
                     " 1.0\ncomment by hand\nelement vertex 5\nproperty uchar flag\nproperty " + real +
                     " x\nproperty " + real + " y\nproperty " + real + " z\nelement face 2\nproperty list " +
                     count + " " + index + " vertex_indices\nproperty short part\nend_header\n";
  const std::endian order = format == "binary_big_endian" ? std::endian::big : std::endian::little;
  for (const Eigen::Vector3d& p : surface) {
    text += bytes(std::uint8_t{7}, order);
    for (const double x : p) text += bytes(static_cast<Real>(x), order);
  }
  for (const auto& face : polygons) {
    text += bytes(static_cast<Count>(face.size()), order);
    for (const int v : face) text += bytes(static_cast<Index>(v), order);
    text += bytes(std::int16_t{-3}, order);
  }
  return text;
}

const std::string ascii_ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
    "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n1 1 0.1\n0 1 0\n4 0 1 2 "
    "3\n";

const Parse parse_ply_file = [](const std::string& source, std::string_view text) {
  parse_ply(source, text);
};
const Parse parse_off_file = [](const std::string& source, std::string_view text) {
  parse_off(source, text);
};
const Parse parse_stl_file = [](const std::string& source, std::string_view text) {
  parse_stl(source, text);
};

}  // namespace

BOOST_AUTO_TEST_CASE(files_of_other_programs_read_back_equal) {
  const Places single = in_single_precision(surface);
  const struct {
    std::string name;
    Places places;
    TestFaces faces;
  } surfaces[] = {
      {"ply/meshio_ascii.ply", surface, polygons},
      {"ply/meshio_binary.ply", surface, polygons},
      {"ply/vtk_big.ply", single, polygons},
      {"ply/blender_like.ply", single, polygons},
      {"ply/blender_binary.ply", single, polygons},
      {"ply/blender_ascii.ply", surface, polygons},
      {"stl/blender.stl", single, triangles},
      {"off/meshio.off", surface, triangles},
      {"gmsh/gmsh_surface_22.msh", surface, gmsh_polygons},
      {"gmsh/gmsh_surface_41.msh", surface, gmsh_polygons},
      {"vtk/meshio_42.vtk", surface, polygons},
      {"vtk/vtk_poly_42.vtk", surface, polygons},
      {"vtk/vtk_poly_51.vtk", surface, polygons},
      {"stl/gmsh_ascii.stl", surface, triangles},
      {"stl/gmsh_binary.stl", single, triangles},
      {"stl/meshio_ascii.stl", surface, triangles},
      {"stl/meshio_binary.stl", single, triangles},
      {"stl/vtk_ascii.stl", surface, vtk_triangles},
      {"stl/vtk_binary.stl", single, vtk_triangles},
#ifdef SPRINGSTAB_EXPAT
      {"vtk_xml/vtk_ascii.vtp", surface, polygons},
      {"vtk_xml/vtk_base64.vtp", surface, polygons},
      {"vtk_xml/vtk_raw.vtp", surface, polygons},
      {"vtk_xml/vtk_appended64.vtp", surface, polygons},
      {"vtk_xml/meshio_ascii.vtu", surface, polygons},
      {"vtk_xml/meshio_binary.vtu", surface, polygons},
      {"vtk_xml/vtk_strips_big.vtp", single, {{3, 0, 2}, {2, 0, 1}, {2, 1, 4}}},
#ifdef SPRINGSTAB_ZLIB
      {"vtk_xml/vtk_zlib.vtp", surface, polygons},
#endif
#endif
  };
  for (const auto& file : surfaces) BOOST_TEST_CONTEXT(file.name) {
      const AnyMesh any = read_mesh(corpus(file.name));
      const Mesh& mesh = std::get<Mesh>(any);
      if (!file.name.starts_with("stl/")) {
        BOOST_TEST((mesh.vertices == file.places));
        BOOST_TEST((faces_of(mesh) == file.faces));
        continue;
      }
      // STL has no vertices: those of the same places, in another order.
      BOOST_TEST(mesh.vertices.size() == file.places.size());
      BOOST_TEST(mesh.faces() == static_cast<int>(file.faces.size()));
      for (const auto& face : file.faces) {
        Places corners;
        for (const int v : face) corners.push_back(file.places[v]);
        const auto is_it = [&](const std::vector<int>& candidate) {
          for (std::size_t turn = 0; turn < 3; ++turn) {
            bool same = true;
            for (std::size_t c = 0; c < 3; ++c)
              same = same && mesh.vertices[candidate[c]] == corners[(c + turn) % 3];
            if (same) return true;
          }
          return false;
        };
        BOOST_TEST(std::ranges::count_if(faces_of(mesh), is_it) == 1);
      }
    }
  for (const std::string& name : std::vector<std::string>{
           "gmsh/gmsh_tets_22.msh",
           "gmsh/gmsh_tets_41.msh",
           "gmsh/meshio_22.msh",
           "gmsh/meshio_tets_41.msh",
           "vtk/gmsh_tets.vtk",
           "vtk/meshio_tets_51.vtk",
           "vtk/vtk_tets_42.vtk",
           "vtk/vtk_tets_51.vtk",
#ifdef SPRINGSTAB_EXPAT
           "vtk_xml/vtk_ascii.vtu",
           "vtk_xml/vtk_raw_big.vtu",
#ifdef SPRINGSTAB_ZLIB
           "vtk_xml/vtk_zlib64.vtu",
           "vtk_xml/vtk_zlib_inline.vtu",
           "vtk_xml/meshio_zlib.vtu",
#endif
#endif
       })
    BOOST_TEST_CONTEXT(name) {
      const AnyMesh any = read_mesh(corpus(name));
      const TetMesh& mesh = std::get<TetMesh>(any);
      BOOST_TEST((mesh.vertices == solid));
      BOOST_TEST((mesh.tets == two_tets));
      BOOST_TEST(mesh.notes.empty());
      BOOST_TEST(holds_tetrahedra(corpus(name)));
    }
}

BOOST_AUTO_TEST_CASE(a_ply_file_has_numbers_of_any_type_and_order) {
  for (const std::string format : {"binary_little_endian", "binary_big_endian"})
    for (const auto& [text, places] :
         {std::pair(ply<double, int, std::uint8_t>(format, "double", "int", "uchar"), surface),
          {ply<double, std::uint16_t, int>(format, "float64", "ushort", "int32"), surface},
          {ply<float, std::int8_t, std::uint16_t>(format, "float32", "int8", "uint16"),
           in_single_precision(surface)},
          {ply<float, std::uint32_t, std::int8_t>(format, "float", "uint", "char"),
           in_single_precision(surface)}})
      for (const std::string end : {"", "\n"}) BOOST_TEST_CONTEXT(text.substr(0, 300)) {
          const Mesh mesh = parse_ply("a file", text + end);
          BOOST_TEST((mesh.vertices == places));
          BOOST_TEST((faces_of(mesh) == polygons));
          BOOST_TEST(mesh.notes.empty());
        }
  const Mesh mesh = parse_ply("a file", content_of(corpus("ply/edges.ply")));
  BOOST_TEST((mesh.vertices == Places{{3, 2, 0.1}, {6, 5, 4}, {1e-3, 8, 7}}));
  BOOST_TEST((faces_of(mesh) == TestFaces{{0, 1, 2}}));
  BOOST_TEST((mesh.vertex_line == std::vector<long>{15, 16, 17}));
  BOOST_TEST((mesh.face_line == std::vector<long>{19}));
  BOOST_REQUIRE_EQUAL(mesh.notes.size(), 2u);
  BOOST_TEST((mesh.notes[0].line == 20 && mesh.notes[0].text == "dropped a face of one or two corners"));
  BOOST_TEST((mesh.notes[1].line == 8 && mesh.notes[1].text == "the element 'edge' is not used"));
}

BOOST_AUTO_TEST_CASE(texture_coordinates_of_a_ply_file_are_those_of_its_corners) {
  const std::string text = content_of(corpus("ply/blender_like.ply"));
  const Mesh mesh = parse_ply("a file", text);
  const std::vector<Eigen::Vector2d> uv{{0, 0}, {0.5, 0}, {0.5, 1}, {0, 1}, {0.5, 0}, {1, 0.25}, {0.5, 1}};
  BOOST_TEST((mesh.corner_uv == uv));
  BOOST_TEST(parse_ply("a file", replaced(text, "float t\n", "float w\n")).corner_uv.empty());
  for (const float wrong :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const Mesh unusable =
        parse_ply("a file", std::string(text).replace(text.rfind(bytes(0.25F)), 4, bytes(wrong)));
    BOOST_TEST(unusable.corner_uv.empty());
    BOOST_REQUIRE_EQUAL(unusable.notes.size(), 1u);
    BOOST_TEST(unusable.notes[0].line < 0);
    BOOST_TEST(unusable.notes[0].text.starts_with("texture coordinates are no numbers"));
  }
}

BOOST_AUTO_TEST_CASE(a_malformed_ply_file_is_refused_with_its_line_or_its_byte) {
  const struct {
    std::string what, by, place, words;
  } cases[] = {{"ply\n", "plx\n", ":1", "begins the file"},
               {"ascii", "asci", ":2", "expected 'format ascii 1.0'"},
               {"element vertex 4", "element vertex", ":3", "in the header"},
               {"element vertex 4", "element vertex -4", ":3", "'-4' of them"},
               {"property double x", "property doubl x", ":4", "unknown type 'doubl'"},
               {"property double x", "property double w", ":3", "lack one of the properties x, y and z"},
               {"list uchar int", "list float int", ":8", "a list's length of type 'float'"},
               {"list uchar int", "list uchar", ":8", "expected 'property TYPE NAME'"},
               {"end_header", "end_headr", ":9", "in the header"},
               {"1 0 0\n", "1 0\n", ":11", "the line ends, expected 'z'"},
               {"1 0 0\n", "1 0 0 0\n", ":11", "'0' stands behind the last property of the element 'vertex'"},
               {"1 0 0\n", "1 nan 0\n", ":11", "not finite"},
               {"1 0 0\n", "1 x 0\n", ":11", "'x' is not a number"},
               {"4 0 1 2 3", "5 0 1 2 3", ":14", "the list 'vertex_index' has the length 5"},
               {"4 0 1 2 3", "4 0 1 2 4", ":14", "vertex 4, which is not there"},
               {"4 0 1 2 3", "4 0 1 2 3.5", ":14", "'3.5' is not an integer"},
               {"4 0 1 2 3\n", "4 0 1 2 3\n1\n", ":15", "stands behind the last element"},
               {"4 0 1 2 3\n", "", ":7", "1 of the element 'face' are announced"},
               {"element vertex 4", "element vertex 2000000000", ":3",
                "2000000000 of the element 'vertex' are announced"},
               {"property list uchar int vertex_index\n", "", ":7", "has no properties"},
               {"element face", "element faces", "", "neither tetrahedra nor faces"}};
  for (const auto& c : cases) BOOST_TEST_CONTEXT(c.what << " -> " << c.by) {
      check_refused(parse_ply_file, replaced(ascii_ply, c.what, c.by), c.place, c.words);
    }
  const std::string binary = ply<double, int, std::uint8_t>("binary_little_endian", "double", "int", "uchar");
  const std::size_t data = binary.find("end_header\n") + 11, faces = data + 5 * 25;
  const auto at = [](std::size_t byte) { return ": at byte " + std::to_string(byte); };
  check_every_cut_is_refused(parse_ply_file, binary, 0, binary.size());
  check_refused(parse_ply_file, binary + "x", at(binary.size()), "1 bytes behind the last element");
  check_refused(parse_ply_file, replaced(binary, "vertex 5", "vertex 99"), ":4",
                "99 of the element 'vertex' are announced");
  std::string wrong = binary;
  wrong[faces] = '\xff';
  check_refused(parse_ply_file, wrong, at(faces), "the list 'vertex_indices' has the length 255");
  wrong = binary;
  wrong.replace(data + 1, 8, bytes(std::numeric_limits<double>::infinity()));
  check_refused(parse_ply_file, wrong, at(data), "not finite");
  wrong = binary;
  wrong.replace(faces + 1, 4, bytes(-1));
  check_refused(parse_ply_file, wrong, at(faces), "the face has vertex -1, which is not there");
  const std::size_t second = faces + 1 + 4 * static_cast<unsigned char>(binary[faces]) + 2;
  wrong = replaced(binary.substr(0, second), "vertex_indices",
                   "vertex\x7f"
                   "indices");
  check_refused(parse_ply_file, wrong, at(second), "expected 'the length of the list vertex?indices'");
}

BOOST_AUTO_TEST_CASE(an_off_file_gives_its_vertices_and_faces_whatever_it_adds_to_them) {
  const Places corner{{0, 0, 0}, {1, 0, 0.5}, {0, 1, 0}};
  for (const std::string name : {"colours", "one_line"}) BOOST_TEST_CONTEXT(name) {
      const Mesh mesh = parse_off("a file", content_of(corpus("off/" + name + ".off")));
      BOOST_TEST((mesh.vertices == corner));
      BOOST_TEST((faces_of(mesh) == TestFaces{{0, 1, 2}}));
    }
  const std::string off = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n2 0 1\n";
  const Mesh mesh = parse_off("a file", off);
  BOOST_TEST(mesh.faces() == 1);
  BOOST_TEST((mesh.face_line == std::vector<long>{7}));
  BOOST_REQUIRE_EQUAL(mesh.notes.size(), 1u);
  BOOST_TEST(mesh.notes[0].line == 8);
  const struct {
    std::string what, by, place, words;
  } cases[] = {{"OFF", "4OFF", ":1", "'4OFF' begins the file"},
               {"OFF", "OFF BINARY", ":1", "the file is binary"},
               {"4 2 0", "4", ":2", "has 1 numbers"},
               {"4 2 0", "5 2 0", ":7", "a vertex of 4 numbers"},
               {"4 2 0", "4 1 0", ":8", "behind the last face"},
               {"4 2 0", "4 3000000000 0", ":2", "'3000000000' faces"},
               {"1 1 0\n", "1 1\n", ":5", "a vertex of 2 numbers"},
               {"1 1 0\n", "1 1 0 0\n", ":5", "a vertex of 4 numbers"},
               {"1 1 0\n", "1 1 inf\n", ":5", "'inf' is not finite"},
               {"3 0 1 2", "3 0 1", ":7", "a face of 3 corners with 2 numbers"},
               {"3 0 1 2", "3 0 1 2 0 0 0 0 0", ":7", "with 8 numbers"},
               {"3 0 1 2", "3 0 1 4", ":7", "vertex 4, which is not there"},
               {"3 0 1 2", "3 0 1 2.5", ":7", "'2.5' is not an integer"}};
  for (const auto& c : cases) BOOST_TEST_CONTEXT(c.what << " -> " << c.by) {
      check_refused(parse_off_file, replaced(off, c.what, c.by), c.place, c.words);
    }
}

BOOST_AUTO_TEST_CASE(corners_of_an_stl_file_at_one_place_are_one_vertex_and_only_these) {
  const double below_one = std::nextafter(1., 0.);
  const auto facet = [](const std::string& a, const std::string& b, const std::string& c) {
    return "  facet normal 0 0 0\n    outer loop\n      vertex " + a + "\n      vertex " + b +
           "\n      vertex " + c + "\n    endloop\n  endfacet\n";
  };
  const std::string text = "solid a name\n" + facet("0 0 0", "1 0 0", "0 1 0") + "endsolid a name\nsolid\n" +
                           facet("0 -0 0", "0 1 0", "0.99999999999999989 0 0") + "endsolid\n";
  const Mesh mesh = parse_stl("a file", text);
  BOOST_TEST((mesh.vertices == Places{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {below_one, 0, 0}}));
  BOOST_TEST((faces_of(mesh) == TestFaces{{0, 1, 2}, {0, 2, 3}}));
  BOOST_TEST((mesh.face_line == std::vector<long>{2, 11}));
  BOOST_REQUIRE_EQUAL(mesh.notes.size(), 1u);
  BOOST_TEST(mesh.notes[0].line == 2);
  BOOST_TEST(mesh.notes[0].text.starts_with("6 corners are joined to 4 vertices"));
  BOOST_TEST(!repaired(mesh).repair.changed());

  // Binary files may begin like those in ASCII do.
  std::string binary = content_of(corpus("stl/meshio_binary.stl"));
  const Mesh before = parse_stl("a file", binary);
  binary.replace(0, 27, "solid facet normal vertex 1");
  BOOST_TEST((parse_stl("a file", binary).vertices == before.vertices));
  BOOST_TEST(before.notes[0].line == at_byte(84));
  check_every_cut_is_refused(parse_stl_file, binary, 0, binary.size());
  check_refused(parse_stl_file, content_of(corpus("stl/vtk_binary.stl")) + "x", ": at byte 80",
                "3 facets are announced, expected 234 bytes, not 235");
  std::string huge = content_of(corpus("stl/vtk_binary.stl"));
  huge.replace(80, 4, "\xff\xff\xff\xff");
  check_refused(parse_stl_file, huge, ": at byte 80", "4294967295 facets are announced");
  binary.replace(84 + 12, 4, bytes(std::numeric_limits<float>::quiet_NaN()));
  check_refused(parse_stl_file, binary, ": at byte 96", "a coordinate is not finite");

  const struct {
    std::string what, by, place, words;
  } cases[] = {{"solid a", "sold a", ":1", "expected 'solid'"},
               {"facet normal 0 0 0", "facet normal 0 0", ":2", "expected 'facet normal X Y Z'"},
               {"outer loop", "outer", ":3", "expected 'outer loop'"},
               {"vertex 1 0 0", "vertex 1 0", ":5", "expected 'vertex X Y Z'"},
               {"vertex 1 0 0", "vertex 1 0 x", ":5", "'x' is not a number"},
               {"    endloop\n", "      vertex 0 0 0\n    endloop\n", ":7", "expected 'endloop'"},
               {"endsolid a name\n", "", ":9", "expected facet or endsolid"},
               {"endsolid\n", "", ":17", "the file ends, expected facet or endsolid"},
               {"endsolid\n", "endsolid\nmore\n", ":19", "expected solid or the end of the file"}};
  for (const auto& c : cases) BOOST_TEST_CONTEXT(c.what << " -> " << c.by) {
      check_refused(parse_stl_file, replaced(text, c.what, c.by), c.place, c.words);
    }
  check_refused(parse_stl_file, "solid nothing\nendsolid\n", "", "expected facets");
}

BOOST_AUTO_TEST_CASE(a_malformed_binary_vtk_file_is_refused_with_its_byte) {
  const std::string sound = content_of(corpus("vtk/vtk_poly_42.vtk")),
                    newer = content_of(corpus("vtk/vtk_poly_51.vtk"));
  check_every_cut_is_refused(parse_vtk, sound, 0, sound.find('\n', sound.find("POLYGONS")) + 37);
  const std::size_t points = sound.find("double\n") + 7, polygons_at = sound.find("POLYGONS"),
                    cells = sound.find('\n', polygons_at) + 1;
  const auto at = [](std::size_t byte) { return ": at byte " + std::to_string(byte); };
  const auto with = [&](std::size_t where, const std::string& what) {
    return std::string(sound).replace(where, what.size(), what);
  };
  check_refused(parse_vtk, with(points, bytes(std::numeric_limits<double>::quiet_NaN(), std::endian::big)),
                at(points), "a coordinate is not finite");
  check_refused(parse_vtk, with(cells, bytes(-1, std::endian::big)), at(cells), "-1 corners");
  check_refused(parse_vtk, with(cells, bytes(1 << 30, std::endian::big)), "", "expected a corner");
  check_refused(parse_vtk, with(cells + 4, bytes(5, std::endian::big)), at(cells),
                "the face has vertex 5, which is not there");
  check_refused(parse_vtk, replaced(sound, "POLYGONS 2 9", "POLYGONS 2 8"), "",
                "9 numbers of cells, expected the 8");
  check_refused(parse_vtk, replaced(sound, "POINTS 5 double", "POINTS 2147483647 double"), "",
                "expected a coordinate");
  check_refused(parse_vtk, replaced(sound, "double\n", "doubles\n"), at(sound.find("POINTS")),
                "the type of numbers 'doubles'");
  check_refused(parse_vtk, replaced(newer, "OFFSETS vtktypeint64", "OFFSETS double"),
                at(newer.find("OFFSETS")), "expected a type of integers");
  // Arrays that are not needed, of each kind: bits, strings with lengths of one and of two bytes, numbers.
  const std::string fields = "FIELD FieldData 3\nnames 1 2 string\n" + std::string("\xC3") + "abc" +
                             std::string("\x80\x46") + std::string(70, 'x') + "\nbits 3 3 bit\n" +
                             "\xff\x80" + "\nn 1 1 unsigned_long\n12345678\n";
  BOOST_CHECK_NO_THROW(parse_vtk("a file", replaced(sound, "POINTS", fields + "POINTS")));
  check_refused(
      parse_vtk,
      replaced(sound, "POINTS", replaced(fields, "1 1 unsigned", "1 2147483647 unsigned") + "POINTS"), "",
      "2147483647 values are announced");
}

BOOST_AUTO_TEST_CASE(a_malformed_binary_gmsh_file_is_refused_with_its_byte) {
  const std::string sound = content_of(corpus("gmsh/gmsh_tets_41.msh")),
                    older = content_of(corpus("gmsh/gmsh_tets_22.msh"));
  for (const std::string& text : {sound, older})
    check_every_cut_is_refused(parse_gmsh, text, 0, text.find("$EndElements"));
  const auto at = [](std::size_t byte) { return ": at byte " + std::to_string(byte); };
  const auto with = [&](const std::string& text, std::size_t where, const std::string& what) {
    return std::string(text).replace(where, what.size(), what);
  };
  const std::size_t one = sound.find("8\n") + 2, nodes = sound.find("$Nodes\n") + 7,
                    elements = sound.find("$Elements\n") + 10;
  constexpr auto huge = std::uint64_t{1} << 62;
  check_refused(parse_gmsh, with(sound, one, bytes(2)), at(one), "the number 1 is missing");
  check_refused(parse_gmsh, replaced(sound, "4.1 1 8", "4.1 1 4"), ":2", "numbers of 8 bytes");
  check_refused(parse_gmsh, replaced(sound, "4.1 1 8", "4.0 1 8"), ":2",
                "the file is binary, expected text: `gmsh");
  check_refused(parse_gmsh, with(sound, nodes, bytes(huge)), at(nodes + 32),
                "4611686018427387904 blocks are announced");
  check_refused(parse_gmsh, with(sound, nodes + 8, bytes(std::uint64_t{6})), at(nodes),
                "5 nodes, expected the 6");
  check_refused(parse_gmsh, with(sound, nodes + 32, bytes(7)), at(nodes + 32), "an entity of dimension 7");
  check_refused(parse_gmsh, with(sound, nodes + 44, bytes(huge)), at(nodes + 52), "nodes are announced");
  check_refused(parse_gmsh, with(sound, nodes + 52 + 40, bytes(std::numeric_limits<double>::infinity())),
                at(nodes + 52 + 40), "a coordinate is not finite");
  check_refused(parse_gmsh, with(sound, elements + 40, bytes(5)), at(elements + 32), "an element of type 5");
  check_refused(parse_gmsh, with(sound, elements + 40, bytes(11)), at(elements + 32),
                "nodes between its corners");
  check_refused(parse_gmsh, with(sound, elements + 60, bytes(std::uint64_t{9})), at(elements + 52),
                "the tetrahedron has vertex 9, which is not there");
  check_refused(parse_gmsh, replaced(older, "$Elements\n2", "$Elements\n3"), "", "expected");
  check_refused(parse_gmsh, replaced(older, "$Nodes\n5", "$Nodes\n99999"), "", "99999 nodes are announced");
}

#ifdef SPRINGSTAB_EXPAT
BOOST_AUTO_TEST_CASE(a_malformed_vtk_xml_file_is_refused_with_its_line) {
  const std::string sound = content_of(corpus("vtk_xml/vtk_ascii.vtp"));
  const struct {
    std::string what, by, place, words;
  } cases[] = {{"</VTKFile>", "", ":67", "this is no XML"},
               {"<PolyData>", "<PolyDat>", ":64", "this is no XML (mismatched tag)"},
               {"VTKFile type", "VTKFil type", ":65", "this is no XML"},
               {"\"PolyData\"", "\"ImageData\"", ":2", "the data are 'ImageData'"},
               {"LittleEndian", "Middle", ":2", "byte_order is 'Middle'"},
               {"UInt64", "UInt16", ":2", "header_type is 'UInt16'"},
               {"NumberOfPoints=\"5\"", "NumberOfPoints=\"6\"", ":10", "15 coordinates, expected the 18"},
               {"NumberOfPoints=\"5\"", "NumberOfPoints=\"-5\"", ":4", "expected a number from 0"},
               {"NumberOfPolys=\"2\"", "NumberOfPolys=\"3\"", "", "2 offsets, expected the 3"},
               {"NumberOfComponents=\"3\"", "NumberOfComponents=\"2\"", ":10", "points of '2' components"},
               {"Float64", "Float80", ":10", "an array of type 'Float80'"},
               {"format=\"ascii\"", "format=\"gzip\"", ":10", "the format is 'gzip'"},
               {"1.1 1 0", "1.1 x 0", ":12", "'x' is not a number"},
               {"1.1 1 0", "1.1 nan 0", ":12", "'nan' is not finite"},
               {"2 0.25 0.3", "2 0.25 1e999", ":13", "out of range"},
               {"<Points>", "<Point>", "", "this is no XML"},
               {"<?xml version=\"1.0\"?>\n", "<!DOCTYPE a [<!ENTITY b \"c\">]>\n", ":1", "a document type"}};
  for (const auto& c : cases) BOOST_TEST_CONTEXT(c.what << " -> " << c.by) {
      const std::string message = message_of([&] { parse_vtk_xml("a file", replaced(sound, c.what, c.by)); });
      BOOST_TEST_CONTEXT(message) {
        BOOST_TEST(message.starts_with("a file:"));
        if (!c.place.empty() && c.words.find("XML") == c.words.npos)
          BOOST_TEST(message.starts_with("a file" + c.place + ": "));
        BOOST_TEST(message.find(c.words) != message.npos);
        BOOST_TEST(message.find("expected") != message.npos);
      }
    }
  const std::size_t polys = sound.find("<Polys>");
  const auto in_polys = [&](const std::string& what, const std::string& by) {
    return sound.substr(0, polys) + replaced(sound.substr(polys), what, by);
  };
  const Parse parse = [](const std::string& source, std::string_view text) { parse_vtk_xml(source, text); };
  check_refused(parse, in_polys("0 1 2 3 1 4", "0 1 2 3 1 5"), ":44",
                "cell 1 has the point 5, which is not there, expected one of the piece's 5");
  check_refused(parse, in_polys("4 7", "4 8"), ":48",
                "the offset 8 of cell 1 is out of order, expected 4 to 7");
  check_refused(parse, in_polys("4 7", "4 3"), ":48", "the offset 3 of cell 1");
  check_refused(parse, in_polys("connectivity", "connections"), ":42",
                "no DataArray of the name connectivity");
  check_refused(parse, in_polys("Int64", "Float64"), ":43", "expected integers");
  check_refused(parse, "", ":1", "expected");
}

BOOST_AUTO_TEST_CASE(encoded_arrays_of_a_vtk_xml_file_that_end_or_lie_are_refused) {
  const Parse parse = [](const std::string& source, std::string_view text) { parse_vtk_xml(source, text); };
  const std::string raw = content_of(corpus("vtk_xml/vtk_raw.vtp")),
                    base64 = content_of(corpus("vtk_xml/vtk_base64.vtp"));
  const std::size_t data = raw.find("   _") + 4;
  check_every_cut_is_refused(parse, raw, 0, data + 8 + 120);
  check_every_cut_is_refused(parse, base64, 0, base64.find("</VTKFile>") + 9);
  const auto with = [&](const std::string& what) {
    return std::string(raw).replace(data, what.size(), what);
  };
  check_refused(parse, with(bytes(std::uint64_t{1} << 30)), ":9", "the encoded data end");
  check_refused(parse, with(bytes(std::uint64_t{1} << 40)), ":9", "expected at most 2^31 - 1");
  check_refused(parse, with(bytes(std::uint64_t{119})), ":9",
                "119 bytes of data, expected whole numbers of 8 bytes");
  check_refused(parse, with(bytes(std::uint64_t{112})), ":9", "14 coordinates, expected the 15");
  check_refused(parse, replaced(raw, "offset=\"0\"", "offset=\"99999\""), ":9", "the offset is 99999");
  check_refused(parse, with(bytes(std::uint64_t{120}) + bytes(std::numeric_limits<double>::quiet_NaN())),
                ":9", "number 1 of the array is not finite");
  check_refused(parse, replaced(base64, "eAAAA", "eA*AA"), ":10", "'*' among the encoded data");
  check_refused(parse, content_of(corpus("vtk_xml/vtk_lz4.vtp")), ":2",
                "compressed by 'vtkLZ4DataCompressor', expected vtkZLibDataCompressor");
#ifdef SPRINGSTAB_ZLIB
  // blocks, bytes of a block, of the last one, and compressed bytes of each; then the blocks
  const std::string zlib = content_of(corpus("vtk_xml/vtk_zlib.vtp"));
  const std::size_t first = zlib.find("   _") + 4;
  const auto packed = [&](std::size_t where, const std::string& what) {
    return std::string(zlib).replace(first + where, what.size(), what);
  };
  check_refused(parse, packed(8, bytes(std::uint64_t{1} << 30)), ":9", "too few for what is announced");
  check_refused(parse, packed(8, bytes(std::uint64_t{80})), ":9", "the data are damaged");
  check_refused(parse, packed(0, bytes(std::uint64_t{1} << 28)), ":9", "the encoded data end");
  check_refused(parse, packed(8 * 5 + 4, "\xff\xff\xff"), ":9", "the data are damaged");
#endif
}
#else
BOOST_AUTO_TEST_CASE(without_expat_xml_is_refused_by_the_name_of_the_package) {
  check_refused([](const std::string& source, std::string_view text) { parse_vtk_xml(source, text); },
                "<VTKFile/>", "", "libexpat1-dev");
}
#endif

BOOST_AUTO_TEST_CASE(pieces_of_a_vtk_xml_file_stand_one_behind_another) {
#ifdef SPRINGSTAB_EXPAT
  const std::string text = content_of(corpus("vtk_xml/meshio_ascii.vtu"));
  const std::size_t begin = text.find("<Piece"), end = text.find("</Piece>") + 8;
  const std::string piece = text.substr(begin, end - begin);
  const AnyMesh any = parse_vtk_xml("a file", text.substr(0, end) + '\n' + piece + text.substr(end));
  const Mesh& mesh = std::get<Mesh>(any);
  BOOST_TEST(mesh.vertices.size() == 10u);
  BOOST_TEST((faces_of(mesh) == TestFaces{{0, 1, 2, 3}, {1, 4, 2}, {5, 6, 7, 8}, {6, 9, 7}}));
  BOOST_TEST((repaired(mesh).mesh.vertices == surface));
#endif
}

BOOST_AUTO_TEST_SUITE_END()
