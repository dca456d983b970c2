#include "experiments/inputs/contact_keys.h"

#include <filesystem>

#include "experiments/inputs/json_reader.h"

namespace springstab {
namespace {

class ContactReader : private JsonReader {
 public:
  using JsonReader::JsonReader;

  ContactDescription contact(const JsonValue& json) const {
    expect_members(json, {"obstacles", "self", "thickness", "friction", "model"});
    ContactDescription d{{}, source_, json.line};
    Contact& contact = d.contact;
    if (const JsonValue* self = find(json, "self")) {
      contact.self = truth(*self);
      d.self_line = self->key_line;
    }
    const JsonValue* given = find(json, "obstacles");
    if (given || !contact.self) {
      const JsonValue& obstacles =
          given ? *given
                : needed(json, "obstacles", "[{\"plane\": {\"point\": [0, 0, 0], \"normal\": [0, 1, 0]}}]");
      if (obstacles.kind != JsonValue::Kind::array || obstacles.items.empty())
        wrong(obstacles, "an array of obstacles, at least one");
      for (int i = 0; i < static_cast<int>(obstacles.items.size()); ++i)
        add_obstacle(obstacles.items[i], i, d);
    }
    read_number(json, "thickness", Sign::not_negative, contact.thickness);
    if (const JsonValue* thickness = find(json, "thickness")) d.thickness_line = thickness->line;
    read_number(json, "friction", Sign::not_negative, contact.friction);
    if (const JsonValue* value = find(json, "model")) contact.model = model(*value);
    if (given && std::holds_alternative<Penalty>(contact.model)) expect_at_rest(*given);
    if ((contact.self || !d.meshes.empty()) && contact.thickness == 0)
      fail(d.thickness_line > 0 ? d.thickness_line : json.line,
           "'thickness' is zero or missing, expected a positive number of metres with 'self' or a mesh");
    return d;
  }

 private:
  bool truth(const JsonValue& json) const {
    if (json.kind == JsonValue::Kind::literal && json.text == "true") return true;
    if (json.kind == JsonValue::Kind::literal && json.text == "false") return false;
    wrong(json, "true or false");
  }

  void add_obstacle(const JsonValue& json, int number, ContactDescription& d) const {
    expect_members(json, {"plane", "sphere", "mesh", "velocity"});
    const JsonValue *flat = find(json, "plane"), *round = find(json, "sphere"), *mesh = find(json, "mesh");
    const int shapes = (flat != nullptr) + (round != nullptr) + (mesh != nullptr);
    if (shapes != 1)
      fail(json.line, json.name + (shapes == 0 ? " has none of" : " has more than one of") +
                          " 'plane', 'sphere' and 'mesh', expected one of them");
    Eigen::Vector3d u(0, 0, 0);
    if (const JsonValue* velocity = find(json, "velocity")) u = vector(*velocity);
    if (mesh) {
      if (mesh->kind != JsonValue::Kind::string || mesh->text.empty())
        wrong(*mesh, "the path of a mesh file");
      const auto path = std::filesystem::path(source_).parent_path() / mesh->text;
      d.meshes.push_back({path.string(), u, {json.line, number}});
      return;
    }
    Obstacle obstacle;
    if (flat) {
      obstacle.shape = plane(*flat);
    } else {
      obstacle.shape = sphere(*round);
    }
    obstacle.velocity = u;
    d.contact.obstacles.push_back(obstacle);
    d.places.push_back({json.line, number});
  }

  Plane plane(const JsonValue& json) const {
    expect_members(json, {"point", "normal"});
    const JsonValue& normal_json = needed(json, "normal", "the direction out of it, such as [0, 1, 0]");
    const Eigen::Vector3d normal = vector(normal_json);
    const double largest = normal.cwiseAbs().maxCoeff();
    if (largest == 0) fail(normal_json.line, normal_json.name + " is zero, expected a direction");
    return {vector(needed(json, "point", "a place in it, such as [0, 0, 0]")),
            (normal / largest).normalized()};
  }

  Sphere sphere(const JsonValue& json) const {
    expect_members(json, {"center", "radius"});
    return {vector(needed(json, "center", "a place, such as [0, 0, 0]")),
            number(needed(json, "radius", "a number of metres"), Sign::positive)};
  }

  ContactModel model(const JsonValue& json) const {
    constexpr char expected[] =
        "'impulses', 'inelastic' or {\"penalty\": {\"stiffness\": 1e4, \"damping\": 0}}";
    if (json.kind == JsonValue::Kind::object) {
      expect_members(json, {"penalty"});
      const JsonValue& values = needed(json, "penalty", expected);
      expect_members(values, {"stiffness", "damping"});
      Penalty penalty;
      penalty.stiffness = number(needed(values, "stiffness", "a number of N/m"), Sign::positive);
      read_number(values, "damping", Sign::not_negative, penalty.damping);
      return penalty;
    }
    const std::string name = text(json, expected);
    if (name == "impulses") return LandingImpulses();
    if (name == "inelastic") return InelasticImpulses();
    wrong(json, expected);
  }

  void expect_at_rest(const JsonValue& obstacles) const {
    for (const JsonValue& item : obstacles.items)
      if (const JsonValue* velocity = find(item, "velocity"))
        fail(velocity->key_line,
             "'velocity' stands with the model 'penalty', expected it with 'impulses' or 'inelastic' only");
  }
};

}  // namespace

ContactDescription read_contact(const std::string& source, const JsonValue& json) {
  return ContactReader(source).contact(json);
}

}  // namespace springstab
