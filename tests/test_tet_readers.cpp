// The readers of tetrahedral meshes: one mesh is the same in every format, what is not needed is skipped, and
// what is not exactly right is refused with its line.
#include <boost/test/unit_test.hpp>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include "solvers/io/gmsh.h"
#include "solvers/io/input_error.h"
#include "solvers/io/mesh_file.h"
#include "solvers/io/vega.h"
#include "solvers/io/vtk.h"
#include "tests/scratch.h"
#include "tests/shared_data.h"
#include "tests/texts.h"

BOOST_AUTO_TEST_SUITE(tet_readers)

using namespace springstab;
using springstab::test::replaced;
using springstab::test::with_crlf;
using springstab::test::with_line_ends;

namespace {

using Parse = std::function<AnyMesh(const std::string&, std::string_view)>;

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
const std::string gmsh_parametric =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Elements\n2\n3 4 2 0 1 7 2 3 4\n4 4 3 0 1 0 2 3 4 "
    "5\n$EndElements\n"
    "// a comment\n# $End\n$Comments\n$Nodes\nare\n$EndComments\n$ParametricNodes\n5\n7 0 0 0 0 1\n2 +1 0 0 "
    "1 2 0.5\n3 0 1 0 2 3 "
    "0.5 0.25\n"
    "4 0 0 1 3 1\n5 1 1.5 1 3 1\n$EndParametricNodes\n";
// As Gmsh writes them: blocks by entity, parametric places on curves and surfaces, numbers with gaps.
const std::string gmsh_4_0 =
    "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Entities\n1 0 0 1\n1 0 0 0 0 0 0 0\n1 0 0 0 1 1.5 1 0 "
    "0\n$EndEntities\n"
    "$Nodes\n4 5\n1 0 0 1\n10 0 0 0\n1 1 1 2\n20 1 0 0 0.5\n30 0 1 0 0.75\n2 2 1 1\n40 0 0 1 0.5 0.5\n"
    "1 3 0 1\n500 1 1.5 1e0\n$EndNodes\n"
    "$Elements\n3 4\n1 0 15 1\n1 10\n1 2 2 1\n2 10 20 30\n1 3 4 2\n3 10 20 30 40\n9 20 30 40 "
    "500\n$EndElements\n";
const std::string gmsh_4_1 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"all of it\"\n$EndPhysicalNames\n"
    "$PartitionedEntities\n2\n0\n0 0 0 0\n$EndPartitionedEntities\n"
    "$Nodes\n5 5 10 500\n0 1 0 1\n10\n0 0 0\n1 1 1 2\n20\n30\n1 0 0 0.5\n0 1 0 0.75\n2 1 1 1\n40\n0 0 1 0.5 "
    "0.5\n"
    "2 2 0 0\n3 1 0 1\n500\n1 1.5 1e0\n$EndNodes\n"
    "$Elements\n3 4 1 9\n0 1 15 1\n1 10\n2 1 2 1\n2 10 20 30\n3 1 4 2\n3 10 20 30 40\n9 20 30 40 "
    "500\n$EndElements\n"
    "$Periodic\n0\n$EndPeriodic\n$GhostElements\n0\n$EndGhostElements\n";
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
               {"gmsh parametric", parse_gmsh, gmsh_parametric, {6, 7}},
               {"gmsh 4.0", parse_gmsh, gmsh_4_0, {28, 29}},
               {"gmsh 4.1", parse_gmsh, gmsh_4_1, {38, 39}},
               {"vega", parse_vega, vega, {13, 14}},
               {"vtk 2", parse_vtk, vtk_2, {15, 16}},
               {"vtk 5", parse_vtk, vtk_5, {18, 18}}};

void check_mesh(const AnyMesh& any) {
  const TetMesh& mesh = std::get<TetMesh>(any);
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
      const AnyMesh mesh = format.parse("a file", format.text);
      check_mesh(mesh);
      BOOST_TEST(std::get<TetMesh>(mesh).tet_line == format.tet_lines, boost::test_tools::per_element());
      BOOST_TEST(std::get<TetMesh>(mesh).notes.empty());  // the triangle bounds a tetrahedron
      for (const char* end : {"\r\n", "\r"})
        check_mesh(format.parse("a file", with_line_ends(format.text, end)));
      check_mesh(format.parse("a file", "\xEF\xBB\xBF" + format.text));
    }
}

BOOST_AUTO_TEST_CASE(a_file_that_is_cut_is_refused_until_all_elements_are_there) {
  for (const auto& format : formats) BOOST_TEST_CONTEXT(format.name) {
      // after the last tetrahedron a file may end where it ends in order: at the end mark, or after what
      // follows
      const std::string last = format.name == "gmsh 1"            ? "$ENDELM"
                               : format.name == "gmsh parametric" ? "$EndParametricNodes"
                               : format.name.starts_with("gmsh")  ? "$EndElements"
                               : format.name == "vega"            ? "2 2 3 4 5"
                               : format.name == "vtk 2"           ? "5\n10\n10"
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
      {{"2.2 0 8", "4.1 0 8", 9, "(version 4.1)"},
       {"2.2 0 8", "4 0 8", 9, "(version 4.0)"},
       {"2.2 0 8", "3 0 8", 2, "version '3'"},
       {"2.2 0 8", "22 0 8", 2, "version '22'"},
       {"2.2 0 8", "4.2 0 8", 2, "version '4.2'"},
       {"2.2 0 8", "2.2 2 8", 2, "a file type of 0 or 1"},
       {"2.2 0 8", "2.2", 2, "1 words"},
       {"$Nodes", "Nodes", 8, "begins no section"},
       {"$Nodes\n5", "$Nodes\n6", 15, "5 nodes, expected the 6"},
       {"$Nodes\n5", "$Nodes\n4", 15, "5 nodes, expected the 4"},
       {"$Nodes\n5", "$Nodes\n-5", 9, "'-5' nodes"},
       {"$Nodes\n5", "$Nodes\n99999999999", 9, "expected a number from 0"},
       {"2 +1 0 0", "2 +1 0", 11, "a node of 3 words"},
       {"2 +1 0 0", "2 +1 0 nan", 11, "'nan' is not finite"},
       {"2 +1 0 0", "2 +1 0 0#", 11, "'0#' is not a number"},
       {"2 +1 0 0", "2 +1 0 1.#IND", 11, "'1.#IND' is not finite"},
       {"2 +1 0 0", "2 +1 0 zero", 11, "'zero' is not a number"},
       {"2 +1 0 0", "1 +1 0 0", 11, "vertex 1 is there a second time (it stands on line 10 too)"},
       {"1 2 3 4\n", "1 2 3 9\n", 20, "vertex 9, which is not there"},
       {"1 2 3 4\n", "1 2 3\n", 20, "a tetrahedron of 8 words"},
       {"3 4 2 0 1 1 2 3 4", "3 5 2 0 1 1 2 3 4 5 1 2 3", 20, "element of type 5"},
       {"3 4 2 0 1 1 2 3 4", "3 11 2 0 1 1 2 3 4", 20, "element of type 11"},
       {"3 4 2 0 1 1 2 3 4", "3 4 -2 0 1 1 2 3 4", 20, "'-2' tags"},
       {"$EndNodes", "$EndElements", 15, "expected '$EndNodes'"},
       {"3 4 2 0 1 1 2 3 4\n4 4 3 0 1 0 2 3 4 5", "3 15 2 0 1 1\n4 9 3 0 1 0 2 3 4 5 1 2", 21, "type 9"}});
  check_refused(parse_gmsh, gmsh_1,
                {{"2 1 1 3 10 20 30\n2 4 1 1 4 10 20 30 40\n7 4 1 1 4 20 30 40 50",
                  "15 1 1 1 10\n2 1 1 1 2 10 20\n7 1 1 1 2 10 20", 0, "neither tetrahedra nor faces"},
                 {"2 4 1 1 4 10 20 30 40", "2 4 1 1 4 10 20 30 41", 12, "vertex 41"},
                 {"2 4 1 1 4 10 20 30 40", "2 4 1 1 4 10 20 30 40 50", 12, "10 words"}});
}

BOOST_AUTO_TEST_CASE(malformed_gmsh_4_files_are_refused_with_their_line) {
  check_refused(parse_gmsh, gmsh_4_0,
                {{"4 0 8", "4.1 0 8", 10, "(version 4.1)"},
                 {"$Nodes\n4 5", "$Nodes\n5 5", 20, "the section ends"},
                 {"$Nodes\n4 5", "$Nodes\n4 6", 20, "5 nodes, expected the 6"},
                 {"$Nodes\n4 5", "$Nodes\n3 5", 18, "4 nodes, expected the 5"},
                 {"1 1 1 2", "1 1 0 2", 14, "a node of 5 words"},
                 {"1 3 0 1", "1 3 0 2", 20, "the block ends"},
                 {"40 0 0 1 0.5 0.5", "40 0 0 1 0.5 0.5 0.5", 17, "a node of 7 words"},
                 {"1 3 4 2", "1 3 5 2", 28, "type 5"},
                 {"1 3 4 2", "1 3 4 1", 29, "3 elements, expected the 4"},
                 {"9 20 30 40 500", "9 20 30 40 50", 29, "vertex 50"},
                 {"9 20 30 40 500", "9 20 30 40", 29, "a tetrahedron of 4 words"}});
  check_refused(parse_gmsh, gmsh_4_1,
                {{"4.1 0 8", "4.0 0 8", 14, "(version 4.0)"},
                 {"4.1 0 8", "4.1 2 8", 2, "a file type of 0 or 1"},
                 {"1 1 1 2\n20", "1 1 0 2\n20", 21, "a node of 4 words"},
                 {"1 1 1 2\n20", "9223372036854775807 1 1 2\n20", 18, "an entity of dimension"},
                 {"20\n30\n", "20 30\n", 19, "a number of a node of 2 words"},
                 {"20\n30\n", "20\n10\n", 22, "vertex 10 is there a second time"},
                 {"3 10 20 30 40", "3 10 20 30 4x", 38, "'4x' is not an integer"}});
}

// Two triangles of a unit square, in every format that has surfaces, and what each writes differently.
BOOST_AUTO_TEST_CASE(triangles_quadrangles_and_polygons_are_a_surface) {
  const std::string head =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n";
  const std::string grid =
      "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
      "0 0 0 1 0 0 1 1 0 0 1 0\n";
  const std::string poly = replaced(grid, "UNSTRUCTURED_GRID", "POLYDATA");
  const std::string offsets = "OFFSETS vtktypeint64\n", connectivity = "CONNECTIVITY vtktypeint64\n";
  const std::vector<std::vector<int>> two{{0, 1, 2}, {0, 2, 3}}, one{{0, 1, 2, 3}};
  const struct {
    Parse parse;
    std::string text;
    std::vector<std::vector<int>> faces;
  } cases[] = {
      {parse_gmsh,
       head + "$Elements\n4\n1 15 2 0 1 1\n2 1 2 0 1 1 2\n3 2 2 0 1 1 2 3\n4 2 0 1 3 4\n$EndElements\n", two},
      {parse_gmsh, head + "$Elements\n1\n3 3 2 0 1 1 2 3 4\n$EndElements\n", one},
      {parse_gmsh,
       "$NOD\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$ENDNOD\n$ELM\n2\n1 2 1 1 3 1 2 3\n2 2 1 1 3 1 3 "
       "4\n$ENDELM\n",
       two},
      {parse_gmsh,
       "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 "
       "0\n"
       "$EndNodes\n$Elements\n2 2 1 2\n2 1 2 1\n1 1 2 3\n2 2 2 1\n2 1 3 4\n$EndElements\n",
       two},
      {parse_vtk, grid + "CELLS 2 8\n3 0 1 2\n3 0 2 3\nCELL_TYPES 2\n5 5\n", two},
      {parse_vtk,
       grid + "CELLS 4 14\n1 0\n2 0 1\n3 0 1 2\n4 0 1 2 3\nCELL_TYPES 4\n1 3 5 9\nCELL_DATA 4\nnonsense",
       {{0, 1, 2}, {0, 1, 2, 3}}},
      {parse_vtk, grid + "CELLS 1 5\n4 0 1 3 2\nCELL_TYPES 1\n8\n", one},
      {parse_vtk, grid + "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n7\n", one},
      {parse_vtk,
       grid + "CELLS 2 4\n" + offsets + "0 4\n" + connectivity + "1 0 2 3\nCELL_TYPES 1\n6\n",
       {{1, 0, 2}, {2, 0, 3}}},
      {parse_vtk, poly + "VERTICES 1 2\n1 0\nLINES 1 3\n2 0 1\nPOLYGONS 2 8\n3 0 1 2\n3 0 2 3\n", two},
      {parse_vtk, poly + "POLYGONS 1 5\n4 0 1 2 3\nPOINT_DATA 4\nNORMALS n float\n", one},
      {parse_vtk, poly + "TRIANGLE_STRIPS 1 5\n4 0 1 2 3\n", {{0, 1, 2}, {2, 1, 3}}},
      {parse_vtk,
       poly + "LINES 2 2\n" + offsets + "0 2\n" + connectivity + "0 1\nPOLYGONS 3 6\n" + offsets + "0 3 6\n" +
           connectivity + "0 1 2 0 2 3\n",
       two},
      {parse_vtk,
       replaced(poly, "POINTS",
                "FIELD FieldData 2\nname 1 2 string\na%20b\n\nMETADATA\nINFORMATION 1\nNAME x LOCATION y\n\n"
                "cycle 2 1 int\n1 2\nPOINTS") +
           "METADATA\nCOMPONENT_NAMES\nx\n\nPOLYGONS 1 5\n4 0 1 2 3\n",
       one},
      {parse_vtk,
       replaced(poly, "DATASET", "FIELD FieldData 1\nTIME 1 1 double\n0\nDATASET") +
           "POLYGONS 1 5\n4 0 1 2 3\n",
       one},
  };
  for (const auto& c : cases)
    for (const char* end : {"\n", "\r\n", "\r"}) BOOST_TEST_CONTEXT(c.text) {
        const AnyMesh any = c.parse("a file", with_line_ends(c.text, end));
        const Mesh& mesh = std::get<Mesh>(any);
        BOOST_REQUIRE_EQUAL(mesh.vertices.size(), 4u);
        BOOST_TEST((mesh.vertices[2] == Eigen::Vector3d(1, 1, 0)));
        std::vector<std::vector<int>> faces;
        for (int f = 0; f < mesh.faces(); ++f) faces.emplace_back(mesh.face(f).begin(), mesh.face(f).end());
        BOOST_TEST((faces == c.faces));
        BOOST_TEST(mesh.face_line.size() == faces.size());
        BOOST_TEST(mesh.vertex_line.size() == 4u);
        BOOST_TEST(mesh.notes.empty());
      }
  const AnyMesh any = parse_vtk("a file", poly + "POLYGONS 3 9\n2 0 1\n1 0\n3 0 1 2\n");
  BOOST_REQUIRE_EQUAL(std::get<Mesh>(any).notes.size(), 1u);
  BOOST_TEST(std::get<Mesh>(any).notes[0].line == 8);
  BOOST_TEST(std::get<Mesh>(any).notes[0].text == "2 faces of one or two corners are dropped");
  check_refused(
      parse_vtk, poly + "POLYGONS 2 8\n3 0 1 2\n3 0 2 3\n",
      {{"3 0 2 3", "3 0 2 4", 9, "the face has vertex 4"},
       {"POLYGONS 2 8", "POLYGONS 2 9", 9, "numbers of cells"},
       {"POLYGONS 2 8", "CELLS 2 8", 7, "unknown keyword 'CELLS', expected POINTS, POLYGONS"},
       {"POINTS 4 float", "POINTS 4", 6, "expected a type of numbers"},
       {"ASCII", "EBCDIC", 3, "the file is 'EBCDIC', expected ASCII or BINARY"},
       {"POLYDATA", "STRUCTURED_GRID", 4, "'STRUCTURED_GRID', expected UNSTRUCTURED_GRID or POLYDATA"}});
  check_refused(
      parse_vtk, grid + "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n",
      {{"CELL_TYPES 1\n5", "CELL_TYPES 1\n9", 8, "type 9 has 3 corners, expected 4"},
       {"3 0 1 2\nCELL_TYPES 1\n5", "3 0 1 2\nCELL_TYPES 1\n22", 8, "a cell of type 22, which has points"}});
}

BOOST_AUTO_TEST_CASE(faces_beside_tetrahedra_are_told_unless_they_bound_one) {
  const auto notes = [](const std::string& text) {
    return std::get<TetMesh>(parse_gmsh("a file", text)).notes;
  };
  const std::vector<FileNote> one = notes(replaced(gmsh_2, "2 2 2 0 1 1 2 3\n", "2 2 2 0 1 1 2 5\n"));
  BOOST_REQUIRE_EQUAL(one.size(), 1u);
  BOOST_TEST(one[0].line == 19);
  BOOST_TEST(one[0].text == "a face that bounds no tetrahedron is left out");
  BOOST_TEST(notes(replaced(gmsh_2, "2 2 2 0 1 1 2 3\n", "2 3 2 0 1 1 2 3 4\n")).size() == 1u);
  BOOST_TEST(notes(replaced(gmsh_2, "2 2 2 0 1 1 2 3\n", "2 2 2 0 1 3 1 2\n")).empty());
  BOOST_TEST(notes(replaced(gmsh_2, "2 2 2 0 1 1 2 3\n", "2 9 2 0 1 1 2 3 4 5 1\n")).empty());
}

BOOST_AUTO_TEST_CASE(malformed_vega_files_are_refused_with_their_line) {
  check_refused(parse_vega, vega,
                {{"*VERTICES", "*VERTICE", 2, "unknown section"},
                 {"*VERTICES", "*INCLUDE other.veg\n*VERTICES", 2, "another file ('*INCLUDE other.veg')"},
                 {"5 3 0 0", "*INCLUDE nodes.txt\n5 3 0 0", 3, "another file ('*INCLUDE nodes.txt')"},
                 {"2 2 3 4 5", "*INCLUDE more.txt", 14, "another file"},
                 {"TET\n", "*INCLUDE tets.txt\n", 11, "another file"},
                 {"2 1 0 0", "2 1 0 1.#QNAN", 5, "'1.#QNAN' is not finite"},
                 {"2 1 0 0", "2 1 0 0#", 5, "'0#' is not a number"},
                 {"5 3 0 0", "5 2 0 0", 3, "before the vertices"},
                 {"5 3 0 0", "5 3 1 0", 4, "a vertex of 4 words"},
                 {"5 3 0 0", "6 3 0 0", 10, "5 vertices, expected the 6"},
                 {"TET\n", "CUBIC\n", 11, "'CUBIC', expected TET"},
                 {"2 4 0", "2 8 0", 12, "before the elements"},
                 {"2 4 0", "3 4 0", 16, "2 elements, expected the 3"},
                 {"2 2 3 4 5", "2 2 3 4 6", 14, "vertex 6"},
                 {"2 2 3 4 5", "2 2 3 4 five", 14, "'five' is not an integer"}});
}

BOOST_AUTO_TEST_CASE(what_a_set_or_material_of_a_vega_file_includes_is_skipped_with_it) {
  check_mesh(parse_vega(
      "a file",
      vega + "\n*SET a\n1, 2\n*INCLUDE list.txt\n*SET b\n*INCLUDE list.txt # x\n3\n*REGION\na, BODY\n"));
  check_mesh(parse_vega("a file", "*MATERIAL x\n*INCLUDE m.txt\n" + vega));
}

BOOST_AUTO_TEST_CASE(malformed_vtk_files_are_refused_with_their_line) {
  check_refused(parse_vtk, vtk_2,
                {{"# vtk", "# VTK", 1, "begins the file"},
                 {"ASCII", "BINARI", 3, "expected ASCII or BINARY"},
                 {"ASCII", "ASC", 3, "expected ASCII"},
                 {"UNSTRUCTURED_GRID", "STRUCTURED_POINTS", 4, "expected UNSTRUCTURED_GRID"},
                 {"POINTS", "DOTS", 5, "unknown keyword 'DOTS'"},
                 {"POINTS 5", "POINTS 6", 10, "is not a number"},
                 {"POINTS 5", "POINTS 4", 7, "unknown keyword"},
                 {"CELLS 3 14", "CELLS 3 13", 16, "numbers of cells"},
                 {"CELLS 3 14", "CELLS 4 14", 18, "is not an integer"},
                 {"4 0 1 2 3", "4 0 1 2 7", 15, "vertex 7"},
                 {"5\n10\n10\n", "5\n12\n10\n", 20, "type 12"},
                 {"5\n10\n10\n", "10\n10\n10\n", 14, "3 corners"},
                 {"5\n10\n10\n", "6\n10\n25\n", 21, "type 25"},
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

BOOST_AUTO_TEST_CASE(the_suffix_names_the_format_and_the_contents_say_what_it_holds) {
  const test::ScratchFolder folder;
  const auto path = [&](const std::string& name, const std::string& text) {
    return folder.file(name, text).string();
  };
  const std::string surface = replaced(replaced(gmsh_1, "2 4 1 1 4 10 20 30 40", "2 2 1 1 3 20 30 40"),
                                       "7 4 1 1 4 20 30 40 50", "7 2 1 1 3 20 30 50");
  const std::string solid = path("a.MSH", gmsh_2), cloth = path("b.msh", surface),
                    grid = path("c.b.vtk", vtk_5), beam = path("d.Veg", vega),
                    plain = path("e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
                    bare = path("bare", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const auto& [name, tetrahedra] :
       {std::pair(solid, true), {cloth, false}, {grid, true}, {beam, true}, {plain, false}, {bare, false}}) {
    BOOST_TEST(holds_tetrahedra(name) == tetrahedra, name);
    const AnyMesh mesh = read_mesh(name);
    BOOST_TEST(std::holds_alternative<TetMesh>(mesh) == tetrahedra, name);
    BOOST_TEST(std::visit([](const auto& m) { return m.source; }, mesh) == name);
  }
  BOOST_TEST(std::get<Mesh>(read_mesh(cloth)).faces() == 3);
  BOOST_TEST(holds_tetrahedra(path("bad.msh", "nonsense")));
  for (const char* absent : {"absent.msh", "absent.obj"}) BOOST_CHECK_THROW(read_mesh(absent), InputError);
  BOOST_CHECK_EXCEPTION(read_mesh(path("a.xyz", "solid")), InputError, [](const InputError& error) {
    return std::string(error.what()).find("expected a suffix: .json for a scene, .obj") != std::string::npos;
  });
}

BOOST_AUTO_TEST_CASE(binary_files_are_refused_with_what_makes_text_of_them) {
  const test::ScratchFolder folder;
  const std::string zeros(8, '\0');
  for (const auto& [name, text, remedy] :
       {std::tuple<std::string, std::string, std::string>(
            "a.msh", "$MeshFormat\n4 1 8\n\1" + zeros + "\n$EndMeshFormat\n",
            "expected text: `gmsh FILE -save -setnumber Mesh.Binary 0"),
        {"b.msh", "$MeshFormat\n4.0 1 8\n\1\n$EndMeshFormat\n", "expected text: `gmsh FILE"},
        {"a.veg", "\x1f\x8b\b" + zeros, "`gunzip`"},
        {"a.veg", "\x1f\x8b\b\1", "`gunzip`"},
        {"a.obj", "v " + zeros, "a zero byte, expected text in ASCII"}})
    BOOST_TEST_CONTEXT(name << ", " << remedy) {
      const bool told_as_binary = name != "a.obj";
      const std::string words = remedy;
      const auto is_right = [&](const InputError& error) {
        const std::string message = error.what();
        return (message.find("the file is binary") != message.npos) == told_as_binary &&
               message.find(words) != message.npos;
      };
      BOOST_CHECK_EXCEPTION(read_mesh(folder.file(name, text).string()), InputError, is_right);
    }
}

BOOST_AUTO_TEST_CASE(meshes_that_were_read_wrongly_or_refused) {
  const auto directory = test::shared_data("faults");
  if (!directory) return;
  const auto read = [&](const std::string& name) { return read_mesh((*directory / name).string()); };
  for (const auto& [name, faces] : {std::pair("tri.msh", 1), {"meshio935.vtk", 2}, {"polydata.vtk", 1}})
    BOOST_TEST(std::get<Mesh>(read(name)).faces() == faces, name);
  BOOST_TEST(std::get<TetMesh>(read("include.veg")).tets.size() == 1u);
  for (const auto& [name, message] :
       {std::pair("msh41.msh", "msh41.msh:5: "),
        {"include2.veg", "'*INCLUDE nodes.txt'"},
        {"bin.msh", "bin.msh: at byte 49"},  // it ends early
        {"bin.vtk", "bin.vtk: at byte 90"},
        {"veg_qnan_read_as_1.veg", "veg_qnan_read_as_1.veg:6: '1.#QNAN' is not finite"}})
    BOOST_CHECK_EXCEPTION(read(name), InputError, [words = message](const InputError& error) {
      return std::string(error.what()).find(words) != std::string::npos;
    });
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
        const TetMesh mesh = std::get<TetMesh>(read_mesh(path->string()));
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
