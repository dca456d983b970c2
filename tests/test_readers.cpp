// The readers of meshes and matrices: what a file says is what is read, and what is not exactly right is
// refused with its line.
#include <Eigen/Core>
#include <boost/test/unit_test.hpp>
#include <filesystem>
#include <fstream>
#include <locale>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "solvers/io/input_error.h"
#include "solvers/io/matrix_file.h"
#include "solvers/io/obj.h"
#include "solvers/io/text_file.h"
#include "tests/fuzz/readers.h"
#include "tests/shared_data.h"

BOOST_AUTO_TEST_SUITE(readers)

using springstab::InputError;
using springstab::Mesh;
using springstab::read_matrix;
using springstab::read_obj;

namespace {

/// A path that nothing else has; what is there is removed at the end.
class TemporaryPath {
 public:
  explicit TemporaryPath(const std::string& suffix = "")
      : path_(std::filesystem::temp_directory_path() /
              ("springstab_readers_" + std::to_string(std::random_device{}()) + suffix)) {}
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;
  ~TemporaryPath() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string name() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

template <class Read>
auto read_text(const Read& read, const std::string& text, const std::string& suffix = "") {
  const TemporaryPath file(suffix);
  std::ofstream(file.name(), std::ios::binary) << text;
  return read(file.name());
}

Mesh obj(const std::string& text) { return read_text(read_obj, text); }

Eigen::MatrixXd matrix(const std::string& text) { return read_text(read_matrix, text).toDense(); }

std::string contents(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// A file that must be refused: in which line, and with which words.
struct Malformed {
  std::string text;
  long line;  // 0: no line applies
  std::string message;
};

template <class Read>
void check_refused(const Read& read, const std::string& suffix, const std::vector<Malformed>& cases) {
  for (const Malformed& wrong : cases) BOOST_TEST_CONTEXT("the file\n" << wrong.text) {
      const TemporaryPath file(suffix);
      std::ofstream(file.name(), std::ios::binary) << wrong.text;
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
      BOOST_CHECK_THROW(read_text(read_matrix, cut, ".mtx"), InputError);
    }
  }
}

std::string with_crlf(const std::string& text) {
  std::string crlf;
  for (const char c : text) crlf += c == '\n' ? "\r\n" : std::string(1, c);
  return crlf;
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

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  BOOST_REQUIRE(at != text.npos);
  return text.replace(at, what.size(), by);
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_file_that_cannot_be_read_is_refused_by_name_and_reason) {
  const TemporaryPath missing, directory, empty;
  std::filesystem::create_directory(directory.name());
  std::ofstream(empty.name()).close();
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
    BOOST_CHECK_EXCEPTION(read(missing.name()), InputError, refused(missing.name(), "No such file"));
    BOOST_CHECK_EXCEPTION(read(directory.name()), InputError, refused(directory.name(), "Is a directory"));
    BOOST_CHECK_EXCEPTION(read(empty.name()), InputError, refused(empty.name(), "empty"));
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
    const Mesh mesh = obj(variant);
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
    BOOST_TEST(mesh.source.find("springstab_readers_") != mesh.source.npos);
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
                    {v + "f 1 2\n", 4, "2 corners"},
                    {v + "f\n", 4, "0 corners"},
                    {v + "f 1/ 2/ 3/\n", 4, "'1/' lacks an index"},
                    {v + "f /1 /2 /3\n", 4, "'/1' lacks an index"},
                    {v + "f 1// 2// 3//\n", 4, "'1//' lacks an index"},
                    {v + "f 1/2/3/4 2 3\n", 4, "'3/4' is not an integer"},
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
      read_matrix, ".mtx",
      {
          {"3 3 1\n1 1 1\n", 1, "no Matrix Market banner"},
          {"%%MatrixMarket matrix coordinate real\n1 1 0\n", 1, "banner is malformed"},
          {"%%MatrixMarket vector coordinate real general\n", 1, "banner is malformed"},
          {"%%MatrixMarket matrix sparse real general\n", 1, "unknown format 'sparse'"},
          {"%%MatrixMarket matrix coordinate float general\n", 1, "unknown field 'float'"},
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
          {general + "2 2 1\n1 1 1.0D0\n", 3, "'1.0D0' is not a number"},
          {general + "2 2 1\n1 1 nan\n", 3, "'nan' is not finite"},
          {general + "2 2 1\n1 1 inf\n", 3, "'inf' is not finite"},
          {general + "2 2 1\n1.0 1 1\n", 3, "'1.0' is not an integer"},
          {general + "2 2 1\n0 1 1\n", 3, "(0, 1) lies outside"},
          {general + "2 2 1\n1 3 1\n", 3, "(1, 3) lies outside"},
          {general + "2 2 3\n2 1 1\n1 1 1\n2 1 5\n", 5, "(2, 1) after that of line 3"},
          {symmetric + "2 2 1\n1 2 1\n", 3, "(1, 2) lies above the diagonal"},
          {replaced(skew_market, "2 1 1.5", "2 2 1.5"), 3, "(2, 2) does not lie below the diagonal"},
          {"%%MatrixMarket matrix coordinate integer general\n1 1 1\n1 1 1.5\n", 3,
           "'1.5' is not an integer"},
          {array + "2 2 4\n1\n2\n3\n4\n", 2, "size line of 3 words"},
          {array + "2 2\n1\n2\n3\n %\n\n", 7, "ends after 3 entries, expected 4"},
          {array + "2 1\n1\n2\n3\n", 5, "one more entry"},
          {array + "2 1\n1 2\n", 3, "2 words"},
      });
  check_every_cut_is_refused(symmetric_market);
}

BOOST_AUTO_TEST_CASE(a_size_that_the_file_cannot_back_is_refused_before_anything_is_allocated) {
  const std::string general = "%%MatrixMarket matrix coordinate real general\n";
  check_refused(read_matrix, ".mtx",
                {
                    {general + "9 9 2000000000\n1 1 1\n", 2, "2000000000 entries, expected at most the 1 "},
                    {general + "9 9 9000000000000000000\n1 1 1\n", 2, "room"},
                    {general + "2000000000 2000000000 1\n1 1 1\n", 2, "2000000000 by 2000000000"},
                    {general + "5000000 5000000 1\n1 1 1\n", 2, "5000000 by 5000000"},
                    {"%%MatrixMarket matrix array real general\n2147483647 2147483647\n1\n", 2, "room"},
                    {"%%MatrixMarket matrix array real symmetric\n2147483647 2147483647\n1\n", 2, "room"},
                });
  check_refused(
      read_matrix, ".rsa",
      {
          {replaced(harwell_boeing(), "3             3", "2000000000    2000000000"), 3, "2000000000 rows"},
          {replaced(harwell_boeing(), "5             0", "2000000000    0"), 3, "2000000000 entries"},
          {replaced(harwell_boeing(), " 4             1", " 4 9000000000000000000"), 2,
           "9000000000000000000"},
      });
  // An almost empty damping matrix of a large system is no such file.
  BOOST_TEST(read_text(read_matrix, general + "1000000 1000000 1\n1000000 1000000 1\n").nonZeros() == 1);
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
      read_matrix, ".rsa",
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
          {replaced(good, "(3F7.1)", "(3F7.1,2X)"), 4, "format '(3F7.1,2X)'"},
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
          {replaced(good, " 1 2 2 3 3", " 1 2 1 3 3"), 6, "(1, 2) lies above the diagonal"},
          {replaced(good, " 1 2 2 3 3", " 2 2 2 3 3"), 6, "a second entry (2, 1)"},
          {harwell_boeing("RZA"), 6, "(1, 1) does not lie below the diagonal"},
          {replaced(good, "    5.0", "    5,0"), 8, "'5,0' is not a number"},
          {replaced(good, "    5.0", "    NaN"), 8, "is not finite"},
          {replaced(good, "    5.0", "      5"), 8, "'5' has no decimal point"},
          {replaced(good, "    5.0", "       "), 8, "blank field"},
          {replaced(good, "-1.0    4.0", "-1.0    4.0 1"), 7, "behind the last field"},
          {values(" 4.0E+0 -1.0+0    4.0\n -2.0D0   5.0D0\n"), 7, "'4.0' has no exponent"},
          {values(" 4.0E+0 -1.0+0  4.0E0\n -2.0D0   5.0D\n"), 8, "is not a number"},
          {good + "\n 1.0\n", 10, "after the matrix"},
          {right_hand_side + " 9.0\n", 9, "ends in its right-hand sides"},
      });
  check_every_cut_is_refused(good);
}

BOOST_AUTO_TEST_CASE(a_file_of_no_known_format_is_refused) {
  for (const std::string suffix : {"", ".txt", ".obj"})
    check_refused(read_matrix, suffix,
                  {{"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 1, "neither"}, {"1 2\n3 4\n", 1, "neither"}});
  check_refused(read_matrix, ".MTX", {{"1 2\n3 4\n", 1, "no Matrix Market banner"}});
  check_refused(read_matrix, ".rb", {{"1 2\n3 4\n", 2, "2 numbers of lines"}});
}

BOOST_AUTO_TEST_CASE(every_beginning_of_every_seed_reads_or_is_refused_with_a_line) {
  for (const springstab::test::Reader& reader : springstab::test::readers()) {
    long read = 0, refused = 0;
    for (const auto& seed :
         std::filesystem::directory_iterator(SPRINGSTAB_SOURCE_DIR "/tests/fuzz/corpus/" + reader.name)) {
      BOOST_TEST_CONTEXT(seed.path()) {
        const std::string text = contents(seed.path());
        for (std::size_t length = 0; length < text.size(); ++length)
          BOOST_REQUIRE_NO_THROW(++(reads(reader, text.substr(0, length)) ? read : refused));
        const bool whole = reads(reader, text);
        BOOST_TEST(reads(reader, with_crlf(text)) == whole);
        BOOST_TEST(reads(reader, "\xEF\xBB\xBF" + text) == whole);
        ++(whole ? read : refused);
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
