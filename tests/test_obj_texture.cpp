// Texture coordinates in OBJ files: which corner has which, when a mesh has none, and what is refused.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "experiments/inputs/mesh_report.h"
#include "experiments/inputs/subject.h"
#include "solvers/io/input_error.h"
#include "solvers/io/obj.h"
#include "tests/command.h"
#include "tests/scratch.h"
#include "tests/shared_data.h"

BOOST_AUTO_TEST_SUITE(obj_texture)

using Eigen::Vector2d;
using springstab::ClothMaterial;
using springstab::InputError;
using springstab::Json;
using springstab::Mesh;
using springstab::Subject;
using springstab::test::ScratchFile;

namespace {

Mesh obj(const std::string& text) { return springstab::read_obj(ScratchFile(text).name()); }

const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";

// Two rectangles of 3 by 4 and of 5 by 4 m, folded at a right angle. The faces stand on the
// lines 17 to 20.
const std::string folded =
    "v 0 0 0\nv 0 4 0\nv 3 0 0\nv 3 4 0\nv 3 0 5\nv 3 4 5\n"
    "# its map:\n";
const std::string folded_faces = "f 1/1 3/3 4/4\nf 1/1 4/4 2/2\nf 3/3 5/5 6/6\nf 3/7 6/8 4/9\n";

/// The mesh above, its corners unfolded to the plane and mapped; the last triangle has corners of its own.
template <class Map>
std::string folded_with(const Map& map) {
  std::string text = folded;
  const std::vector<Vector2d> flat{{0, 0}, {0, 4}, {3, 0}, {3, 4}, {8, 0}, {8, 4}, {3, 0}, {8, 4}, {3, 4}};
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const Vector2d uv = map(flat[i], i >= 6);
    char line[100];
    std::snprintf(line, sizeof line, "vt %.17g %.17g\n", uv.x(), uv.y());
    text += line;
  }
  return text + folded_faces;
}

// Turned, shifted, and mirrored where it is the last triangle.
Vector2d moved(Vector2d p, bool last) {
  if (last) p.x() = -p.x();
  return {0.6 * p.x() - 0.8 * p.y() + 7, 0.8 * p.x() + 0.6 * p.y() - 2};
}

Subject cloth(const std::string& text, std::optional<double> texture_unit = {}) {
  const ScratchFile file(text);
  springstab::SceneDescription scene;
  scene.geometry = file.name();
  ClothMaterial material;
  material.texture_unit = texture_unit;
  scene.material = material;
  return Subject(scene);
}

double strain_energy(Subject& subject) { return subject.scene()->elastic_energy(subject.initial_state(1).x); }

bool close(const Json& value, double expected, double tolerance = 1e-12) {
  return std::abs(value.get<double>() - expected) <= tolerance * std::abs(expected);
}

}  // namespace

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
      {"vt 1e999 0\n", 5, "'1e999' is out of range"},
      {"vt nan x\n", 5, "'x' is not a number"},
      {"vt 0 0\n\nf 1/1 2/2 3/1\n", 7, "texture index 2 is out of range, expected at most 1"},
      {"f 1/1 2/1 3/1\nvt 0 0\nf 1/2 2/1 3/1\n", 7, "texture index 2 is out of range, expected at most 1"},
      {"vt 0 0\nf 1/-2 2/1 3/1\n", 6, "texture index -2 is out of range, expected at least -1"},
      {"f 1/-1 2/-1 3/-1\nvt 0 0\n", 5, "texture index -1 is out of range"},
      {"vt 0 0\nf 1/3000000000 2/1 3/1\n", 6, "texture index 3000000000 is out of range"},
      {"vt 0 0\nf 1/1.5 2/1 3/1\n", 6, "'1.5' is not an integer"},
      {"vt 0 0\nf 1/1/x 2/1 3/1\n", 6, "'x' is not an integer"},
      {"vt 0 0\nf 1/1 2/1 9/1\n", 6, "vertex index 9 is out of range"},
  };
  for (const auto& c : cases) {
    const ScratchFile file(vertices + c.text);
    BOOST_CHECK_EXCEPTION(springstab::read_obj(file.name()), InputError, [&](const InputError& error) {
      const std::string text = error.what();
      const bool good = text.starts_with(file.name() + ":" + std::to_string(c.line) + ": ") &&
                        text.find(c.message) != text.npos && text.find("expected") != text.npos;
      if (!good) BOOST_TEST_MESSAGE(text << " for " << c.text);
      return good;
    });
  }
}

// Also turned, mirrored, cut along a seam and in another unit: no triangle is strained, and nothing is said.
BOOST_AUTO_TEST_CASE(an_isometric_map_strains_nothing) {
  for (const double scale : {1., 0.01}) {
    const auto map = [&](const Vector2d& p, bool last) { return Vector2d(scale * moved(p, last)); };
    Subject subject = cloth(folded_with(map));
    const Json found = springstab::mesh_json(subject)["texture_map"];
    BOOST_TEST(found.at("used") == true);
    BOOST_TEST(close(found.at("texture_unit"), 1 / scale));
    BOOST_TEST(found.at("triangles") == 4);
    BOOST_TEST(found.at("strained_triangles") == 0);
    BOOST_TEST(close(found.at("largest_factor"), 1));
    BOOST_TEST(strain_energy(subject) < 1e-20);
  }
}

// Of a map that is s times as large, with A the mesh's area of 32 m²: |w_u| = |w_v| = 1/s, w_u·w_v = 0, and
// E = ½ (κ_u + κ_v) s² A (1/s - 1)². With κ = 1000 N/m that is 32 000 (1 - s)² J.
BOOST_AUTO_TEST_CASE(a_map_that_is_too_large_or_too_small_has_that_factor) {
  for (const double s : {3., 1 / 3., 2.01, 1.99}) {
    Subject subject = cloth(folded_with(moved), s);
    const Json found = springstab::mesh_json(subject)["texture_map"];
    BOOST_TEST(close(found.at("largest_factor"), std::max(s, 1 / s)));
    BOOST_TEST(found.at("strained_triangles") == (s == 1.99 ? 0 : 4));
    BOOST_TEST(close(found.at("texture_unit"), s));
    BOOST_TEST(close(found.at("area_unit"), 1));
    BOOST_TEST(close(strain_energy(subject), 32000 * (1 - s) * (1 - s), 1e-9));
  }
}

// The last face 4 times as long in u and a quarter as long in v: the area is the same, and so is the unit.
// With shear in place of that, by x += 3 y, the singular values are (√13 ± 3)/2.
BOOST_AUTO_TEST_CASE(the_face_that_is_strained_most_is_named) {
  const auto stretched = [](const Vector2d& p, bool last) {
    return last ? Vector2d(4 * p.x(), p.y() / 4) : p;
  };
  const auto sheared = [](const Vector2d& p, bool last) {
    return last ? Vector2d(p.x() + 3 * p.y(), p.y()) : p;
  };
  for (const auto& [text, factor] :
       {std::pair(folded_with(stretched), 4.), std::pair(folded_with(sheared), (std::sqrt(13.) + 3) / 2)}) {
    const Json found = springstab::mesh_json(cloth(text))["texture_map"];
    BOOST_TEST(close(found.at("largest_factor"), factor));
    BOOST_TEST(found.at("strained_triangles") == 1);
    BOOST_TEST(found.at("line") == 20);
    BOOST_TEST(close(found.at("texture_unit"), 1));
  }
}

BOOST_AUTO_TEST_CASE(maps_that_are_not_used_are_told_apart) {
  const auto pressed = [](const Vector2d& p, bool last) { return last ? Vector2d(p.x(), p.x()) : p; };
  Subject subject = cloth(folded_with(pressed));
  const Json found = springstab::mesh_json(subject)["texture_map"];
  BOOST_TEST((found == Json{{"used", false}, {"line", 20}}));
  BOOST_TEST(strain_energy(subject) < 1e-20);
  const std::string flat = "vt 0 0\nvt 9 0\nvt 0 1\nf 1/1 2/2 3/3\n";
  BOOST_TEST(springstab::mesh_json(cloth(vertices + flat))["texture_map"].is_null());
  const ScratchFile springs(folded_with(pressed));
  springstab::InputOptions input;
  input.file = springs.name();
  BOOST_TEST(springstab::mesh_json(Subject(input))["texture_map"].is_null());
}

BOOST_FIXTURE_TEST_CASE(a_straining_map_is_one_line_before_the_run, springstab::test::Command) {
  const auto scene = [&](const std::string& name, const std::string& unit) {
    file(name, R"({"geometry": {"mesh": "folded.obj"}, "pins": [0],
                   "material": {"model": "baraff-witkin", "texture_unit": )" +
                   unit + "}}");
    return (*this)("simulate " + name + " --method rk4 --duration 1e-4 --json");
  };
  file("folded.obj", folded_with(moved));
  const springstab::test::Outcome sound = scene("sound.json", "1"), strained = scene("strained.json", "3");
  BOOST_TEST(sound.status == 0);
  BOOST_TEST(sound.err == "");
  BOOST_TEST(strained.status == 0);
  BOOST_TEST(springstab::test::lines(strained.err) == 1);
  BOOST_TEST(strained.err.starts_with("springstab: warning: folded.obj:17: "));
  for (const char* part : {"strained", "4 of 4 triangles", "this face by 3,", "texture_unit of 3 m",
                           "the mesh's area asks for 1 m", "without texture coordinates (vt)"})
    BOOST_TEST(strained.err.find(part) != std::string::npos, part);
  BOOST_TEST(strained.json().at("mesh").at("texture_map").at("strained_triangles") == 4);
}

BOOST_FIXTURE_TEST_CASE(a_texture_unit_without_a_map_is_one_line, springstab::test::Command) {
  file("plain.obj", vertices + "f 1 2 4 3\n");
  file("folded.obj", folded_with(moved));
  const auto said = [&](const std::string& geometry, const std::string& unit) {
    file("scene.json", R"({"geometry": {)" + geometry + R"(}, "pins": [0],
                           "material": {"model": "baraff-witkin")" +
                           unit + "}}");
    const springstab::test::Outcome run = (*this)("limits scene.json --method rk4");
    BOOST_TEST(run.status == 0);
    return run.err;
  };
  const std::string unit = R"(, "texture_unit": 1)", grid = R"("grid": [3, 3], "spacing": 0.1)",
                    plain = R"("mesh": "plain.obj")", creased = R"("mesh": "folded.obj")";
  for (const std::string& geometry : {grid, plain}) {
    BOOST_TEST(said(geometry, unit).starts_with("springstab: note: texture_unit: is not used: "));
    BOOST_TEST(said(geometry, "") == "");
  }
  const std::string of_the_step = said(creased, unit);  // and nothing else
  BOOST_TEST(of_the_step.starts_with("springstab: warning: stable, but too long to follow the motion: "));
  BOOST_TEST(std::count(of_the_step.begin(), of_the_step.end(), '\n') == 1);
}

BOOST_FIXTURE_TEST_CASE(what_the_reader_left_out_is_a_line_for_each_kind, springstab::test::Command) {
  file("lines.obj", vertices + "l 1 2\nl 2 3\nf 1\nf 1/1 2/1 4/1 3/1\n");
  const springstab::test::Outcome run = (*this)("limits lines.obj --method rk4");
  BOOST_TEST(run.status == 0);
  BOOST_TEST(run.err ==
             "springstab: note: lines.obj:7: dropped a face of one or two corners\n"
             "springstab: note: lines.obj:5: 2 statements 'l' are not used\n"
             "springstab: note: lines.obj:8: texture coordinates are named, but the file has none\n");
}

// The same polygons are the same cloth in every format, for every material of cloths, and with pins.
BOOST_FIXTURE_TEST_CASE(a_surface_of_another_format_is_a_cloth_as_of_obj, springstab::test::Command) {
  file("a.obj", vertices + "f 1 2 3\nf 2 4 3\n");
  file("a.msh",
       "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n1 1 "
       "0\n"
       "$EndNodes\n$Elements\n1 2 1 2\n2 1 2 2\n1 1 2 3\n2 2 4 3\n$EndElements\n");
  file("a.vtk",
       "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 1 1 0\n"
       "POLYGONS 2 8\n3 0 1 2\n3 1 3 2\n");
  for (const std::string& options :
       {std::string("--material baraff-witkin --pin 0"), std::string("--pin 0,3")}) {
    const springstab::test::Outcome obj = (*this)("limits a.obj --json " + options);
    for (const char* name : {"a.msh", "a.vtk"}) {
      const springstab::test::Outcome other = (*this)("limits " + std::string(name) + " --json " + options);
      BOOST_TEST(other.status == obj.status, name);
      BOOST_TEST(other.err == obj.err, name);
      BOOST_TEST(other.json().at("k0").at("value") == obj.json().at("k0").at("value"));
      BOOST_TEST(other.json().at("methods") == obj.json().at("methods"));
    }
  }
  file("scene.json", R"({"geometry": {"mesh": "a.msh"}, "material": {"model": "springs", "bending": 3}})");
  BOOST_TEST((*this)("limits scene.json").status == 0);
  BOOST_TEST((*this)("limits a.msh --material tetrahedra").status == 2);
}

BOOST_FIXTURE_TEST_CASE(duplicates_are_summed_by_an_option_of_matrices, springstab::test::Command) {
  file("k.mtx", "%%MatrixMarket matrix coordinate real general\n1 1 2\n1 1 3\n1 1 1\n");
  const springstab::test::Outcome refused = (*this)("limits --stiffness k.mtx --json");
  BOOST_TEST(refused.status == 2);
  BOOST_TEST(refused.err.find("k.mtx:4: ") != std::string::npos);
  BOOST_TEST(refused.err.find("--sum-duplicates") != std::string::npos);
  const springstab::test::Outcome summed = (*this)("limits --stiffness k.mtx --sum-duplicates --json");
  BOOST_TEST(summed.status == 0);
  BOOST_TEST(close(summed.json().at("k0").at("value"), 4));
  BOOST_TEST((*this)("limits --grid 3x3 --sum-duplicates").status == 2);
}

BOOST_AUTO_TEST_CASE(a_published_cloth_keeps_its_coordinates) {
  if (const auto path = springstab::test::shared_data("meshes/pbd_plane_30x30.obj")) {
    const Mesh mesh = springstab::read_obj(path->string());
    BOOST_REQUIRE_EQUAL(mesh.corner_uv.size(), mesh.face_vertices.size());
    for (const Vector2d& uv : mesh.corner_uv) BOOST_TEST((uv.minCoeff() >= 0 && uv.maxCoeff() <= 1));
  }
}

// The numbers of two published meshes: one that was bent as cloth is, and eyes whose map is a picture's.
BOOST_AUTO_TEST_CASE(published_maps_are_told_from_pictures) {
  const auto found = [](const std::string& name) -> Json {
    const auto path = springstab::test::shared_data("meshes/" + name);
    if (!path) return nullptr;
    springstab::InputOptions input;
    input.file = path->string();
    input.material = "baraff-witkin";
    return springstab::mesh_json(Subject(input))["texture_map"];
  };
  if (const Json bent = found("vega_bend2_quads.obj"); !bent.is_null()) {
    BOOST_TEST(bent.at("strained_triangles") == 0);
    BOOST_TEST(close(bent.at("largest_factor"), 1.240088189943711, 1e-9));
  }
  if (const Json eyes = found("sofa_frog_eyes.obj"); !eyes.is_null()) {
    BOOST_TEST(eyes.at("strained_triangles") == 559);
    BOOST_TEST(eyes.at("triangles") == 1024);
    BOOST_TEST(eyes.at("line") == 952);
    BOOST_TEST(close(eyes.at("largest_factor"), 4885.221311769404, 1e-9));
  }
}

BOOST_AUTO_TEST_SUITE_END()
