#include "experiments/inputs/contact_keys.h"

#include "experiments/inputs/json_reader.h"

namespace springstab {
namespace {

constexpr char not_supported[] = "is not supported, expected contact of particles with planes and spheres";

class ContactReader : private JsonReader {
 public:
  using JsonReader::JsonReader;

  ContactDescription contact(const JsonValue& json) const {
    expect_members(json, {"obstacles", "self", "thickness", "friction", "model"});
    ContactDescription d{{}, source_, json.line};
    Contact& contact = d.contact;
    if (const JsonValue* self = find(json, "self")) expect_no_self_contact(*self);
    const JsonValue& obstacles =
        needed(json, "obstacles", "[{\"plane\": {\"point\": [0, 0, 0], \"normal\": [0, 1, 0]}}]");
    if (obstacles.kind != JsonValue::Kind::array || obstacles.items.empty())
      wrong(obstacles, "an array of obstacles, at least one");
    for (const JsonValue& item : obstacles.items) {
      contact.obstacles.push_back(obstacle(item));
      d.obstacle_lines.push_back(item.line);
    }
    read_number(json, "thickness", Sign::not_negative, contact.thickness);
    if (const JsonValue* thickness = find(json, "thickness")) d.thickness_line = thickness->line;
    read_number(json, "friction", Sign::not_negative, contact.friction);
    if (const JsonValue* value = find(json, "model")) contact.model = model(*value);
    if (std::holds_alternative<Penalty>(contact.model)) expect_at_rest(obstacles);
    return d;
  }

 private:
  void expect_no_self_contact(const JsonValue& self) const {
    if (self.kind == JsonValue::Kind::literal && self.text == "false") return;
    if (self.kind == JsonValue::Kind::literal && self.text == "true")
      fail(self.line, "contact of the cloth with itself ('self') " + std::string(not_supported));
    wrong(self, "false");
  }

  Obstacle obstacle(const JsonValue& json) const {
    expect_members(json, {"plane", "sphere", "mesh", "velocity"});
    const JsonValue *flat = find(json, "plane"), *round = find(json, "sphere");
    if (const JsonValue* mesh = find(json, "mesh"))
      fail(mesh->key_line, "an obstacle that is a mesh " + std::string(not_supported));
    if (!flat == !round)
      fail(json.line,
           json.name + " has " + (flat ? "both" : "neither") + " 'plane' and 'sphere', expected one of them");
    Obstacle obstacle;
    if (flat) {
      obstacle.shape = plane(*flat);
    } else {
      obstacle.shape = sphere(*round);
    }
    if (const JsonValue* velocity = find(json, "velocity")) obstacle.velocity = vector(*velocity);
    return obstacle;
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
