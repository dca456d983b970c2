// Reads a scene file: the tree of its JSON into a SceneDescription, key by key.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "experiments/command/words.h"
#include "experiments/inputs/contact_keys.h"
#include "experiments/inputs/grid.h"
#include "experiments/inputs/json_reader.h"
#include "experiments/inputs/scene_description.h"
#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"

namespace springstab {
namespace {

class SceneReader : private JsonReader {
 public:
  using JsonReader::JsonReader;

  SceneDescription scene(const JsonValue& json) const {
    expect_members(json, {"geometry", "material", "pins", "gravity", "damping", "initial", "contact", "scale",
                          "diagonals"});
    const JsonValue* geometry_json = find(json, "geometry");
    if (!geometry_json)
      fail(json.line,
           "'geometry' is missing, expected {\"grid\": [rows, columns]} or {\"mesh\": \"cloth.obj\"}");
    SceneDescription scene{
        .geometry = geometry(*geometry_json), .material = {}, .pins = {}, .damping = {}, .initial = {}};
    if (const JsonValue* value = beside_or_in(json, *geometry_json, "scale"))
      scene.scale = number(*value, Sign::positive);
    if (const JsonValue* value = beside_or_in(json, *geometry_json, "diagonals")) {
      Grid* const grid = std::get_if<Grid>(&scene.geometry);
      if (!grid) fail(value->key_line, "'diagonals' stands with 'mesh', expected it with 'grid' only");
      grid->diagonals = parse_diagonals(text(*value, "'uniform' or 'alternating'"), source_, value->line);
    }
    const JsonValue* material_json = find(json, "material");
    const bool solid = is_solid(scene.geometry);
    scene.material = material_json ? material(*material_json, solid)
                                   : named_material("default", solid, source_, json.line);
    scene.pins.source = source_;
    if (const JsonValue* value = find(json, "pins")) scene.pins = pins(*value);
    if (const JsonValue* value = find(json, "gravity")) scene.gravity = vector(*value);
    if (const JsonValue* value = find(json, "damping")) scene.damping = damping(*value);
    if (const JsonValue* value = find(json, "initial")) scene.initial = initial(*value);
    if (const JsonValue* value = find(json, "contact")) scene.contact = read_contact(source_, *value);
    return scene;
  }

 private:
  /// A key that may stand in the geometry or beside it; null where it does neither.
  const JsonValue* beside_or_in(const JsonValue& scene, const JsonValue& geometry,
                                std::string_view key) const {
    const JsonValue *beside = find(scene, key), *in = find(geometry, key);
    if (beside && in)
      fail(std::max(beside->key_line, in->key_line),
           beside->name + " stands in 'geometry' and beside it, expected it once");
    return beside ? beside : in;
  }

  void read_per_kind(const JsonValue& object, PerKind& values) const {
    read_number(object, "structural", Sign::not_negative, values.structural);
    read_number(object, "shear", Sign::not_negative, values.shear);
    read_number(object, "bending", Sign::not_negative, values.bending);
  }

  Geometry geometry(const JsonValue& json) const {
    expect_members(json, {"grid", "spacing", "mesh", "scale", "diagonals"});
    const JsonValue *grid_json = find(json, "grid"), *mesh = find(json, "mesh"),
                    *spacing = find(json, "spacing");
    if (!grid_json == !mesh)
      fail(json.line, "'geometry' has " + std::string(mesh ? "both" : "neither") +
                          " 'grid' and 'mesh', expected one of them");
    if (grid_json) return grid(json, *grid_json);
    if (spacing) fail(spacing->key_line, "'spacing' stands beside 'mesh', expected it with 'grid' only");
    if (mesh->kind != JsonValue::Kind::string || mesh->text.empty()) wrong(*mesh, "the path of a mesh file");
    return (std::filesystem::path(source_).parent_path() / mesh->text).string();
  }

  Grid grid(const JsonValue& geometry, const JsonValue& json) const {
    if (json.kind != JsonValue::Kind::array) wrong(json, "an array [rows, columns]");
    if (json.items.size() != 2)
      fail(json.line,
           "'grid' has " + std::to_string(json.items.size()) + " entries, expected [rows, columns]");
    Grid grid;
    grid.rows = integer(json.items[0], 1, max_particles);
    grid.columns = integer(json.items[1], 1, max_particles);
    read_number(geometry, "spacing", Sign::positive, grid.spacing);
    check(grid, source_, json.line);
    return grid;
  }

  Material material(const JsonValue& json, bool solid) const {
    if (json.kind == JsonValue::Kind::string) return named_material(json.text, solid, source_, json.line);
    if (json.kind != JsonValue::Kind::object) wrong(json, "the name of a material or an object");
    Material start = named_material("default", solid, source_, json.line);
    if (const JsonValue* model = find(json, "model")) {
      const std::vector<std::string_view> known =
          solid ? std::vector<std::string_view>{"tetrahedra"}
                : std::vector<std::string_view>{"springs", "baraff-witkin"};
      const std::string expected = solid ? "'tetrahedra' for such a mesh" : "'springs' or 'baraff-witkin'";
      const std::string name = text(*model, expected);
      if (std::find(known.begin(), known.end(), name) == known.end())
        wrong(*model, expected_one_of(name, known).substr(std::string("expected ").size()));
      if (name == "baraff-witkin") start = ClothMaterial{};
    }
    if (const JsonValue* name = find(json, "name")) {
      const std::size_t model = start.index();
      start = named_material(text(*name, "the name of a material"), solid, source_, name->line);
      if (find(json, "model") && start.index() != model) wrong(*name, "the name of a material of that model");
    }
    return std::visit([&](auto material) -> Material { return read_material(json, material); }, start);
  }

  /// A mass per particle, or a density by its name.
  void read_weight(const JsonValue& json, std::string_view name, double& density,
                   std::optional<double>& particle_mass) const {
    read_number(json, name, Sign::positive, density);
    const JsonValue* mass = find(json, "particle_mass");
    if (!mass) return;
    if (const JsonValue* other = find(json, name))
      fail(std::max(mass->key_line, other->key_line),
           "'particle_mass' stands beside " + other->name + ", expected one of them: each says the masses");
    particle_mass = number(*mass, Sign::positive);
  }

  SpringMaterial read_material(const JsonValue& json, SpringMaterial material) const {
    expect_members(json, {"model", "name", "area_density", "particle_mass", "structural", "shear", "bending",
                          "damping"});
    read_weight(json, "area_density", material.area_density, material.particle_mass);
    read_per_kind(json, material.stiffness);
    if (const JsonValue* damping = find(json, "damping")) {
      expect_members(*damping, {"structural", "shear", "bending"});
      read_per_kind(*damping, material.damping);
      check(material, source_, damping->line);
    }
    return material;
  }

  /// A number for both directions of the cloth, or [along u, along v].
  void read_directions(const JsonValue& object, std::string_view key, Sign sign, double& u, double& v) const {
    const JsonValue* member = find(object, key);
    if (!member) return;
    if (member->kind != JsonValue::Kind::array) {
      u = v = number(*member, sign);
      return;
    }
    if (member->items.size() != 2)
      fail(member->line, member->name + " has " + std::to_string(member->items.size()) +
                             " entries, expected a number or [along u, along v]");
    u = number(member->items[0], sign);
    v = number(member->items[1], sign);
  }

  void read_per_condition(const JsonValue& object, PerCondition& values) const {
    read_directions(object, "stretch", Sign::not_negative, values.stretch_u, values.stretch_v);
    read_number(object, "shear", Sign::not_negative, values.shear);
    read_number(object, "bending", Sign::not_negative, values.bending);
  }

  ClothMaterial read_material(const JsonValue& json, ClothMaterial material) const {
    expect_members(json, {"model", "name", "area_density", "particle_mass", "stretch", "shear", "bending",
                          "damping", "area_scaling", "rest_stretch", "texture_unit"});
    read_weight(json, "area_density", material.area_density, material.particle_mass);
    read_per_condition(json, material.stiffness);
    if (const JsonValue* scaling = find(json, "area_scaling")) {
      const std::string name = text(*scaling, "'continuum' or 'original'");
      if (name != "continuum" && name != "original") wrong(*scaling, "'continuum' or 'original'");
      material.scaling = name == "original" ? AreaScaling::original : AreaScaling::continuum;
    }
    read_directions(json, "rest_stretch", Sign::positive, material.rest_stretch.u, material.rest_stretch.v);
    if (const JsonValue* unit = find(json, "texture_unit"))
      material.texture_unit = number(*unit, Sign::positive);
    if (const JsonValue* damping = find(json, "damping")) {
      expect_members(*damping, {"stretch", "shear", "bending"});
      read_per_condition(*damping, material.damping);
      check(material, source_, damping->line);
    }
    return material;
  }

  void read_per_kind(const JsonValue& object, PerSolidKind& values) const {
    read_number(object, "edge", Sign::not_negative, values.edge);
    read_number(object, "altitude", Sign::not_negative, values.altitude);
  }

  SolidMaterial read_material(const JsonValue& json, SolidMaterial material) const {
    expect_members(json, {"model", "name", "density", "particle_mass", "edge", "altitude", "damping"});
    read_weight(json, "density", material.density, material.particle_mass);
    read_per_kind(json, material.stiffness);
    if (const JsonValue* damping = find(json, "damping")) {
      expect_members(*damping, {"edge", "altitude"});
      read_per_kind(*damping, material.damping);
      check(material, source_, damping->line);
    }
    return material;
  }

  Pins pins(const JsonValue& json) const {
    if (json.kind == JsonValue::Kind::string) return parse_pins(json.text, source_, json.line);
    if (json.kind != JsonValue::Kind::array)
      wrong(json, "a string such as 'first-row' or an array of indices");
    Pins pins{Pins::Kind::indices, {}, source_, json.line};
    for (const JsonValue& item : json.items) {
      const int index = integer(item, 0, max_particles - 1);
      pins.ranges.push_back({index, index});
    }
    pins.ranges = merged(std::move(pins.ranges));
    return pins;
  }

  RayleighDescription damping(const JsonValue& json) const {
    expect_members(json, {"d0", "alpha"});
    RayleighDescription damping;
    read_number(json, "d0", Sign::not_negative, damping.d0);
    const JsonValue* alpha = find(json, "alpha");
    if (!alpha) return damping;
    if (alpha->kind == JsonValue::Kind::string && alpha->text == "designed") {
      damping.alpha.reset();
    } else {
      if (alpha->kind == JsonValue::Kind::string) wrong(*alpha, "zero, a positive number or 'designed'");
      damping.alpha = number(*alpha, Sign::not_negative);
    }
    return damping;
  }

  InitialDescription initial(const JsonValue& json) const {
    expect_members(json, {"stretch", "velocity"});
    InitialDescription initial;
    if (const JsonValue* stretch = find(json, "stretch")) initial.stretch = vector(*stretch, Sign::positive);
    if (const JsonValue* velocity = find(json, "velocity")) initial.velocity = vector(*velocity);
    return initial;
  }
};

}  // namespace

SceneDescription parse_scene(const std::string& source, std::string_view text) {
  return SceneReader(source).scene(parse_json(source, text));
}

SceneDescription read_scene_file(const std::string& path) { return parse_scene(path, read_text_file(path)); }

}  // namespace springstab
