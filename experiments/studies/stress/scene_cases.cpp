// The catalogue's scenes of springs and triangles, and its meshes.
#include "experiments/studies/stress/catalogue_parts.h"

namespace springstab {
namespace {

/// A scene file, and beside it mesh.obj where there is one.
std::function<InputOptions(const std::string&)> scene(std::string json, std::string obj = "") {
  return [json = std::move(json), obj = std::move(obj)](const std::string& folder) {
    InputOptions input;
    input.file = folder + "/scene.json";
    write_text(input.file, json);
    if (!obj.empty()) write_text(folder + "/mesh.obj", obj);
    return input;
  };
}

std::function<InputOptions(const std::string&)> mesh(const std::string& obj, const std::string& more) {
  return scene(R"({"geometry": {"mesh": "mesh.obj"}, )" + more + "}", obj);
}

constexpr char quad[] = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\n";
constexpr char two_triangles[] = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3\nf 1 3 4\n";
constexpr char springs[] = R"("material": {"structural": 10, "shear": 5, "bending": 1}, )";
constexpr char cloth_material[] =
    R"("material": {"model": "baraff-witkin", "stretch": 10, "shear": 1, "bending": 1e-3}, )";
constexpr char drag[] = R"("damping": {"d0": 1, "alpha": 1e-3})";

void add_scenes(std::vector<StressCase>& all) {
  const auto grid = [&](const std::string& name, const Expectation& expected, double duration,
                        const std::string& size, const std::string& more, bool compared = true) {
    all.push_back({"scene", name, expected,
                   scene(R"({"geometry": {"grid": )" + size + R"(, "spacing": 0.1})" +
                         (more.empty() ? "" : ", " + more) + "}"),
                   duration, std::nullopt, compared});
  };
  const std::string pinned = R"("pins": "first-row", )", s = springs, d = drag;
  grid("one particle", damped, 0.5, "[1, 1]", "");
  grid("one particle, air drag", damped, 0.5, "[1, 1]", R"("damping": {"d0": 2})");
  grid("one particle, pinned", impossible, 0.5, "[1, 1]", R"("pins": "0")");
  grid("everything pinned", impossible, 0.5, "[2, 2]", R"("pins": "corners")");
  grid("everything pinned but one", damped, 0.1, "[3, 3]", s + R"("pins": "0-3,5-8", )" + d);
  grid("no pins: free fall", damped, 0.5, "[3, 3]", s + d);
  grid("undamped", undamped, 0.1, "[4, 4]",
       pinned + R"("material": {"structural": 10, "shear": 5, "bending": 1})");
  grid("let go flat", damped, 0.2, "[4, 4]", s + pinned + d);
  grid("at rest without gravity", undamped, 0.2, "[4, 4]",
       cloth_material + pinned + R"("gravity": [0, 0, 0])", false);
  grid("slack: all springs at half length", damped, 0.01, "[4, 4]",
       s + pinned + d + R"(, "initial": {"stretch": [0.5, 1, 0.5]})");
  grid("compressed to a hundredth", damped, 1e-3, "[4, 4]",
       s + pinned + d + R"(, "initial": {"stretch": [0.01, 1, 0.01]})");
  grid("all particles at one place", impossible, 0.01, "[4, 4]",
       s + pinned + d + R"(, "initial": {"stretch": [0, 0, 0]})");
  grid("stretched tenfold", damped, 0.05, "[4, 4]",
       s + pinned + d + R"(, "initial": {"stretch": [10, 1, 10]})");
  grid("inverted", impossible, 0.05, "[4, 4]", s + pinned + d + R"(, "initial": {"stretch": [-1, 1, 1]})");
  grid("impulse of 10³ m/s", damped, 1e-3, "[4, 4]",
       s + pinned + d + R"(, "initial": {"velocity": [0, 1000, 0]})");
  grid("impulse of 10⁶ m/s", damped, 1e-6, "[4, 4]",
       s + pinned + d + R"(, "initial": {"velocity": [0, 1e6, 0]})");
  grid("impulse of 10⁶ m/s, long", damped, 1e-2, "[4, 4]",
       s + pinned + d + R"(, "initial": {"velocity": [0, 1e6, 0]})");
  grid("gravity of 10⁶ m/s²", damped, 0.01, "[4, 4]", s + pinned + d + R"(, "gravity": [0, -1e6, 0])");
  grid("springs of 1e12 N/m", undamped, 1e-6, "[4, 4]",
       R"("material": {"structural": 1e12, "shear": 1e12, "bending": 1e12}, "pins": "first-row")");
  grid("springs of 1e-12 N/m", undamped, 1, "[4, 4]",
       R"("material": {"structural": 1e-12, "shear": 1e-12, "bending": 1e-12}, "pins": "first-row")");
  grid("bending 10⁶ times stiffer", damped, 0.01, "[4, 4]",
       R"("material": {"structural": 1, "shear": 1, "bending": 1e6}, )" + pinned +
           R"("damping": {"d0": 1, "alpha": 1e-6})");
  grid("no springs at all", damped, 0.5, "[3, 3]",
       R"("material": {"structural": 0, "shear": 0, "bending": 0}, "pins": "first-row")");
  grid("particles of 1e-12 kg", undamped, 1e-6, "[4, 4]",
       R"("material": {"particle_mass": 1e-12}, "pins": "first-row")");
  grid("particles of 1e12 kg", undamped, 1, "[4, 4]",
       R"("material": {"particle_mass": 1e12}, "pins": "first-row")");
  grid(
      "dampers, overdamped", damped, 0.05, "[4, 4]",
      R"("material": {"structural": 10, "shear": 5, "bending": 1, "damping": {"structural": 1, "shear": 1, "bending": 1}}, )" +
          pinned + R"("damping": {"d0": 1})");
  grid("air drag of 10⁶ 1/s", damped, 1e-3, "[4, 4]", s + pinned + R"("damping": {"d0": 1e6})");
  grid("negative air drag", impossible, 0.1, "[4, 4]", s + pinned + R"("damping": {"d0": -1})");
  grid("negative spring", impossible, 0.1, "[4, 4]", R"("material": {"structural": -1})");
  grid("mass of 0", impossible, 0.1, "[4, 4]", R"("material": {"particle_mass": 0})");
  grid("stiffness beyond double", impossible, 0.1, "[4, 4]", R"("material": {"structural": 1e309})");
  grid("designed damping", damped, 0.05, "[4, 4]",
       s + pinned + R"("damping": {"d0": 1, "alpha": "designed"})");
  grid("a row of 300", damped, 0.02, "[300, 1]", s + R"("pins": "0", )" + d);
  grid("10⁵ particles", damped, 2e-3, "[316, 317]",
       R"("pins": "first-row", "damping": {"d0": 1, "alpha": 1e-3})", false);
  grid("10⁹ particles", impossible, 0.1, "[100000, 10000]", "");

  const auto add = [&](const std::string& name, const Expectation& expected, const std::string& obj,
                       const std::string& material, double duration = 0.05) {
    all.push_back({"mesh", name, expected, mesh(obj, material + R"("pins": "0", )" + d), duration});
  };
  const std::string c = cloth_material;
  add("triangles", damped, two_triangles, c);
  add("a quad of springs", damped, quad, s);
  add("two pieces", damped, std::string(quad) + "v 5 0 0\nv 6 0 0\nv 6 0 1\nf 5 6 7\n", s);
  add("two pieces of triangles", damped, std::string(two_triangles) + "v 5 0 0\nv 6 0 0\nv 6 0 1\nf 5 6 7\n",
      c);
  add("opposite windings", damped, "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3\nf 1 4 3\n", c);
  add("a triangle twice", damped, std::string(two_triangles) + "f 1 2 3\n", c);
  add("a triangle twice, springs", damped, std::string(two_triangles) + "f 1 2 3\n", s);
  add("three triangles at an edge", damped, std::string(two_triangles) + "v 0.5 1 0.5\nf 1 3 5\n", c);
  add("three triangles at an edge, springs", damped, std::string(two_triangles) + "v 0.5 1 0.5\nf 1 3 5\n",
      s);
  add("a sliver, 10⁵ : 1", damped, "v 0 0 0\nv 1 0 0\nv 0.5 0 1e-5\nf 1 2 3\n", s, 1e-3);
  add("a triangle sliver, 10³ : 1", damped, "v 0 0 0\nv 1 0 0\nv 0.5 0 1e-3\nf 1 2 3\n", c, 1e-3);
  add("a triangle without area", impossible, "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", c);
  add("an edge of length 0", impossible, "v 0 0 0\nv 1 0 0\nv 1 0 0\nf 1 2 3\n", s);
  add("an edge of 1e-9 m", damped, "v 0 0 0\nv 1 0 0\nv 1 0 1e-9\nf 1 2 3\n", s, 1e-4);
  add("a corner twice", impossible, "v 0 0 0\nv 1 0 0\nf 1 2 2\n", s);
  add("a corner that is not there", impossible, "v 0 0 0\nv 1 0 0\nf 1 2 3\n", s);
  add("a vertex without a face", damped, std::string(quad) + "v 9 9 9\n", s);
  add("NaN in a vertex", impossible, "v 0 0 nan\nv 1 0 0\nv 1 0 1\nf 1 2 3\n", s);
  add("no faces", impossible, "v 0 0 0\nv 1 0 0\nv 1 0 1\n", s);
  add("1e-9 m small", damped, "v 0 0 0\nv 1e-9 0 0\nv 1e-9 0 1e-9\nf 1 2 3\n",
      R"("material": {"structural": 10, "shear": 5, "bending": 1, "particle_mass": 1e-3}, )");
  add("1e9 m large", damped, "v 0 0 0\nv 1e9 0 0\nv 1e9 0 1e9\nf 1 2 3\n",
      R"("material": {"structural": 10, "shear": 5, "bending": 1, "particle_mass": 1e-3}, )");
}

}  // namespace

std::vector<StressCase> scene_cases() {
  std::vector<StressCase> all;
  add_scenes(all);
  return all;
}

}  // namespace springstab
