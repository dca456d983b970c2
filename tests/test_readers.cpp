// The readers of meshes and matrices: what a file says is what is read, and what is not exactly right is
// refused with its line.
#include <Eigen/Core>
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <filesystem>
#include <locale>
#include <string>
#include <vector>

#include "solvers/io/harwell_boeing.h"
#include "solvers/io/input_error.h"
#include "solvers/io/matrix_file.h"
#include "solvers/io/matrix_market.h"
#include "solvers/io/obj.h"
#include "solvers/io/text_file.h"
#include "tests/fuzz/readers.h"
#include "tests/places.h"
#include "tests/scratch.h"
#include "tests/shared_data.h"
#include "tests/texts.h"

BOOST_AUTO_TEST_SUITE(readers)

using springstab::InputError;
using springstab::Mesh;
using springstab::read_matrix;
using springstab::read_obj;
using springstab::test::content_of;
using springstab::test::replaced;
using springstab::test::ScratchFile;
using springstab::test::ScratchFolder;
using springstab::test::with_crlf;
using springstab::test::with_line_ends;

namespace {

template <class Read>
auto read_text(const Read& read, const std::string& text, const std::string& suffix = "") {
  const ScratchFile file(text, "file" + suffix);
  return read(file.name());
}

Mesh obj(const std::string& text) { return read_text(read_obj, text); }

Eigen::SparseMatrix<double> read_matrix_as_is(const std::string& path) { return read_matrix(path); }

Eigen::MatrixXd matrix(const std::string& text) { return read_text(read_matrix_as_is, text).toDense(); }

/// A file that must be refused: in which line, and with which words.
struct Malformed {
  std::string text;
  long line;  // 0: no line applies
  std::string message;
};

template <class Read>
void check_refused(const Read& read, const std::string& suffix, const std::vector<Malformed>& cases) {
  for (const Malformed& wrong : cases) BOOST_TEST_CONTEXT("the file\n" << wrong.text) {
      const ScratchFile file(wrong.text, "file" + suffix);
      const std::string place = file.name() + (wrong.line ? ":" + std::to_string(wrong.line) : "") + ": ";
      std::string message = "(read without an error)";
      try {
        read(file.name());
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

/// A file whose lines are all needed is refused when it is cut after any line but the last.
void check_every_cut_is_refused(const std::string& text) {
  matrix(text);  // the whole is fine
  for (std::size_t end = text.find('\n'); end + 1 < text.size(); end = text.find('\n', end + 1)) {
    const std::string cut = text.substr(0, end + 1);
    BOOST_TEST_CONTEXT("the file\n" << cut) {
      BOOST_CHECK_THROW(read_text(read_matrix_as_is, cut, ".mtx"), InputError);
    }
  }
}

const std::string symmetric_market =
    "%%MatrixMarket matrix coordinate real symmetric\n"
    "3 3 4\n"
    "1 1 2.5\n"
    "3 1 -1e-3\n"
    "2 2 +4\n"
    "3 3 .125\n";

const std::string skew_market =
    "%%MatrixMarket matrix coordinate real skew-symmetric\n"
    "3 3 2\n"
    "2 1 1.5\n"
    "3 2 -2\n";

/// [4 -1 0; -1 4 -2; 0 -2 5], its lower triangle in columns.
std::string harwell_boeing(const std::string& type = "RSA",
                           const std::string& formats = "(4I3) (5I2) (3F7.1)",
                           const std::string& values = "    4.0   -1.0    4.0\n   -2.0    5.0\n") {
  return "A small stiffness matrix                                                SMALL\n"
         "             4             1             1             2\n" +
         type + "                        3             3             5             0\n" + formats +
         "\n"
         "  1  3  5  6\n"
         " 1 2 2 3 3\n" +
         values;
}

const Eigen::Matrix3d harwell_boeing_matrix{{4, -1, 0}, {-1, 4, -2}, {0, -2, 5}};

}  // namespace

BOOST_AUTO_TEST_CASE(a_file_that_cannot_be_read_is_refused_by_name_and_reason) {
  const ScratchFolder folder;
  const std::string directory = folder.path(), missing = folder.path() / "missing",
                    empty = folder.file("empty", "");
  const auto refused = [](const std::string& path, const std::string& reason) {
    return [=](const InputError& error) {
      const std::string message = error.what();
      return message.starts_with(path + ": ") && message.find(reason) != message.npos &&
             message.find("expected") != message.npos;
    };
  };
  for (const auto& read : {+[](const std::string& path) { springstab::read_text_file(path); },
                           +[](const std::string& path) { read_obj(path); },
                           +[](const std::string& path) { read_matrix(path); }}) {
    BOOST_CHECK_EXCEPTION(read(missing), InputError, refused(missing, "No such file"));
    BOOST_CHECK_EXCEPTION(read(directory), InputError, refused(directory, "Is a directory"));
    BOOST_CHECK_EXCEPTION(read(empty), InputError, refused(empty, "empty"));
  }
}

BOOST_AUTO_TEST_CASE(an_obj_file_gives_its_vertices_faces_and_lines) {
  const std::string text =
      "# a comment \\\n"
      "mtllib cloth.mtl\n"
      "o cloth\n"
      "f 1 2 3\n"  // ahead of its vertices
      "v 0 +1 -2.5e-1\n"
      "v\t1 2 3 0.5\n"
      "  v 4 5 6 1 0 0 # red\n"
      "\n"
      "vt 0 0\nvn 0 0 1\ns off\n"
      "f 3/1/1 2/1 1//1 \\\n"
      "  -1 -2\n"
      "v 7 8 9\n"
      "f -4/-1/-1 2 4";
  for (const std::string& variant : {text, with_crlf(text), "\xEF\xBB\xBF" + text}) {
    const ScratchFile file(variant);
    const Mesh mesh = read_obj(file.name());
    BOOST_REQUIRE(mesh.vertices.size() == 4U);
    BOOST_TEST((mesh.vertices[0] == Eigen::Vector3d(0, 1, -0.25)));
    BOOST_TEST((mesh.vertices[1] == Eigen::Vector3d(1, 2, 3)));
    BOOST_TEST((mesh.vertices[2] == Eigen::Vector3d(4, 5, 6)));
    BOOST_TEST((mesh.vertices[3] == Eigen::Vector3d(7, 8, 9)));
    BOOST_TEST(mesh.face_offsets == (std::vector<int>{0, 3, 8, 11}), boost::test_tools::per_element());
    BOOST_TEST(mesh.face_vertices == (std::vector<int>{0, 1, 2, 2, 1, 0, 2, 1, 0, 1, 3}),
               boost::test_tools::per_element());
    BOOST_TEST(mesh.vertex_line == (std::vector<long>{5, 6, 7, 14}), boost::test_tools::per_element());
    BOOST_TEST(mesh.face_line == (std::vector<long>{4, 12, 15}), boost::test_tools::per_element());
    BOOST_TEST(mesh.source == file.name());
  }
}

BOOST_AUTO_TEST_CASE(every_malformed_obj_file_is_refused_with_its_line) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  check_refused(read_obj, ".obj",
                {
                    {"v 0 abc 0\n", 1, "'abc' is not a number"},
                    {"\nv 0 0 1.5x\n", 2, "'1.5x' is not a number"},
                    {"v 0 0 1,5\n", 1, "'1,5' is not a number"},
                    {"v 0 0 0x10\n", 1, "'0x10' is not a number"},
                    {"v 0 0 1.0D+00\n", 1, "'1.0D+00' is not a number"},
                    {"v 0 0 +-1\n", 1, "'+-1' is not a number"},
                    {"v 0 0 +\n", 1, "'+' is not a number"},
                    {"v nan 0 0\n", 1, "'nan' is not finite"},
                    {"v 0 -Inf 0\n", 1, "'-Inf' is not finite"},
                    {"v 0 1e999 0\n", 1, "'1e999' is out of range"},
                    {"v 0 0 0 red\n", 1, "'red' is not a number"},
                    {"v 0 0 0\n# 2\nv 1 2\n", 3, "2 numbers"},
                    {"v\n", 1, "0 numbers"},
                    {"v 0 0 0 v 1 0 0\n", 1, "'v' is not a number"},
                    {"v 0 0 0 1 1\n", 1, "5 numbers"},
                    {v + "f 0 1 2\n", 4, "index 0 is out of range"},
                    {v + "f 1 2 4\nf 1 2 3\n", 4, "index 4 is out of range, expected at most 3"},
                    {v + "f 1 2 -4\n", 4, "index -4 is out of range, expected at least -3"},
                    {"f -1 -2 -3\n" + v, 1, "index -1 is out of range"},
                    {v + "f 1 2 3000000000\n", 4, "index 3000000000 is out of range"},
                    {v + "f 1 2 99999999999999999999\n", 4, "out of range"},
                    {v + "f 1 2 3.0\n", 4, "'3.0' is not an integer"},
                    {v + "f 1 2\n", 4, "no face has three or more corners"},
                    {v + "f\n", 4, "0 corners"},
                    {v + "f /1 /2 /3\n", 4, "'/1' lacks its vertex"},
                    {v + "f 1 2 3 /\n", 4, "'/' lacks its vertex"},
                    {v + "f 1/2/3/4 2 3\n", 4, "'1/2/3/4' has more than three indices"},
                    {v + "f 1/// 2 3\n", 4, "'1///' has more than three indices"},
                    {v + "f 1#2 2 3\n", 4, "'1#2' is not an integer"},
                    {"v 0 0 1#\n", 1, "'1#' is not a number"},
                    {"v 0 0 -1.#IND00\n", 1, "'-1.#IND00' is not finite"},
                    {"v 0 1.#QNAN 0\n", 1, "'1.#QNAN' is not finite"},
                    {"v -nan(ind) 1.#INF 0\n", 1, "'-nan(ind)' is not finite"},
                    {"v 0 0 1.#IX\n", 1, "is not finite"},
                    {v + "f 9 1\nf 1 2 0\n", 5, "index 0"},
                    {v + "f -4\nf 1 2 3\n", 4, "index -4 is out of range"},
                    {v + "f 1/a 2 3\n", 4, "'a' is not an integer"},
                    {v + "f 1 \\\n  2 \\\n  x\n", 4, "'x' is not an integer"},
                    {v + "face 1 2 3\n", 4, "unknown statement 'face'"},
                    {v + "call other.obj\nf 1 2 3\n", 4, "unknown statement 'call'"},
                    {v + "\x01\x02 1\n", 4, "unknown statement '?"},
                    {v, 0, "no faces"},
                    {"# nothing\n", 0, "no vertices"},
                    {" ", 0, "no vertices"},
                });
}

BOOST_AUTO_TEST_CASE(a_matrix_market_file_gives_its_matrix_with_both_triangles) {
  const Eigen::Matrix3d symmetric{{2.5, 0, -1e-3}, {0, 4, 0}, {-1e-3, 0, 0.125}};
  const Eigen::Matrix3d skew{{0, -1.5, 0}, {1.5, 0, 2}, {0, -2, 0}};
  const Eigen::Matrix<double, 2, 3> general{{1, 3, 5}, {2, 0, 6}};
  BOOST_TEST((matrix(symmetric_market) == symmetric));
  BOOST_TEST((matrix(with_crlf(symmetric_market)) == symmetric));
  BOOST_TEST((matrix(skew_market) == skew));
  BOOST_TEST((matrix("%%matrixmarket MATRIX Coordinate INTEGER General\n% comment\n\n2 3 5\n"
                     "2 3 6\n% comment\n1 1 1\n1 2 3\n\n2 1 2\n1 3 5") == general));
  BOOST_TEST((matrix("%%MatrixMarket matrix array double general\n2 3\n1\n2\n3\n0\n5\n6\n") == general));
  BOOST_TEST(
      (matrix("%%MatrixMarket matrix array real symmetric\n3 3\n2.5\n0\n-1e-3\n4\n0\n.125\n") == symmetric));
  BOOST_TEST((matrix("%%MatrixMarket matrix array real skew-symmetric\n3 3\n1.5\n0\n-2\n") == skew));
  BOOST_TEST((matrix("%%MatrixMarket matrix coordinate real general\n2 2 0\n") == Eigen::Matrix2d::Zero()));
}

BOOST_AUTO_TEST_CASE(every_malformed_matrix_market_file_is_refused_with_its_line) {
  const std::string general = "%%MatrixMarket matrix coordinate real general\n";
  const std::string symmetric = "%%MatrixMarket matrix coordinate real symmetric\n";
  const std::string array = "%%MatrixMarket matrix array real general\n";
  check_refused(
      read_matrix_as_is, ".mtx",
      {
          {"3 3 1\n1 1 1\n", 1, "no Matrix Market banner"},
          {"%%MatrixMarket matrix coordinate real\n1 1 0\n", 1, "banner is malformed"},
          {"%%MatrixMarket vector coordinate real general\n", 1, "banner is malformed"},
          {"%%MatrixMarket matrix sparse real general\n", 1, "unknown format 'sparse'"},
          {"%%MatrixMarket matrix coordinate floats general\n", 1, "unknown field 'floats'"},
          {"%%MatrixMarket matrix coordinate complex general\n", 1, "complex"},
          {"%%MatrixMarket matrix coordinate pattern symmetric\n", 1, "pattern"},
          {"%%MatrixMarket matrix coordinate complex hermitian\n", 1, "complex"},
          {"%%MatrixMarket matrix coordinate real hermitian\n", 1, "hermitian"},
          {"%%MatrixMarket matrix coordinate real diagonal\n", 1, "unknown symmetry 'diagonal'"},
          {general + "% only this\n", 2, "size line"},
          {general + "2 2\n1 1 1\n", 2, "size line of 2 words"},
          {general + "2 2 x\n", 2, "'x' is not an integer"},
          {general + "0 2 0\n", 2, "0 by 2"},
          {general + "2 -2 0\n", 2, "2 by -2"},
          {general + "2147483648 1 0\n", 2, "2147483648 by 1"},
          {symmetric + "2 3 1\n1 1 1\n", 2, "square"},
          {general + "2 2 -1\n", 2, "-1 entries"},
          {general + "2 2 2\n\n1 1 1\n% comment\n", 5, "ends after 1 entries, expected 2"},
          {general + "2 2 1\n1 1 1\n2 2 1\n", 4, "one more entry"},
          {general + "2 2 1\n1 1 1\nend\n", 4, "one more entry"},
          {general + "2 2 1\n1 1 1 1\n", 3, "4 words"},
          {general + "2 2 1\n1 1   \n", 3, "2 words"},
          {general + "2 2 1\n1 1 1.0D\n", 3, "'1.0D' is not a number"},
          {general + "2 2 1\n1 1 1%2\n", 3, "'1%2' is not a number"},
          {general + "2 2 1\n1 1 1.#IND\n", 3, "'1.#IND' is not finite"},
          {general + "2 2 1\n1 1 1D400\n", 3, "'1D400' is out of range"},
          {general + "2 2 1\n1 1 % 5\n", 3, "2 words"},
          {general + "2 2 1\n1 1 nan\n", 3, "'nan' is not finite"},
          {general + "2 2 1\n1 1 inf\n", 3, "'inf' is not finite"},
          {general + "2 2 1\n1.0 1 1\n", 3, "'1.0' is not an integer"},
          {general + "2 2 1\n0 1 1\n", 3, "(0, 1) lies outside"},
          {general + "2 2 1\n1 3 1\n", 3, "(1, 3) lies outside"},
          {general + "2 2 3\n2 1 1\n1 1 1\n2 1 5\n", 5, "(2, 1) after that of line 3"},
          {symmetric + "2 2 2\n1 2 1\n2 1 1\n", 4, "(2, 1) or its mirror image after that of line 3"},
          {replaced(skew_market, "2 1 1.5", "2 2 1.5"), 3, "(2, 2) lies on the diagonal"},
          {"%%MatrixMarket matrix coordinate integer general\n1 1 1\n1 1 1.5x\n", 3,
           "'1.5x' is not a number"},
          {array + "2 2 4\n1\n2\n3\n4\n", 2, "size line of 3 words"},
          {array + "2 2\n1\n2\n3\n %\n\n", 7, "ends after 3 entries, expected 4"},
          {array + "2 1\n1\n2\n3\n", 5, "one more entry"},
          {array + "2 1\n1 2\n", 3, "2 words"},
      });
  check_every_cut_is_refused(symmetric_market);
}

BOOST_AUTO_TEST_CASE(a_size_that_the_file_cannot_back_is_refused_before_anything_is_allocated) {
  const std::string general = "%%MatrixMarket matrix coordinate real general\n";
  check_refused(read_matrix_as_is, ".mtx",
                {
                    {general + "9 9 2000000000\n1 1 1\n", 2, "2000000000 entries, expected at most the 1 "},
                    {general + "9 9 9000000000000000000\n1 1 1\n", 2, "room"},
                    {general + "2000000000 2000000000 1\n1 1 1\n", 2, "2000000000 by 2000000000"},
                    {general + "5000000 5000000 1\n1 1 1\n", 2, "5000000 by 5000000"},
                    {"%%MatrixMarket matrix array real general\n2147483647 2147483647\n1\n", 2, "room"},
                    {"%%MatrixMarket matrix array real symmetric\n2147483647 2147483647\n1\n", 2, "room"},
                });
  check_refused(
      read_matrix_as_is, ".rsa",
      {
          {replaced(harwell_boeing(), "3             3", "2000000000    2000000000"), 3, "2000000000 rows"},
          {replaced(harwell_boeing(), "5             0", "2000000000    0"), 3, "2000000000 entries"},
          {replaced(harwell_boeing(), " 4             1", " 4 9000000000000000000"), 2,
           "9000000000000000000"},
      });
  // An almost empty damping matrix of a large system is no such file.
  BOOST_TEST(read_text(read_matrix_as_is, general + "1000000 1000000 1\n1000000 1000000 1\n").nonZeros() ==
             1);
}

BOOST_AUTO_TEST_CASE(a_harwell_boeing_file_gives_its_matrix_in_every_fortran_format) {
  const Eigen::Matrix3d& expected = harwell_boeing_matrix;
  BOOST_TEST((matrix(harwell_boeing()) == expected));
  BOOST_TEST((matrix(with_crlf(harwell_boeing("rsa"))) == expected));
  BOOST_TEST((matrix(harwell_boeing("RSA", "(4I3) (5I2) (1P,3D12.4)",
                                    "  4.0000D+00 -1.0000d+00  4.0000E+00\n -2.0000e+00  5.0000D+00\n")) ==
              expected));
  BOOST_TEST((matrix(harwell_boeing("RSA", "( 4I3 )(5i2)(1p3e12.4e3)",
                                    "  4.0000+000 -1.0000-000  0.0004+004\n -20.000-001  0.0500+002\n")) ==
              expected));
  BOOST_TEST((matrix(harwell_boeing("ISA", "(4I3) (5I2) (3I4)", "   4  -1   4\n  -2   5\n")) == expected));

  // Rutherford-Boeing has four numbers of lines; rows of a column come in any order; right-hand sides are
  // skipped.
  BOOST_TEST((matrix("skew\n 3 1 1 1\nrza 3 3 2 0\n(4I2) (2I2) (2F5.1)\n 1 2 3 3\n 2 3\n  1.5 -2.0\n") ==
              matrix(skew_market)));
  BOOST_TEST((matrix("general\n 4 1 1 1 1\nRUA 2 2 3 0\n(3I2) (3I2) (3F4.1) (2F4.1)\nF 1 0\n"
                     " 1 3 4\n 2 1 1\n 2.0 1.0 3.0\n 9.0 9.0\n") == Eigen::Matrix2d{{1, 3}, {2, 0}}));
}

BOOST_AUTO_TEST_CASE(every_malformed_harwell_boeing_file_is_refused_with_its_line) {
  const std::string good = harwell_boeing();
  const std::string right_hand_side =  // of which one line of two is there
      "general\n 5 1 1 1 2\nRUA 1 1 1 0\n(2I2) (1I2) (1F4.1) (1F4.1)\nF 1 0\n 1 2\n 1\n 1.0\n";
  const auto values = [](const std::string& text) {
    return harwell_boeing("RSA", "(4I3) (5I2) (1P,3E7.1)", text);
  };
  check_refused(
      read_matrix_as_is, ".rsa",
      {
          {"title\n", 1, "ends in its header"},
          {replaced(good, "4             1             1             2", "4 1 1"), 2, "3 numbers of lines"},
          {replaced(good, "             2\n", "             x\n"), 2, "'x' is not an integer"},
          {replaced(good, "             4  ", "             5  "), 2, "5 lines of data in total, expected 4"},
          {replaced(good, "1             1             2", "2             1             2"), 2,
           "2 lines of column pointers"},
          {replaced(good, "1             1             2", "1             0             2"), 2,
           "0 lines of row indices"},
          {replaced(good, "1             1             2", "1             1             1"), 2,
           "1 lines of values"},
          {harwell_boeing("RRA"), 3, "rectangular"},
          {harwell_boeing("PSA"), 3, "pattern"},
          {harwell_boeing("CSA"), 3, "complex"},
          {harwell_boeing("RSE"), 3, "elemental"},
          {harwell_boeing("RXA"), 3, "'RXA' is unknown"},
          {replaced(good, "3             3", "3             2"), 3, "3 by 2"},
          {replaced(good, "3             3", "0             0"), 3, "0 by 0"},
          {replaced(good, "3             3             5             0", "3"), 3, "1 numbers"},
          {replaced(good, "(4I3)", "(4F3)"), 4, "format '(4F3)'"},
          {replaced(good, "(3F7.1)", "(3A7,2X)"), 4, "format '(3A7,2X)'"},
          {replaced(good, "(3F7.1)", "(3(F7.1)"), 4, "format '(3(F7.1)'"},
          {replaced(good, "(3F7.1)", "(3F7.1,BZ)"), 4, "format '(3F7.1,BZ)'"},
          {replaced(good, "(3F7.1)", "(F7.1,(2X))"), 4, "format '(F7.1,(2X))'"},
          {replaced(good, "(3F7.1)", "(*)"), 4, "format '(*)'"},
          {replaced(good, "(3F7.1)", "(99(99(99(F7.1))))"), 4, "cannot use the format"},
          {replaced(good, "(3F7.1)", "(3F99999999999.1)"), 4, "cannot use the format"},
          {replaced(good, "(3F7.1)", ""), 4, "format ''"},
          {replaced(good, "  1  3  5  6", "  2  3  5  6"), 5, "pointer 1 is 2, expected 1"},
          {replaced(good, "  1  3  5  6", "  1  5  3  6"), 5, "pointer 3 is 3, expected 5 to 6"},
          {replaced(good, "  1  3  5  6", "  1  3  9  6"), 5, "pointer 3 is 9, expected 3 to 6"},
          {replaced(good, "  1  3  5  6", "  1  3  5  5"), 5, "pointer 4 is 5, expected 6"},
          {replaced(good, "  1  3  5  6", " 1 3 5 6"), 5, "'3 5' is not an integer"},
          {replaced(good, "  1  3  5  6", "  1  3  5"), 5, "blank field"},
          {replaced(good, "  1  3  5  6", "  1  3  5  6  6"), 5, "behind the last"},
          {replaced(good, " 1 2 2 3 3", " 1 4 2 3 3"), 6, "(4, 1) lies outside"},
          {replaced(good, " 1 2 2 3 3", " 0 2 2 3 3"), 6, "(0, 1) lies outside"},
          {replaced(good, " 1 2 2 3 3", " 1 2 1 3 3"), 6, "a second entry (2, 1) or its mirror image"},
          {replaced(good, " 1 2 2 3 3", " 2 2 2 3 3"), 6, "a second entry (2, 1)"},
          {harwell_boeing("RZA"), 6, "(1, 1) lies on the diagonal"},
          {replaced(good, "    5.0", "    5,0"), 8, "'5,0' is not a number"},
          {replaced(good, "    5.0", "    NaN"), 8, "is not finite"},
          {replaced(good, "    5.0", "      5"), 8, "'5' has no decimal point"},
          {replaced(good, "    5.0", "       "), 8, "blank field"},
          {replaced(good, "-1.0    4.0", "-1.0    4.0 1"), 7, "behind the last field"},
          {replaced(values(" 4.0E+0 -1.0+0    4.0\n -2.0D0   5.0D0\n"), "3E7.1", "3G7.1"), 7,
           "'4.0' has no exponent"},
          {values(" 4.0E+0 -1.0+0  4.0E0\n -2.0D0   5.0D\n"), 8, "is not a number"},
          {good + "\n 1.0\n", 10, "after the matrix"},
          {right_hand_side + " 9.0\n", 9, "ends in its right-hand sides"},
      });
  check_every_cut_is_refused(good);
}

// Too small for double precision is 0, as everywhere in IEEE arithmetic; too large is no number of ours.
BOOST_AUTO_TEST_CASE(a_number_below_double_precision_is_zero_and_one_above_is_refused) {
  const springstab::Location at{"file", 1};
  const std::string zeros(400, '0');
  for (const std::string& tiny :
       {std::string("1e-400"), std::string("-9.9E-325"), std::string("0.5e-399"), "." + zeros + "1",
        "0." + zeros + "12e0", "1" + zeros + "e-800", std::string("1e-99999999999999999999"),
        std::string("2e-324"), std::string("+1e-400")}) {
    const double value = at.real(tiny);
    BOOST_TEST(value == 0, tiny);
    BOOST_TEST(std::signbit(value) == tiny.starts_with('-'), tiny);
  }
  BOOST_TEST(at.real("5e-324") == 0x1p-1074);
  BOOST_TEST(at.real("1e-310") == 1e-310);
  BOOST_TEST(at.real("0e99999") == 0);
  BOOST_TEST(at.real("1" + zeros + "e-400") == 1);
  for (const std::string& huge : {std::string("1e309"), "1" + zeros, std::string("0.01e320"),
                                  "." + zeros + "1e800", std::string("-1e99999999999999999999")})
    BOOST_CHECK_THROW(at.real(huge), InputError);
  for (const char* no_number :
       {"",    "+",     "-",        "1e",     "1e+",      "e5",       "1.2.3",   "1#",    "#1",
        "1%",  "1_000", "0x1p3",    "1f",     "1d0",      "--1",      "+-1",     "1e5.0", "nan",
        "NaN", "-inf",  "Infinity", "1.#IND", "-1.#QNAN", "1.#INF00", "nan(0x1)"})
    BOOST_CHECK_THROW(at.real(no_number), InputError);
  for (const char* no_integer : {"", "1.0", "1e3", "1#", "0x1", "1/", "+-1", "99999999999999999999"})
    BOOST_CHECK_THROW(at.integer(no_integer), InputError);
}

BOOST_AUTO_TEST_CASE(exponents_are_what_fortran_makes_of_them) {
  const springstab::Location at{"file", 1};
  for (const char* word :
       {"-1.25e3", "-1.25E+03", "-1.25D3", "-1.25d+3", "-1.25q3", "-1.25+3", "-1.25+003", "-1250"})
    BOOST_TEST(at.fortran_real(word) == -1250, word);
  BOOST_TEST(at.fortran_real("2.5-103") == 2.5e-103);
  BOOST_TEST(at.fortran_real("1D-400") == 0);
  for (const char* word : {"1D", "1DD1", "D1", "1D400", "1E5D", "1-", "inf", "1.#QNAN", "1D1.5"})
    BOOST_CHECK_THROW(at.fortran_real(word), InputError);
}

// What is not a cloth's is left out, and the file is told from: one note for each kind of thing.
BOOST_AUTO_TEST_CASE(an_obj_file_is_read_with_all_that_other_programs_write) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const struct {
    std::string text;
    std::vector<std::pair<long, std::string>> notes;
  } cases[] = {
      {v + "f 1// 2// 3// 4//\n", {}},
      {v + "f 1/ 2/ 3/ 4/\n", {}},
      {v + "vn 0 0 1\nf 1//1 2//-1 3//1 4//1 # a note\n", {}},
      {v + "vt 0 0\nvt 1 0\nf 1/1/ 2/2/ 3/2/ 4/1/\n", {}},
      {v + "f 1/0/0 2/0/0 3/0/0 4/0/0\n", {}},
      {v + "f 1/1/1 2/2/1 3/3/1 4/4/1\n", {{5, "texture coordinates are named, but the file has none"}}},
      {v + "f -4/-1 -3/-2 -2/-3 -1/-4\n", {{5, "texture coordinates are named, but the file has none"}}},
      {v + "vt nan nan\nvt inf 0\nvt 0 1.#IND\nf 1/1 2/2 3/3 4/1\n",
       {{5, "3 texture coordinates are no numbers"}}},
      {v + "vt 0 -nan(ind)\nvt 0 0\nf 1/2 2/2 3/2 4/2\n", {{5, "no texture coordinates are used"}}},
      {"v 0 0 0 nan nan nan\nv 1 0 0 1\nv 1 1 0 1 0.5 0.5 0.5\nv 0 1 0 -inf\nf 1 2 3 4\n",
       {{1, "2 vertices have a weight or colour that is no number"}}},
      {v + "l 1 2 3 4\nf 1\nf 2 3\nf 1 2 3 4\nl 1 2\n",
       {{6, "2 faces of one or two corners are dropped"}, {5, "2 statements 'l' are not used"}}},
      {v + "f 1 2 3 4\nt crease 2/1/0 1 2 4.7\nvw 1 0.5\n",
       {{6, "the statement 't' is not used"}, {7, "the statement 'vw' is not used"}}},
      {v + "p 1 2\nvp 0.5 0.5\ncstype bezier\ndeg 3\ncurv 0 1 1 2 3 4\nparm u 0 1\nend\nf 1 2 3 4\n",
       {{5, "'p'"},
        {6, "'vp'"},
        {7, "'cstype'"},
        {8, "'deg'"},
        {9, "'curv'"},
        {10, "'parm'"},
        {11, "'end'"}}},
      {"mtllib a#b.mtl \\\n c.mtl\no\ng\ng a b\ns off\nusemtl\n" + v + "f 1 \\ \n 2 \\\r\n 3 4\n", {}},
  };
  for (const auto& c : cases) BOOST_TEST_CONTEXT(c.text) {
      const Mesh mesh = obj(c.text);
      BOOST_TEST(mesh.vertices.size() == 4U);
      BOOST_TEST((mesh.vertices[2] == Eigen::Vector3d(1, 1, 0)));
      BOOST_TEST(mesh.face_vertices == (std::vector<int>{0, 1, 2, 3}), boost::test_tools::per_element());
      BOOST_REQUIRE_EQUAL(mesh.notes.size(), c.notes.size());
      for (const auto& [line, text] : c.notes)
        BOOST_TEST(std::ranges::any_of(mesh.notes,
                                       [&, at = line, words = text](const springstab::FileNote& note) {
                                         return note.line == at && note.text.find(words) != note.text.npos;
                                       }),
                   text);
      BOOST_TEST(mesh.corner_uv.size() == (c.text.find("vt 1 0") != c.text.npos ? 4U : 0U));
    }
}

BOOST_AUTO_TEST_CASE(a_matrix_market_file_is_read_with_all_that_other_programs_write) {
  const Eigen::Matrix2d expected{{2, -1}, {-1, 2}};
  const std::string symmetric = "%%MatrixMarket matrix coordinate real symmetric\n";
  const std::string entries = "2 2 3\n1 1 2\n2 1 -1\n2 2 2\n";
  for (const std::string& text : std::vector<std::string>{
           symmetric + "2 2 3\n1 1 0.2D+01\n2 1 -1.0d0\n2 2 20.0-1\n",
           symmetric + "2 2 3 % size\n1 1 2 % note\n\n  % row two\n2 1 -1 %\n2 2 2\n%\n",
           symmetric + "2 2 3\n1 1 2\n1 2 -1\n2 2 2\n",  // the upper triangle
           "%%MatrixMarket matrix coordinate float symmetric\n" + entries,
           "%%MatrixMarket matrix coordinate double symmetric\n" + entries,
           "%%MatrixMarket matrix coordinate integer symmetric\n2 2 3\n1 1 2.0\n2 1 -1.0\n2 2 2.0\n",
           "%%MatrixMarket matrix coordinate unsigned-integer general\n2 2 4\n1 1 2\n2 2 2\n1 2 -1\n2 1 -1\n",
           "\n  %%matrixmarket  MATRIX Array INTEGER Symmetric % lower\n\n2 2\n2\n-1e0\n2 % end\n\n",
       }) {
    BOOST_TEST((matrix(text) == expected), text);
    BOOST_TEST((matrix(with_line_ends(text, "\r")) == expected), text);
    BOOST_TEST((matrix(with_line_ends("\xEF\xBB\xBF" + text, "\r\n")) == expected), text);
  }
  BOOST_TEST((matrix("%%MatrixMarket matrix coordinate integer general\n1 1 1\n1 1 1.5\n")(0, 0) == 1.5));
  BOOST_TEST((matrix(symmetric + "2 2 3\n1 1 2\n2 1 1e-400\n2 2 2\n") == 2 * Eigen::Matrix2d::Identity()));
  BOOST_TEST(
      (matrix("%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 3\n1 1 0\n1 2 -1\n2 2 0.0\n") ==
       Eigen::Matrix2d{{0, -1}, {1, 0}}));
}

BOOST_AUTO_TEST_CASE(rows_of_a_matrix_are_those_of_the_whole) {
  const std::string entries = "4 4 5\n1 1 2\n3 1 -1\n3 2 7\n4 3 0.5\n4 1 6\n";
  for (const char* kind : {"coordinate real general", "coordinate real symmetric"}) {
    const std::string text = std::string("%%MatrixMarket matrix ") + kind + "\n" + entries;
    const Eigen::MatrixXd whole = matrix(text);
    for (long first = 0; first <= 4; ++first)
      for (long last = first; last <= 4; ++last) {
        const auto rows = springstab::parse_matrix_market_rows("file", text, [&](int all) {
          BOOST_TEST(all == 4);
          return springstab::IndexRange{first, last};
        });
        BOOST_TEST(rows.first == first);
        BOOST_TEST(rows.all_rows == 4);
        BOOST_TEST(rows.columns == 4);
        BOOST_TEST((rows.own.toDense() == whole.middleRows(first, last - first)));
      }
  }
}

BOOST_AUTO_TEST_CASE(entries_at_one_position_are_summed_where_that_is_asked) {
  using springstab::Duplicates;
  const std::string general =
      "%%MatrixMarket matrix coordinate real general\n2 2 6\n1 1 1\n1 1 1\n1 2 -1\n2 1 -1\n2 2 1\n2 2 0.5\n";
  const std::string symmetric =
      "%%MatrixMarket matrix coordinate real symmetric\n2 2 4\n1 1 2\n1 2 -1\n2 1 -3\n2 2 2\n";
  const auto summed = [](const std::string& text) {
    return springstab::parse_matrix_market("file", text, Duplicates::summed).toDense();
  };
  BOOST_TEST((summed(general) == Eigen::Matrix2d{{2, -1}, {-1, 1.5}}));
  BOOST_TEST((summed(symmetric) == Eigen::Matrix2d{{2, -4}, {-4, 2}}));
  BOOST_TEST((summed(replaced(replaced(replaced(symmetric, "symm", "skew-symm"), "1 1 2", "1 1 0"), "2 2 2\n",
                              "2 2 0\n")) == Eigen::Matrix2d{{0, 2}, {-2, 0}}));
  BOOST_TEST((summed(symmetric_market) == matrix(symmetric_market)));
  BOOST_CHECK_EXCEPTION(summed(replaced(replaced(general, "2 2 1\n", "2 2 1e308\n"), "0.5", "1e308")),
                        InputError, [](const InputError& error) {
                          return std::string(error.what()).find("file:8: a second entry (2, 2)") == 0;
                        });
  check_refused(read_matrix_as_is, ".mtx",
                {{general, 4, "line 3, expected one entry per position (--sum-duplicates adds them up)"},
                 {symmetric, 5, "(2, 1) or its mirror image after that of line 4"}});
  const std::string boeing = replaced(harwell_boeing(), " 1 2 2 3 3", " 1 1 2 3 3");
  BOOST_CHECK_THROW(springstab::parse_harwell_boeing("file", boeing), InputError);
  BOOST_TEST((springstab::parse_harwell_boeing("file", boeing, Duplicates::summed).toDense() ==
              Eigen::Matrix3d{{3, 0, 0}, {0, 4, -2}, {0, -2, 5}}));
}

/// [4 -1 0; -1 4 -2; 0 -2 5] with these formats of pointers, indices and values, and these lines of them.
Eigen::MatrixXd boeing(const std::string& formats, const std::vector<std::string>& pointers,
                       const std::vector<std::string>& indices, const std::vector<std::string>& values) {
  std::string text = "title\n", body;
  for (const auto& lines : {pointers, indices, values})
    for (const std::string& line : lines) body += line + "\n";
  const auto count = [](const std::vector<std::string>& lines) { return " " + std::to_string(lines.size()); };
  text += " " + std::to_string(pointers.size() + indices.size() + values.size()) + count(pointers) +
          count(indices) + count(values) + " 0\nRSA 3 3 5 0\n" + formats + "\n" + body;
  return matrix(text);
}

// Each value field as ISO/IEC 1539-1 reads it.
BOOST_AUTO_TEST_CASE(fortran_formats_are_what_a_read_makes_of_them) {
  const std::vector<std::string> pointers{"  1  3  5  6"}, indices{" 1 2 2 3 3"};
  const auto read = [&](const std::string& format, const std::vector<std::string>& values) {
    return boeing("(4I3) (5I2) " + format, pointers, indices, values);
  };
  const Eigen::Matrix3d& expected = harwell_boeing_matrix;
  const std::vector<std::string> e12{"  4.0000E+00 -1.0000E+00  4.0000E+00", " -2.0000E+00  5.0000E+00"};
  for (const char* format : {"(3E12.4)",
                             "(1P3E12.4)",
                             "(1p,3e12.4)",
                             "(3(1P,E12.4))",
                             "(3(E12.4))",
                             "(1P3D12.4)",
                             "(3ES12.4)",
                             "(3EN12.4E2)",
                             "(3G12.4)",
                             "(1P3G12.4E2)",
                             "(3F12.4)",
                             "(3E12)",
                             "(3D12)",
                             "(2E12.4,E12.4)",
                             "(E12.4,2(E12.4))",
                             "(1(3(E12.4)))",
                             "(E12.4,E12.4,E12.4)",
                             "(-2P3E12.4)",
                             "(SP,3E12.4)",
                             "(BN,3E12.4:)",
                             "(T1,E12.4,T13,2E12.4)",
                             "(T25,TL24,3E12.4)",
                             "( 3 E 12 . 4 )"})
    BOOST_TEST((read(format, e12) == expected), format);
  BOOST_TEST((read("(1X,3E12.4)", {"x" + e12[0], " " + e12[1]}) == expected));
  BOOST_TEST((read("(3(2X,E12.4))", {"    4.0000E+00   -1.0000E+00    4.0000E+00",
                                     "   -2.0000E+00    5.0000E+00"}) == expected));
  // a new line at a slash; what is repeated is the last group, with its count
  BOOST_TEST((read("(3F5.1/2F5.1)", {"  4.0 -1.0  4.0", " -2.0  5.0"}) == expected));
  BOOST_TEST((read("(F5.1,(2F5.1))", {"  4.0 -1.0  4.0", " -2.0  5.0"}) == expected));
  BOOST_TEST((read("(F5.1,2(F4.0))", {"  4.0 -1.  4.", " -2.  5."}) == expected));
  BOOST_TEST((read("(2F5.1,/)", {"  4.0 -1.0", "", "  4.0 -2.0", "", "  5.0"}) == expected));
  // a scale factor divides where there is no exponent, and stays in force
  BOOST_TEST((read("(1P3F7.1)", {"   40.0  -10.0   40.0", "  -20.0   50.0"}) == expected));
  BOOST_TEST((read("(F7.1,2PF7.1,E7.1)", {"    4.0 -100.0 4.0E+0", " -200.0  500.0"}) == expected));
  BOOST_TEST((read("(-1P3F7.1)", {"     .4    -.1     .4", "    -.2     .5"}) == expected));
  BOOST_TEST((read("(1P,2F6.1,0P,F6.1)", {"  40.0 -10.0   4.0", " -20.0  50.0"}) == expected));
  // a zero is one in every format
  Eigen::Matrix3d with_zeros = expected;
  with_zeros(1, 0) = with_zeros(0, 1) = with_zeros(1, 1) = 0;
  for (const char* zero :
       {"        0.0", "       -0.0", "          0", "         .0", "         0.", " 0.0000E+00"})
    BOOST_TEST((read("(1P3D12.4)", {"  4.0000D+00 " + std::string(zero) + " " + zero, e12[1]}) == with_zeros),
               zero);
  // exponents: any letter, none, a blank for the plus
  BOOST_TEST(
      (read("(3E12.4)", {" 4.0000Q+000 -0.1000D 01  0.4000+001", "-20.000E- 1  .000005E 06"}) == expected));
  BOOST_TEST((boeing("(2I4,I4) (1X,2I3) (5F5.1)", {"   1   3   5", "   6"}, {"   1  2", "   2  3", "   3"},
                     {"  4.0 -1.0  4.0 -2.0  5.0"}) == expected));
  // where programs do not agree on the meaning
  for (const auto& [format, field] : {std::pair("(5F7.1)", "     40"),
                                      {"(1P5G7.1)", "   40.0"},
                                      {"(5E7.1)", "   4E+0"},
                                      {"(5F7.1)", "    4 0"},
                                      {"(5F7.1)", "       "},
                                      {"(5F7.1)", "  4.0.0"}})
    BOOST_CHECK_THROW(read(format, {std::string(field) + "   -1.0    4.0   -2.0    5.0"}), InputError);
}

// The inputs of ../shared/data/FAULTS.md that a reader was at fault with.
BOOST_AUTO_TEST_CASE(files_that_were_read_wrongly_or_refused) {
  const auto directory = springstab::test::shared_data("faults");
  if (!directory) return;
  const auto path = [&](const std::string& name) { return (*directory / name).string(); };
  const Eigen::Matrix2d chain{{2, -1}, {-1, 2}};
  for (const char* name :
       {"dexp.mtx", "float.mtx", "intfloat.mtx", "midcomment.mtx", "cr.mtx", "upper.mtx", "mmjl4.rsa"})
    BOOST_TEST((read_matrix(path(name)).toDense() == chain), name);
  for (const char* name : {"tiny.mtx", "arc130.rsa"})
    BOOST_TEST((read_matrix(path(name)).toDense() == 2 * Eigen::Matrix2d::Identity()), name);
  BOOST_TEST((read_matrix(path("skew_zero_diag.mtx")).toDense() == Eigen::Matrix2d{{0, -1}, {1, 0}}));
  BOOST_CHECK_THROW(read_matrix(path("dup.mtx")), InputError);
  BOOST_CHECK_THROW(read_matrix(path("both.mtx")), InputError);
  BOOST_TEST((read_matrix(path("dup.mtx"), springstab::Duplicates::summed).toDense() == chain));
  BOOST_TEST((read_matrix(path("both.mtx"), springstab::Duplicates::summed).toDense() ==
              Eigen::Matrix2d{{2, -2}, {-2, 2}}));
  for (const auto& [name, notes] : {std::pair("underflow.obj", 0),
                                    {"wings391.obj", 0},
                                    {"trimesh808.obj", 0},
                                    {"trimesh1079.obj", 1},
                                    {"assimp2428.obj", 1},
                                    {"nancolor.obj", 1},
                                    {"three9204.obj", 2},
                                    {"opensubdiv.obj", 1}}) {
    const Mesh mesh = read_obj(path(name));
    BOOST_TEST(mesh.vertices.size() == 4U, name);
    BOOST_TEST(mesh.faces() == 1, name);
    BOOST_TEST((mesh.vertices[0] == Eigen::Vector3d::Zero()), name);
    BOOST_TEST(static_cast<int>(mesh.notes.size()) == notes, name);
  }
  BOOST_CHECK_EXCEPTION(
      read_obj(path("obj_ind_read_as_minus1.obj")), InputError, [](const InputError& error) {
        return std::string(error.what()).find("obj:3: '-1.#IND00' is not finite") != std::string::npos;
      });
}

BOOST_AUTO_TEST_CASE(a_file_of_no_known_format_is_refused) {
  for (const std::string suffix : {"", ".txt", ".obj"})
    check_refused(read_matrix_as_is, suffix,
                  {{"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 1, "neither"}, {"1 2\n3 4\n", 1, "neither"}});
  check_refused(read_matrix_as_is, ".MTX", {{"1 2\n3 4\n", 1, "no Matrix Market banner"}});
  check_refused(read_matrix_as_is, ".rb", {{"1 2\n3 4\n", 2, "2 numbers of lines"}});
}

BOOST_AUTO_TEST_CASE(every_beginning_of_every_seed_reads_or_is_refused_with_a_line) {
  for (const springstab::test::Reader& reader : springstab::test::readers()) {
    long read = 0, refused = 0;
    for (const auto& seed : std::filesystem::directory_iterator(springstab::test::source_folder() +
                                                                "/tests/fuzz/corpus/" + reader.name)) {
      BOOST_TEST_CONTEXT(seed.path()) {
        const std::string text = content_of(seed.path());
        for (std::size_t length = 0; length < text.size(); ++length)
          BOOST_REQUIRE_NO_THROW(++(reads(reader, text.substr(0, length)) ? read : refused));
        const bool whole = reads(reader, text);
        ++(whole ? read : refused);
        if (text.find('\0') != text.npos) continue;  // no text, of which the following is true
        BOOST_TEST(reads(reader, with_crlf(text)) == whole);
        if (text.find('\r') == text.npos) BOOST_TEST(reads(reader, with_line_ends(text, "\r")) == whole);
        BOOST_TEST(reads(reader, "\xEF\xBB\xBF" + text) == whole);
        if (reader.name != "scene") BOOST_TEST(reads(reader, text + "\x1a") == whole);
      }
    }
    BOOST_TEST_CONTEXT(reader.name) {
      BOOST_TEST(read > 2);
      BOOST_TEST(refused > 100);
    }
  }
}

BOOST_AUTO_TEST_CASE(what_is_read_does_not_depend_on_the_locale) {
  struct DecimalComma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  const double x = obj("v 0.5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").vertices[0].x();
  const Eigen::MatrixXd k = matrix(symmetric_market);
  std::locale::global(before);
  BOOST_TEST(x == 0.5);
  BOOST_TEST(k(0, 0) == 2.5);
}

BOOST_AUTO_TEST_CASE(one_matrix_in_three_formats_is_one_matrix) {
  const auto directory = springstab::test::shared_data("matrices");
  if (!directory) return;
  const auto read = [&](const std::string& name) { return read_matrix((*directory / name).string()); };
  const Eigen::MatrixXd market = read("bcsstk01.mtx").toDense();
  BOOST_TEST(market.rows() == 48);
  BOOST_TEST((market == market.transpose()));
  BOOST_TEST(read("bcsstk01.mtx").nonZeros() == 2 * 224 - 48);
  BOOST_TEST((read("bcsstk01.rsa").toDense() == market));
  BOOST_TEST((read("bcsstk01.rb").toDense() == market));
  BOOST_TEST((read("bcsstk02.rsa").toDense() == read("bcsstk02.mtx").toDense()));
}

BOOST_AUTO_TEST_CASE(meshes_of_other_programs_have_their_published_counts) {
  struct Published {
    std::string name;
    std::size_t vertices;
    int faces;
  };
  for (const auto& [name, vertices, faces] : {Published{"pbd_plane_30x30.obj", 961, 1800},
                                              {"cipc_skirt16x64.obj", 1024, 1920},
                                              {"vega_bend2_quads.obj", 55, 40},
                                              {"sofa_frog_eyes.obj", 532, 1056},
                                              {"gc_fan3.obj", 5, 3},
                                              {"sofa_collision_no_face.obj", 466, 196}})
    if (const auto path = springstab::test::shared_data("meshes/" + name)) BOOST_TEST_CONTEXT(name) {
        const Mesh mesh = read_obj(path->string());
        BOOST_TEST(mesh.vertices.size() == vertices);
        BOOST_TEST(mesh.faces() == faces);
      }
}

BOOST_AUTO_TEST_SUITE_END()
