// The readers of tetrahedral meshes: one mesh is the same in every format, what is not needed is skipped, and
// what is not exactly right is refused with its line.
#include <boost/test/unit_test.hpp>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "solvers/io/gmsh.h"
#include "solvers/io/input_error.h"
#include "solvers/io/tet_file.h"
#include "solvers/io/vega.h"
#include "solvers/io/vtk.h"
#include "tests/shared_data.h"

BOOST_AUTO_TEST_SUITE(tet_readers)

using namespace springstab;

namespace {

using Parse = std::function<TetMesh(const std::string&, std::string_view)>;

/// Two tetrahedra at the face of the second, third and fourth vertex; each file has the coordinates in other
/// notations and something that is to be skipped.
const std::string gmsh_1 =
    "$NOD\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n50 1 1.5 1e0\n$ENDNOD\n"
    "$ELM\n3\n1 2 1 1 3 10 20 30\n2 4 1 1 4 10 20 30 40\n7 4 1 1 4 20 30 40 50\n$ENDELM\n";
const std::string gmsh_2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"all of it\"\n$EndPhysicalNames\n"
    "$Nodes\n5\n1 0 0 0\n2 +1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1.5 1\n$EndNodes\n"
    "$Elements\n4\n1 15 2 0 1 1\n2 2 2 0 1 1 2 3\n3 4 2 0 1 1 2 3 4\n4 4 3 0 1 0 2 3 4 5\n$EndElements\n"
    "$NodeData\n1\n\"a name\"\n0\n$EndNodeData\n";
const std::string vega =
    "# a comment\n*VERTICES\n5 3 0 0\n1 0 0 0 # the first\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1.5 1\n\n"
    "*ELEMENTS\nTET\n2 4 0\n1 1 2 3 4\n2 2 3 4 5\n\n*MATERIAL BODY\nENU, 1000, 1e7, "
    "0.45\n\n*REGION\nallElements, BODY\n";
const std::string vtk_2 =
    "# vtk DataFile Version 2.0\nTwo tetrahedra\nASCII\nDATASET UNSTRUCTURED_GRID\n"
    "POINTS 5 float\n0 0 0 1 0 0\n0 1 0 0 0 1 1\n1.5 1\n\nMETADATA\nINFORMATION 0\n\n"
    "CELLS 3 14\n3 0 1 2\n4 0 1 2 3\n4 1 2 3 4\n\nCELL_TYPES 3\n5\n10\n10\n\nPOINT_DATA 5\nSCALARS s "
    "float\nLOOKUP_TABLE t\n1 2 3 4 5\n";
const std::string vtk_5 =
    "# vtk DataFile Version 5.1\nTwo tetrahedra\nASCII\nDATASET UNSTRUCTURED_GRID\n"
    "FIELD FieldData 1\nTIME 1 1 double\n0.5\npoints 5 double\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1.5 1\n"
    "CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3 1 2 3 4\nCELL_TYPES 2\n10 "
    "10\n";

const struct {
  std::string name;
  Parse parse;
  std::string text;
  std::vector<long> tet_lines;
} formats[] = {{"gmsh 1", parse_gmsh, gmsh_1, {12, 13}},
               {"gmsh 2", parse_gmsh, gmsh_2, {20, 21}},
               {"vega", parse_vega, vega, {13, 14}},
               {"vtk 2", parse_vtk, vtk_2, {15, 16}},
               {"vtk 5", parse_vtk, vtk_5, {18, 18}}};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  BOOST_REQUIRE(at != text.npos);
  return text.replace(at, what.size(), by);
}

std::string with_crlf(const std::string& text) {
  std::string crlf;
  for (const char c : text) crlf += c == '\n' ? "\r\n" : std::string(1, c);
  return crlf;
}

void check_mesh(const TetMesh& mesh) {
  BOOST_REQUIRE_EQUAL(mesh.vertices.size(), 5u);
  BOOST_TEST((mesh.vertices[0] == Eigen::Vector3d(0, 0, 0)));
  BOOST_TEST((mesh.vertices[1] == Eigen::Vector3d(1, 0, 0)));
  BOOST_TEST((mesh.vertices[4] == Eigen::Vector3d(1, 1.5, 1)));
  BOOST_TEST((mesh.tets == std::vector<std::array<int, 4>>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
  BOOST_TEST(mesh.vertex_line.size() == 5u);
  BOOST_TEST(mesh.source == "a file");
}

struct Malformed {
  std::string what, by;  // replaced in the sound file
  long line;             // 0: no line applies
  std::string message;
};

void check_refused(const Parse& parse, const std::string& sound, const std::vector<Malformed>& cases) {
  for (const Malformed& wrong : cases) BOOST_TEST_CONTEXT("'" << wrong.what << "' -> '" << wrong.by << "'") {
      const std::string place = "a file" + (wrong.line ? ":" + std::to_string(wrong.line) : "") + ": ";
      std::string message = "(read without an error)";
      try {
        parse("a file", replaced(sound, wrong.what, wrong.by));
      } catch (const InputError& error) {
        message = error.what();
      }
      BOOST_TEST_CONTEXT("the message\n" << message) {
        BOOST_TEST(message.starts_with(place));
        BOOST_TEST(message.find(wrong.message) != message.npos);
        BOOST_TEST(message.find("expected") != message.npos);
        BOOST_TEST(message.find('\n') == message.npos);
      }
    }
}

}  // namespace

BOOST_AUTO_TEST_CASE(one_mesh_is_the_same_in_every_format) {
  for (const auto& format : formats) BOOST_TEST_CONTEXT(format.name) {
      const TetMesh mesh = format.parse("a file", format.text);
      check_mesh(mesh);
      BOOST_TEST(mesh.tet_line == format.tet_lines, boost::test_tools::per_element());
      check_mesh(format.parse("a file", with_crlf(format.text)));
      check_mesh(format.parse("a file", "\xEF\xBB\xBF" + format.text));
    }
}

BOOST_AUTO_TEST_CASE(a_file_that_is_cut_is_refused_until_all_elements_are_there) {
  for (const auto& format : formats) BOOST_TEST_CONTEXT(format.name) {
      // after the last tetrahedron a file may end where it ends in order: at the end mark, or after what
      // follows
      const std::string last = format.name == "gmsh 1"   ? "$ENDELM"
                               : format.name == "gmsh 2" ? "$EndElements"
                               : format.name == "vega"   ? "2 2 3 4 5"
                               : format.name == "vtk 2"  ? "5\n10\n10"
                                                         : "10 10";
      const std::size_t enough = format.text.find(last) + last.size();
      for (std::size_t end = 0; end + 1 < enough; end = format.text.find('\n', end + 1)) {
        const std::string cut = format.text.substr(0, end);
        if (end == format.text.npos || end >= enough) break;
        BOOST_TEST_CONTEXT("the file\n" << cut) {
          BOOST_CHECK_THROW(format.parse("a file", cut), InputError);
        }
      }
      check_mesh(format.parse("a file", format.text.substr(0, enough)));
    }
}

BOOST_AUTO_TEST_CASE(malformed_gmsh_files_are_refused_with_their_line) {
  check_refused(
      parse_gmsh, gmsh_2,
      {{"2.2 0 8", "4.1 0 8", 2, "version '4.1'"},
       {"2.2 0 8", "2.2 1 8", 2, "binary"},
       {"2.2 0 8", "2.2", 2, "1 words"},
       {"$Nodes", "Nodes", 8, "begins no section"},
       {"$Nodes\n5", "$Nodes\n6", 15, "5 nodes, expected the 6"},
       {"$Nodes\n5", "$Nodes\n4", 15, "5 nodes, expected the 4"},
       {"$Nodes\n5", "$Nodes\n-5", 9, "'-5' nodes"},
       {"$Nodes\n5", "$Nodes\n99999999999", 9, "expected a number from 0"},
       {"2 +1 0 0", "2 +1 0", 11, "a node of 3 words"},
       {"2 +1 0 0", "2 +1 0 nan", 11, "'nan' is not finite"},
       {"2 +1 0 0", "2 +1 0 zero", 11, "'zero' is not a number"},
       {"2 +1 0 0", "1 +1 0 0", 11, "vertex 1 is there a second time (it stands on line 10 too)"},
       {"1 2 3 4\n", "1 2 3 9\n", 20, "vertex 9, which is not there"},
       {"1 2 3 4\n", "1 2 3\n", 20, "a tetrahedron of 8 words"},
       {"3 4 2 0 1 1 2 3 4", "3 5 2 0 1 1 2 3 4 5 1 2 3", 20, "element of type 5"},
       {"3 4 2 0 1 1 2 3 4", "3 11 2 0 1 1 2 3 4", 20, "element of type 11"},
       {"3 4 2 0 1 1 2 3 4", "3 4 -2 0 1 1 2 3 4", 20, "'-2' tags"},
       {"$EndNodes", "$EndElements", 15, "expected '$EndNodes'"},
       {"3 4 2 0 1 1 2 3 4\n4 4 3 0 1 0 2 3 4 5", "3 2 2 0 1 1 2 3\n4 2 3 0 1 0 2 3 4", 0, "no tetrahedra"}});
  check_refused(parse_gmsh, gmsh_1,
                {{"2 4 1 1 4 10 20 30 40", "2 4 1 1 4 10 20 30 41", 12, "vertex 41"},
                 {"2 4 1 1 4 10 20 30 40", "2 4 1 1 4 10 20 30 40 50", 12, "10 words"}});
}

BOOST_AUTO_TEST_CASE(malformed_vega_files_are_refused_with_their_line) {
  check_refused(parse_vega, vega,
                {{"*VERTICES", "*VERTICE", 2, "unknown section"},
                 {"*VERTICES", "*INCLUDE other.veg\n*VERTICES", 2, "unknown section '*INCLUDE'"},
                 {"5 3 0 0", "5 2 0 0", 3, "before the vertices"},
                 {"5 3 0 0", "5 3 1 0", 4, "a vertex of 4 words"},
                 {"5 3 0 0", "6 3 0 0", 10, "5 vertices, expected the 6"},
                 {"TET\n", "CUBIC\n", 11, "'CUBIC', expected TET"},
                 {"2 4 0", "2 8 0", 12, "before the elements"},
                 {"2 4 0", "3 4 0", 16, "2 elements, expected the 3"},
                 {"2 2 3 4 5", "2 2 3 4 6", 14, "vertex 6"},
                 {"2 2 3 4 5", "2 2 3 4 five", 14, "'five' is not an integer"}});
}

BOOST_AUTO_TEST_CASE(malformed_vtk_files_are_refused_with_their_line) {
  check_refused(parse_vtk, vtk_2,
                {{"# vtk", "# VTK", 1, "begins the file"},
                 {"ASCII", "BINARY", 3, "expected ASCII"},
                 {"UNSTRUCTURED_GRID", "POLYDATA", 4, "expected UNSTRUCTURED_GRID"},
                 {"POINTS", "DOTS", 5, "unknown keyword 'DOTS'"},
                 {"POINTS 5", "POINTS 6", 10, "is not a number"},
                 {"POINTS 5", "POINTS 4", 7, "unknown keyword"},
                 {"CELLS 3 14", "CELLS 3 13", 16, "numbers of cells"},
                 {"CELLS 3 14", "CELLS 4 14", 18, "is not an integer"},
                 {"4 0 1 2 3", "4 0 1 2 7", 15, "vertex 7"},
                 {"5\n10\n10\n", "5\n12\n10\n", 20, "type 12"},
                 {"5\n10\n10\n", "10\n10\n10\n", 14, "3 corners"},
                 {"CELL_TYPES 3", "CELL_TYPES 2", 18, "types of cells"},
                 {"CELL_TYPES 3\n5\n10\n10\n", "", 19, "expected CELL_TYPES"}});
  check_refused(parse_vtk, vtk_5,
                {{"0 4 8\n", "0 9 8\n", 16, "out of order"},
                 {"0 4 8\n", "0 4 9\n", 17, "9 corners by the offsets, expected the 8"},
                 {"0 4 8\n", "0 3 8\n", 18, "3 corners"},
                 {"CONNECTIVITY", "CONNECTIONS", 17, "expected CONNECTIVITY"}});
}

BOOST_AUTO_TEST_CASE(a_count_that_the_file_cannot_back_takes_no_memory) {
  BOOST_CHECK_THROW(parse_gmsh("a file", replaced(gmsh_2, "$Nodes\n5", "$Nodes\n2000000000")), InputError);
  BOOST_CHECK_THROW(parse_vega("a file", replaced(vega, "5 3 0 0", "2000000000 3 0 0")), InputError);
  BOOST_CHECK_THROW(parse_vtk("a file", replaced(vtk_2, "CELLS 3 14", "CELLS 2000000000 2000000000")),
                    InputError);
  BOOST_CHECK_THROW(parse_vtk("a file", replaced(vtk_5, "TIME 1 1", "TIME 2000000000 2000000000")),
                    InputError);
}

BOOST_AUTO_TEST_CASE(the_suffix_names_the_format) {
  BOOST_TEST(is_tet_file("a.msh"));
  BOOST_TEST(is_tet_file("folder/A.VEG"));
  BOOST_TEST(is_tet_file("a.b.vtk"));
  BOOST_TEST(!is_tet_file("a.obj"));
  BOOST_TEST(!is_tet_file("msh"));
  BOOST_CHECK_THROW(read_tets("absent.msh"), InputError);
  BOOST_CHECK_THROW(read_tets("absent.obj"), InputError);
}

BOOST_AUTO_TEST_CASE(meshes_of_other_programs_have_their_published_counts_and_volumes) {
  struct Published {
    std::string name;
    std::size_t vertices, tets;
    double least, most, sum;  // [m³]
  };
  for (const auto& p : {Published{"sofa_truss_tetra.msh", 40, 54, 1.85e-07, 1.86667e-07, 1e-05},
                        Published{"vega_beam3_tet.veg", 208, 450, 1.06667e-05, 1.06667e-05, 0.0048}})
    if (const auto path = test::shared_data("meshes/" + p.name)) BOOST_TEST_CONTEXT(p.name) {
        const TetMesh mesh = read_tets(path->string());
        BOOST_TEST(mesh.vertices.size() == p.vertices);
        BOOST_REQUIRE_EQUAL(mesh.tets.size(), p.tets);
        double least = 1e300, most = 0, sum = 0;
        for (int t = 0; t < static_cast<int>(mesh.tets.size()); ++t) {
          const double volume = std::abs(mesh.six_volumes(t)) / 6;
          least = std::min(least, volume);
          most = std::max(most, volume);
          sum += volume;
        }
        const auto published = boost::test_tools::tolerance(1e-5);  // in six digits
        BOOST_TEST(least == p.least, published);
        BOOST_TEST(most == p.most, published);
        BOOST_TEST(sum == p.sum, published);
      }
}

BOOST_AUTO_TEST_SUITE_END()
