// The laws of a scene file: what is written arrives, what is absent has its default, what is wrong is refused
// with its line.
#include <boost/test/unit_test.hpp>
#include <filesystem>

#include "experiments/command/words.h"
#include "experiments/inputs/scene_description.h"
#include "solvers/io/input_error.h"
#include "tests/places.h"
#include "tests/refusals.h"
#include "tests/scratch.h"

BOOST_AUTO_TEST_SUITE(scene_file)

using namespace springstab;
using springstab::test::expect_error;

namespace {

/// A folder with one scene file, gone at the end.
class SceneFile {
 public:
  explicit SceneFile(const std::string& text) : path_(folder_.file("scene.json", text)) {}

  std::string path() const { return path_; }
  std::string folder() const { return folder_.path(); }

 private:
  test::ScratchFolder folder_;
  std::string path_;
};

SceneDescription read(const std::string& text) { return read_scene_file(SceneFile(text).path()); }

/// What follows the geometry of an otherwise complete scene, from line 2 on.
std::string with(const std::string& rest) { return "{\"geometry\": {\"grid\": [3, 4]},\n" + rest + "}\n"; }

void expect_refused(const std::string& text, long line, const std::string& words) {
  const SceneFile file(text);
  expect_error([&] { read_scene_file(file.path()); }, file.path() + ":" + std::to_string(line), words);
}

void check_equal(const PerKind& a, const PerKind& b) {
  BOOST_TEST(a.structural == b.structural);
  BOOST_TEST(a.shear == b.shear);
  BOOST_TEST(a.bending == b.bending);
}

const SpringMaterial& springs(const SceneDescription& scene) {
  return std::get<SpringMaterial>(scene.material);
}

const ClothMaterial& triangles(const SceneDescription& scene) {
  return std::get<ClothMaterial>(scene.material);
}

void check_equal(const PerCondition& a, const PerCondition& b) {
  BOOST_TEST(a.stretch_u == b.stretch_u);
  BOOST_TEST(a.stretch_v == b.stretch_v);
  BOOST_TEST(a.shear == b.shear);
  BOOST_TEST(a.bending == b.bending);
}

}  // namespace

BOOST_AUTO_TEST_CASE(every_field_that_is_written_arrives) {
  const SceneFile file(R"({
    "initial": {"velocity": [0.1, -0.2, 0.3], "stretch": [1.02, 1, 1.03]},
    "geometry": {"spacing": 0.5, "grid": [7, 9]},
    "damping": {"alpha": 1e-3, "d0": 2},
    "gravity": [1, -2.5, 3e0],
    "material": {"name": "stiff", "particle_mass": 1.25e-4, "structural": 11, "shear": 12,
                 "bending": 13, "damping": {"structural": 0.01, "shear": 0.02, "bending": 0.03}},
    "pins": [6, 0, 5, 6]
  })");
  const SceneDescription scene = read_scene_file(file.path());
  const Grid& grid = std::get<Grid>(scene.geometry);
  BOOST_TEST((grid.rows == 7 && grid.columns == 9 && grid.spacing == 0.5));
  BOOST_TEST(springs(read(with(R"("material": {"area_density": 0.3})"))).area_density == 0.3);
  BOOST_TEST(springs(scene).particle_mass.value() == 1.25e-4);
  check_equal(springs(scene).stiffness, {11, 12, 13});
  check_equal(springs(scene).damping, {0.01, 0.02, 0.03});
  BOOST_TEST((scene.pins.kind == Pins::Kind::indices));
  BOOST_TEST((scene.pins.ranges == std::vector<Range>{{0, 0}, {5, 6}}));
  BOOST_TEST(scene.pins.source == file.path());
  BOOST_TEST(scene.pins.line == 8);
  BOOST_TEST((scene.gravity == Eigen::Vector3d(1, -2.5, 3)));
  BOOST_TEST(scene.damping.d0 == 2);
  BOOST_TEST(scene.damping.alpha.value() == 1e-3);
  BOOST_TEST((scene.initial.stretch == Eigen::Vector3d(1.02, 1, 1.03)));
  BOOST_TEST((scene.initial.velocity == Eigen::Vector3d(0.1, -0.2, 0.3)));
}

BOOST_AUTO_TEST_CASE(what_is_absent_has_its_default) {
  const SceneDescription scene = read(R"({"geometry": {"grid": [3, 4]}})");
  BOOST_TEST(std::get<Grid>(scene.geometry).spacing == 0.025);
  BOOST_TEST(springs(scene).area_density == 0.2);
  BOOST_TEST(!springs(scene).particle_mass.has_value());
  check_equal(springs(scene).stiffness, {200, 100, 20});
  check_equal(springs(scene).damping, {0, 0, 0});
  BOOST_TEST((scene.pins.kind == Pins::Kind::none));
  BOOST_TEST((scene.gravity == Eigen::Vector3d(0, -9.81, 0)));
  BOOST_TEST(scene.damping.d0 == 0);
  BOOST_TEST(scene.damping.alpha.value() == 0);
  BOOST_TEST((scene.initial.stretch == Eigen::Vector3d(1, 1, 1)));
  BOOST_TEST((scene.initial.velocity == Eigen::Vector3d(0, 0, 0)));
  BOOST_TEST(!read(with("\"damping\": {\"alpha\": \"designed\"}")).damping.alpha.has_value());
}

BOOST_AUTO_TEST_CASE(the_path_of_a_mesh_is_relative_to_the_scene_file) {
  const SceneFile file(R"({"geometry": {"mesh": "meshes/cloth.obj"}})");
  BOOST_TEST(std::get<std::string>(read_scene_file(file.path()).geometry) ==
             file.folder() + "/meshes/cloth.obj");
  BOOST_TEST(std::get<std::string>(read(R"({"geometry": {"mesh": "/a/b.obj"}})").geometry) == "/a/b.obj");
}

BOOST_AUTO_TEST_CASE(a_name_picks_the_material_and_other_keys_override_it) {
  check_equal(springs(read(with("\"material\": \"soft\""))).stiffness, {20, 10, 2});
  const SpringMaterial material = springs(read(with("\"material\": {\"shear\": 5, \"name\": \"stiff\"}")));
  check_equal(material.stiffness, {20000, 5, 200});
  check_equal(std::get<SpringMaterial>(named_material("default", false, "", 0)).stiffness,
              SpringMaterial{}.stiffness);
  expect_error([] { named_material("sotf", false, "--material", 0); }, "--material", "did you mean 'soft'?");
}

BOOST_AUTO_TEST_CASE(pins_are_words_indices_or_ranges) {
  const auto kind = [](const std::string& text) { return parse_pins(text, "--pin", 0).kind; };
  BOOST_TEST((kind("none") == Pins::Kind::none));
  BOOST_TEST((kind("first-row") == Pins::Kind::first_row));
  BOOST_TEST((kind("corners") == Pins::Kind::corners));
  const Pins pins = parse_pins("12,5-8,0,7-9,12", "--pin", 0);
  BOOST_TEST((pins.kind == Pins::Kind::indices));
  BOOST_TEST((pins.ranges == std::vector<Range>{{0, 0}, {5, 9}, {12, 12}}));
  BOOST_TEST((read(with("\"pins\": \"0,5-9\"")).pins.ranges == std::vector<Range>{{0, 0}, {5, 9}}));
  // A short text names many particles many times; only a scene that has them makes a list of them.
  std::string many = "0-19999999";
  for (int i = 0; i < 1000; ++i) many += ",1-19999998";
  BOOST_TEST((parse_pins(many, "--pin", 0).ranges == std::vector<Range>{{0, 19999999}}));
  BOOST_TEST((read(with("\"pins\":\n \"corners\"")).pins.line == 3));
  for (const char* bad : {"", ",", "1,", ",1", "1,,2", "-1", "5-", "9-5", "1-2-3", "5--6", "1.5", " 1", "1 ",
                          "x", "1x", "+1", "20000000", "0-99999999999999999999", "None"})
    expect_error([&] { parse_pins(bad, "--pin", 0); }, "--pin", "'" + std::string(bad) + "'");
  expect_error([] { parse_pins("frist-row", "scene.json", 7); }, "scene.json:7", "did you mean 'first-row'?");

  const Pins group = parse_pins("group:left  collar ", "--pin", 0);
  BOOST_TEST((group.kind == Pins::Kind::group && group.name == "left  collar"));
  BOOST_TEST((kind("object:Sail") == Pins::Kind::object));
  const Pins box = parse_pins("box:-1:0.5,:,2e-3:", "--pin", 0);
  BOOST_TEST((box.kind == Pins::Kind::box));
  BOOST_TEST((box.box.min() == Eigen::Vector3d(-1, -HUGE_VAL, 2e-3)));
  BOOST_TEST((box.box.max() == Eigen::Vector3d(0.5, HUGE_VAL, HUGE_VAL)));
  for (const char* bad :
       {"box:", "box:0:1", "box:0:1,0:1", "box:0:1,0:1,0:1,0:1", "box:0:1,0:1,0:1,",
        "box:1:0,:,:", "box:0,:,:", "box:0:1:2,:,:", "box:a:1,:,:", "box:nan:1,:,:", "group:", "object: "})
    BOOST_TEST_CONTEXT(bad) BOOST_CHECK_THROW(parse_pins(bad, "--pin", 0), InputError);
}

BOOST_AUTO_TEST_CASE(a_suggestion_is_near_or_absent) {
  BOOST_TEST(expected_one_of("spaceing", {"grid", "spacing"}) ==
             "expected 'grid' or 'spacing' (did you mean 'spacing'?)");
  BOOST_TEST(expected_one_of("colour", {"grid", "spacing", "mesh"}) ==
             "expected 'grid', 'spacing' or 'mesh'");
  BOOST_TEST(expected_one_of("x", {"grid"}) == "expected 'grid'");
  BOOST_TEST(did_you_mean("RK4", {"rk2", "rk4"}) == " (did you mean 'rk4'?)");
  BOOST_TEST(did_you_mean("Symplectic_Euler", {"explicit-euler", "symplectic-euler"}) ==
             " (did you mean 'symplectic-euler'?)");
}

BOOST_AUTO_TEST_CASE(broken_json_is_refused_at_its_line) {
  const struct {
    std::string text;
    long line;
    std::string words;
  } cases[] = {
      {" ", 1, "unexpected end of input"},
      {"{\n", 1, "unexpected end of input"},
      {"{\n\"geometry\": {\"grid\": [1, 2]}", 2, "unexpected end of input"},
      {"{\"geometry\": {\"grid\": [1, 2]}}\n{", 2, "unexpected '{'"},
      {"{\"geometry\":\n{\"grid\": [1, 2],}}", 2, "unexpected '}'"},
      {"{\n// a comment\n\"geometry\": {\"grid\": [1, 2]}}", 2, "expected string literal"},
      {"{\n\"geometry\": // a comment\n{\"grid\": [1, 2]}}", 2, "no comments"},
      {"{\n\"geometry\": {\"grid\":\n [1, 02]}}", 3, "unexpected number literal"},
      {"{\n\"geometry\": {\"spacing\": .5}}", 2, "invalid literal"},
      {"{\n\"geometry\": {\"spacing\": NaN}}", 2, "invalid literal"},
      {"{\n\"geometry\": {\"spacing\": 1e999\n}}", 2, "1e999 is out of range"},
      {"{\n\"geometry\": {\"spacing\": -1e999}}", 2, "-1e999 is out of range"},
      {"{\n\"geometry\": {\"mesh\": \"a\n\"}}", 2, "control character"},
      {"{\n\"geo\\nmetry\\u0000\": 1}", 2, "unknown key 'geo?metry?'"},
      {"{\"geometry\": {\"mesh\":\n\"\xff\"}}", 2, "UTF-8"},
      {std::string(1000000, '['), 1, "nested too deeply"},
  };
  for (const auto& c : cases) expect_refused(c.text, c.line, c.words);
}

BOOST_AUTO_TEST_CASE(a_line_is_the_values_own_even_before_a_line_break) {
  expect_refused("{\"geometry\": {\"spacing\":\n\n-1\n,\n\"grid\": [1, 2]}}", 3, "'spacing' is -1");
  expect_refused("{\"geometry\": {\"grid\": [\n3,\n0\n]}}", 3, "'grid'[1] is 0");
  expect_refused("{\"geometry\": {\"gird\"\n:\n[1, 2]}}", 1, "'gird'");
  expect_refused("{\r\n\"geometry\": 1\r\n}", 2, "'geometry' is 1");
}

BOOST_AUTO_TEST_CASE(a_scene_that_breaks_the_schema_is_refused_at_its_line) {
  const struct {
    std::string text;
    long line;
    std::string words;
  } cases[] = {
      {"[1]", 1, "the scene is an array"},
      {"\n3", 2, "the scene is 3"},
      {"{}", 1, "'geometry' is missing"},
      {"\n{\"pins\": \"none\"}", 2, "'geometry' is missing"},
      {"{\"geometry\":\n{}}", 2, "neither"},
      {"{\"geometry\": null}", 1, "'geometry' is null, expected an object"},
      {"{\"geometry\": {\"grid\": [1, 2],\n\"mesh\": \"a.obj\"}}", 1, "both"},
      {"{\"geometry\": {\"mesh\": \"a.obj\",\n\"spacing\": 1}}", 2, "'spacing' stands beside 'mesh'"},
      {"{\"geometry\": {\"mesh\": \"\"}}", 1, "expected the path"},
      {"{\"geometry\": {\"mesh\": 3}}", 1, "'mesh' is 3"},
      {"{\"geometry\": {\"grid\": 3}}", 1, "'grid' is 3"},
      {"{\"geometry\": {\"grid\": [1, 2, 3]}}", 1, "3 entries"},
      {"{\"geometry\": {\"grid\": [1.5, 2]}}", 1, "'grid'[0] is 1.5, expected a whole number"},
      {"{\"geometry\": {\"grid\": [2, -1]}}", 1, "'grid'[1] is -1"},
      {"{\"geometry\": {\"grid\": [\"2\", 1]}}", 1, "'grid'[0] is '2'"},
      {"{\"geometry\": {\"grid\": [18446744073709551616, 1]}}", 1, "whole number"},
      {"{\"geometry\": {\"grid\": [5000, 4001]}}", 1, "20000000 particles"},
      {"{\"geometry\": {\"grid\": [2, 2], \"spacing\": 0}}", 1, "'spacing' is 0"},
      {"{\"geometry\": {\"grid\": [2, 2], \"spacing\": 1e-200}}", 1, "spacing is 1e-200"},
      {"{\"geometry\": {\"grid\": [2, 2],\n\"spaceing\": 1}}", 2, "did you mean 'spacing'?"},
      {with("\"gravitiy\": 1"), 2, "unknown key 'gravitiy' in the scene"},
      {with("\"Gravity\": 1"), 2, "did you mean 'gravity'?"},
      {with("\"pins\": \"none\",\n\"pins\": \"none\""), 3,
       "duplicate key 'pins', expected it once (it stands on line 2"},
      {with("\"damping\": {\"d0\": 1,\n\"d0\": 1}"), 3, "duplicate key 'd0'"},
      {with("\"material\": \"silk\""), 2, "unknown material 'silk'"},
      {with("\"material\": [1]"), 2, "'material' is an array"},
      {with("\"material\": {\n\"name\": \"stif\"}"), 3, "did you mean 'stiff'?"},
      {with("\"material\": {\"name\": 1}"), 2, "'name' is 1"},
      {with("\"material\": {\n\"particle_mass\": 0.1,\n\"area_density\": 0.2}"), 4,
       "'particle_mass' stands beside 'area_density', expected one of them"},
      {with("\"material\": {\"model\": \"baraff-witkin\", \"area_density\": 0.2,\n\"particle_mass\": 1}"), 3,
       "'particle_mass' stands beside 'area_density', expected one of them"},
      {with("\"material\": {\n\"area_density\": -0.2}"), 3,
       "'area_density' is -0.2, expected a positive number"},
      {with("\"material\": {\n\"particle_mass\": 0}"), 3, "'particle_mass' is 0"},
      {with("\"material\": {\n\"structural\": -1}"), 3, "'structural' is -1, expected zero or a positive"},
      {with("\"material\": {\n\"shear\": \"1\"}"), 3, "'shear' is '1'"},
      {with("\"material\": {\n\"bending\": true}"), 3, "'bending' is true"},
      {with("\"material\": {\"stiffness\": 1}"), 2, "unknown key 'stiffness' in 'material'"},
      {with("\"material\": {\"damping\": {\n\"shear\": -1}}"), 3, "'shear' is -1"},
      {with("\"material\": {\"damping\": {\"d0\": 1}}"), 2, "unknown key 'd0' in 'damping'"},
      {with("\"material\": {\"damping\": 1}"), 2, "'damping' is 1"},
      {with("\"material\": {\"shear\": 0,\n\"damping\": {\"shear\": 1}}"), 3,
       "shear damping is 1, expected zero"},
      {with("\"pins\": \"first row\""), 2, "did you mean 'first-row'?"},
      {with("\"pins\": 3"), 2, "'pins' is 3"},
      {with("\"pins\": [\n1,\n-1]"), 4, "'pins'[1] is -1"},
      {with("\"pins\": [20000000]"), 2, "'pins'[0] is 20000000"},
      {with("\"gravity\": -9.81"), 2, "'gravity' is -9.81, expected an array"},
      {with("\"gravity\": [0, -9.81]"), 2, "2 entries"},
      {with("\"gravity\": [0,\nnull, 0]"), 3, "'gravity'[1] is null"},
      {with("\"damping\": 1"), 2, "'damping' is 1"},
      {with("\"damping\": {\"d0\": -1}"), 2, "'d0' is -1"},
      {with("\"damping\": {\"d0\": 1,\n\"alpha\": -1e-3}"), 3, "'alpha' is -1e-3"},
      {with("\"damping\": {\"alpha\": \"design\"}"), 2, "'designed'"},
      {with("\"initial\": {\"stretch\": [1, 0, 1]}"), 2, "'stretch'[1] is 0, expected a positive number"},
      {with("\"initial\": {\"velocity\": {}}"), 2, "'velocity' is an object"},
      {with("\"initial\": {\"position\": [0, 0, 0]}"), 2, "unknown key 'position' in 'initial'"},
  };
  for (const auto& c : cases) expect_refused(c.text, c.line, c.words);
}

BOOST_AUTO_TEST_CASE(a_file_that_cannot_be_read_is_named) {
  const SceneFile file("");
  expect_error([&] { read_scene_file(file.path()); }, file.path(), "empty");
  expect_error([&] { read_scene_file(file.folder()); }, file.folder(), "cannot be read");
  expect_error([&] { read_scene_file(file.folder() + "/none.json"); }, file.folder() + "/none.json",
               "cannot be opened");
}

BOOST_AUTO_TEST_CASE(the_hanging_net_is_the_papers) {
  const std::filesystem::path root(springstab::test::source_folder());
  const SceneDescription scene = read_scene_file((root / "experiments/scenes/hanging_net_64.json").string());
  const Grid& grid = std::get<Grid>(scene.geometry);
  BOOST_TEST((grid.rows == 64 && grid.columns == 64 && grid.spacing == 0.025));
  BOOST_TEST(springs(scene).particle_mass.value() == 1.25e-4);
  check_equal(springs(scene).stiffness, {200, 100, 20});
  BOOST_TEST((scene.pins.kind == Pins::Kind::first_row));
  BOOST_TEST((scene.gravity == Eigen::Vector3d(0, -9.81, 0)));
  BOOST_TEST(scene.damping.d0 == 1);
  BOOST_TEST(scene.damping.alpha.value() == 1e-3);
}

BOOST_AUTO_TEST_CASE(a_cloth_of_triangles_arrives_with_all_its_fields) {
  const SceneDescription scene = read(with(R"("material": {"model": "baraff-witkin",
      "particle_mass": 2e-4, "stretch": [900, 800], "shear": 70, "bending": 2e-5, "area_scaling": "original",
      "damping": {"stretch": 0.5, "shear": 0.25, "bending": 1e-7}, "rest_stretch": [1, 0.9],
      "texture_unit": 2})"));
  const ClothMaterial& cloth = triangles(scene);
  BOOST_TEST(
      triangles(read(with(R"("material": {"model": "baraff-witkin", "area_density": 0.3})"))).area_density ==
      0.3);
  BOOST_TEST(cloth.particle_mass.value() == 2e-4);
  check_equal(cloth.stiffness, {900, 800, 70, 2e-5});
  check_equal(cloth.damping, {0.5, 0.5, 0.25, 1e-7});
  BOOST_TEST((cloth.scaling == AreaScaling::original));
  BOOST_TEST((cloth.rest_stretch.u == 1 && cloth.rest_stretch.v == 0.9));
  BOOST_TEST(cloth.texture_unit.value() == 2);

  const ClothMaterial bare = triangles(read(with("\"material\": {\"model\": \"baraff-witkin\"}")));
  const ClothMaterial named = triangles(read(with("\"material\": \"baraff-witkin\"")));
  for (const ClothMaterial& material : {bare, named}) {
    check_equal(material.stiffness, ClothMaterial{}.stiffness);
    check_equal(material.damping, {});
    BOOST_TEST((material.scaling == AreaScaling::continuum));
    BOOST_TEST(!material.texture_unit);
  }
}

BOOST_AUTO_TEST_CASE(a_wrong_cloth_of_triangles_is_refused_with_its_line) {
  const struct {
    std::string keys, words;
  } cases[] = {
      {"\"model\": \"baraff-witken\"", "did you mean 'baraff-witkin'?"},
      {"\"model\": 1", "'model' is 1, expected 'springs' or 'baraff-witkin'"},
      {"\"model\": \"springs\", \"stretch\": 1", "unknown key 'stretch'"},
      {"\"model\": \"baraff-witkin\", \"structural\": 1", "unknown key 'structural'"},
      {"\"model\": \"baraff-witkin\", \"name\": \"soft\"",
       "'name' is 'soft', expected the name of a material of"},
      {"\"model\": \"baraff-witkin\", \"stretch\": [1]", "'stretch' has 1 entries"},
      {"\"model\": \"baraff-witkin\", \"stretch\": [1, -2]", "'stretch'[1] is -2"},
      {"\"model\": \"baraff-witkin\", \"rest_stretch\": 0", "'rest_stretch' is 0"},
      {"\"model\": \"baraff-witkin\", \"area_scaling\": \"none\"", "expected 'continuum' or 'original'"},
      {"\"model\": \"baraff-witkin\", \"texture_unit\": 0", "'texture_unit' is 0"},
      {"\"model\": \"baraff-witkin\", \"shear\": 0, \"damping\": {\"shear\": 1}", "shear damping is 1"},
  };
  for (const auto& c : cases) expect_refused(with("\"material\": {\n" + c.keys + "}"), 3, c.words);
}

BOOST_AUTO_TEST_SUITE_END()
