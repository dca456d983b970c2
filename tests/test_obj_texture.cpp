// Texture coordinates in OBJ files: which corner has which, when a mesh has none, and what is refused.
#include <boost/test/unit_test.hpp>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "solvers/io/input_error.h"
#include "solvers/io/obj.h"
#include "tests/shared_data.h"

using Eigen::Vector2d;
using springstab::InputError;
using springstab::Mesh;

namespace {

/// An OBJ file of this text; removed at the end.
class File {
 public:
  explicit File(const std::string& text)
      : path_(std::filesystem::temp_directory_path() /
              ("springstab_texture_" + std::to_string(std::random_device{}()) + ".obj")) {
    std::ofstream(path_, std::ios::binary) << text;
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  std::string name() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

Mesh obj(const std::string& text) { return springstab::read_obj(File(text).name()); }

const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";

}  // namespace

BOOST_AUTO_TEST_SUITE(obj_texture)

BOOST_AUTO_TEST_CASE(every_corner_has_the_coordinates_that_its_face_names) {
  const Mesh mesh = obj(vertices +
                        "vt 0.5 0.25\n"
                        "vt -1e-1 2 9\n"      // the third number is not used
                        "f 1/1 2/-1/7 3/3\n"  // the third is ahead; -1 is the second
                        "vt 3\n"              // v is 0
                        "f 2/-1 4/1 3/2/-5 \\\n 1/3\n");
  const std::vector<Vector2d> expected{{0.5, 0.25}, {-0.1, 2}, {3, 0}, {3, 0},
                                       {0.5, 0.25}, {-0.1, 2}, {3, 0}};
  BOOST_REQUIRE_EQUAL(mesh.corner_uv.size(), mesh.face_vertices.size());
  for (std::size_t k = 0; k < expected.size(); ++k)
    BOOST_TEST((mesh.corner_uv[k] == expected[k]), "corner " << k);
  BOOST_TEST(mesh.face_vertices == (std::vector<int>{0, 1, 2, 1, 3, 2, 0}), boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(one_corner_without_them_leaves_the_mesh_without) {
  BOOST_TEST(obj(vertices + "f 1 2 3\n").corner_uv.empty());
  BOOST_TEST(obj(vertices + "vt 0 0\nf 1 2 3\n").corner_uv.empty());
  BOOST_TEST(obj(vertices + "vt 0 0\nf 1/1 2/1 3/1\nf 2/1 3//1 4/1\n").corner_uv.empty());
  BOOST_TEST(obj(vertices + "vt 0 0\nf 1/1 2/1 3/1\nf 2/1 3/1 4/1\n").corner_uv.size() == 6u);
}

BOOST_AUTO_TEST_CASE(malformed_coordinates_and_indices_are_refused_with_their_line) {
  const struct {
    std::string text;
    long line;
    std::string message;
  } cases[] = {
      {"vt\n", 5, "0 numbers"},
      {"vt 0 0 0 0\n", 5, "4 numbers"},
      {"vt 0 a\n", 5, "'a' is not a number"},
      {"vt nan 0\n", 5, "'nan' is not finite"},
      {"vt 0 0\nf 1/0 2/1 3/1\n", 6, "texture index 0 is out of range"},
      {"vt 0 0\n\nf 1/1 2/2 3/1\n", 7, "texture index 2 is out of range, expected at most 1"},
      {"f 1/1 2/1 3/1\n", 5, "texture index 1 is out of range, expected at most 0"},
      {"vt 0 0\nf 1/-2 2/1 3/1\n", 6, "texture index -2 is out of range, expected at least -1"},
      {"f 1/-1 2/-1 3/-1\nvt 0 0\n", 5, "texture index -1 is out of range"},
      {"vt 0 0\nf 1/3000000000 2/1 3/1\n", 6, "texture index 3000000000 is out of range"},
      {"vt 0 0\nf 1/1.5 2/1 3/1\n", 6, "'1.5' is not an integer"},
      {"vt 0 0\nf 1/1/x 2/1 3/1\n", 6, "'x' is not an integer"},
      {"vt 0 0\nf 1/1 2/1 9/1\n", 6, "vertex index 9 is out of range"},
  };
  for (const auto& c : cases) {
    const File file(vertices + c.text);
    BOOST_CHECK_EXCEPTION(springstab::read_obj(file.name()), InputError, [&](const InputError& error) {
      const std::string text = error.what();
      const bool good = text.starts_with(file.name() + ":" + std::to_string(c.line) + ": ") &&
                        text.find(c.message) != text.npos && text.find("expected") != text.npos;
      if (!good) BOOST_TEST_MESSAGE(text << " for " << c.text);
      return good;
    });
  }
}

BOOST_AUTO_TEST_CASE(a_published_cloth_keeps_its_coordinates) {
  if (const auto path = springstab::test::shared_data("meshes/pbd_plane_30x30.obj")) {
    const Mesh mesh = springstab::read_obj(path->string());
    BOOST_REQUIRE_EQUAL(mesh.corner_uv.size(), mesh.face_vertices.size());
    for (const Vector2d& uv : mesh.corner_uv) BOOST_TEST((uv.minCoeff() >= 0 && uv.maxCoeff() <= 1));
  }
}

BOOST_AUTO_TEST_SUITE_END()
