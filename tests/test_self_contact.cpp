// Contact of a cloth with itself and with meshes: impulses are the nearest velocities that part what touches,
// take kinetic energy and keep momentum; no method's step ends in an intersection, by a checker that knows
// nothing of what finds contacts; friction is Coulomb's; where nothing touches nothing changes; and what is
// wrong with a scene's surfaces is said.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "analysis/method.h"
#include "experiments/inputs/subject.h"
#include "solvers/contact/contact_filter.h"
#include "solvers/contact/coupled_impulses.h"
#include "solvers/contact/cuts.h"
#include "solvers/contact/rigid_zones.h"
#include "solvers/contact/surface_pairs.h"
#include "solvers/simulation.h"
#include "tests/command.h"
#include "tests/dense.h"
#include "tests/intersections.h"
#include "tests/random_nets.h"
#include "tests/refusals.h"
#include "tests/resumed_contact.h"
#include "tests/scratch.h"

BOOST_AUTO_TEST_SUITE(self_contact)

using namespace springstab;
using Eigen::Vector3d;
using springstab::test::Corners;
using springstab::test::expect_error;
using springstab::test::expect_same_when_resumed;
using springstab::test::intersecting_triangles;
using springstab::test::random_vector;

namespace {

bool without_embree() {
  if (!has_embree()) BOOST_TEST_MESSAGE("without Embree there is no contact of surfaces");
  return !has_embree();
}

const char* const box = R"(v 0.06 -0.2 0.03
v 0.06 -0.2 0.5
v 0.06 -0.06 0.03
v 0.06 -0.04 0.5
v 0.5 -0.2 0.03
v 0.5 -0.2 0.5
v 0.5 -0.05 0.03
v 0.5 -0.03 0.5
f 1 2 4 3
f 5 7 8 6
f 1 5 6 2
f 3 4 8 7
f 1 3 7 5
f 2 6 8 4
)";

/// A sheet of squares of 0.03 m that is not quite flat: in one plane triangles meet within rounding.
std::string wavy(int rows, int columns) {
  std::string obj;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j)
      obj += "v " + std::to_string(0.03 * j) + ' ' + std::to_string(0.002 * std::sin(1.3 * i + 0.4 * j * j)) +
             ' ' + std::to_string(0.03 * i) + '\n';
  for (int i = 1; i < rows; ++i)
    for (int j = 1; j < columns; ++j) {
      const int at = (i - 1) * columns + j;
      obj += "f " + std::to_string(at) + ' ' + std::to_string(at + 1) + ' ' +
             std::to_string(at + columns + 1) + ' ' + std::to_string(at + columns) + '\n';
    }
  return obj;
}

/// A cloth over two edges of a box that is not level, with a floor beside it.
std::string over_a_box(const std::string& more = "") {
  return R"({"geometry": {"mesh": "sheet.obj"}, "damping": {"d0": 1, "alpha": 1e-4},
    "contact": {"obstacles": [{"mesh": "box.obj"}, {"plane": {"point": [0, -0.16, 0], "normal": [0, 1, 0.05]}}],
                "self": true, "thickness": 0.005, "friction": 0.3)" +
         more + "}}";
}

/// A strip that falls on its short side and folds.
std::string folding(const std::string& more = "") {
  return R"({"geometry": {"mesh": "strip.obj"}, "gravity": [0.1, -1, -9.81],
    "material": {"bending": 0.5}, "damping": {"d0": 1, "alpha": 1e-4}, "initial": {"velocity": [0, 0, -1]},
    "contact": {"obstacles": [{"plane": {"point": [0, 0, -0.02], "normal": [0, 0.1, 1]}}],
                "self": true, "thickness": 0.004, "friction": 0.3)" +
         more + "}}";
}

constexpr double nearest_allowed = 0.5 * (1 - 1e-9);  // thicknesses, to rounding: nearer is no way to go

/// A scene of a file beside a box.
struct Surfaces : test::ScratchFolder {
  Subject subject;
  std::vector<Corners> triangles;
  int of_cloth;

  explicit Surfaces(const std::string& scene) : subject(read(scene)) {
    const ClothSurface surface = subject.contact_surface().first;
    triangles = surface.triangles;
    of_cloth = static_cast<int>(triangles.size());
    int shift = static_cast<int>(subject.scene()->particles());
    for (const MeshObstacle& mesh : subject.contact()->meshes) {
      for (const Corners& t : mesh.triangles) triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
      shift += static_cast<int>(mesh.vertices.size());
    }
  }

  /// Of all surfaces, as the triangles name them.
  std::vector<Vector3d> places(double t, const Vector& x) const {
    std::vector<Vector3d> all;
    for (Eigen::Index i = 0; i < x.size(); i += 3) all.push_back(x.segment<3>(i));
    for (const Vector3d& place : subject.contact_surface().first.pinned) all.push_back(place);
    for (const MeshObstacle& mesh : subject.contact()->meshes)
      for (const Vector3d& vertex : mesh.vertices) all.push_back(vertex + t * mesh.velocity);
    return all;
  }

  /// Of the cloth with itself and with meshes, but for triangles that a floor has put in one plane.
  long intersections(double t, const Vector& x) const {
    long count = 0;
    const std::vector<Vector3d> all = places(t, x);
    for (const auto& [f, g] : intersecting_triangles(triangles, all))
      count += f < of_cloth && !are_in_one_plane(triangles[f], triangles[g], all);
    return count;
  }

  /// To 1e-9 m, of a thickness of 4e-3 m.
  static bool are_in_one_plane(const Corners& f, const Corners& g, const std::vector<Vector3d>& all) {
    const Vector3d n = (all[f[1]] - all[f[0]]).cross(all[f[2]] - all[f[0]]).normalized();
    return std::all_of(g.begin(), g.end(), [&](int i) { return std::abs(n.dot(all[i] - all[f[0]])) < 1e-9; });
  }

  /// Of a particle to a plane or ball [thicknesses].
  double nearest(double t, const Vector& x) const {
    double least = HUGE_VAL;
    for (const Obstacle& obstacle : subject.contact()->obstacles)
      for (Eigen::Index i = 0; i < x.size(); i += 3)
        least = std::min(least, gap_at(obstacle, x.segment<3>(i), t).gap);
    return least / subject.contact()->thickness;
  }

  double energy(const State<Vector>& s) {
    return subject.system().kinetic_energy(s.v) + subject.system().potential_energy(s.x);
  }

 private:
  Subject read(const std::string& scene) {
    file("box.obj", box);
    file("sheet.obj", wavy(8, 9));
    file("strip.obj", wavy(14, 4));
    file("table.obj",
         "v 0.05 -0.03 0.04\nv 0.19 -0.03 0.04\nv 0.19 -0.03 0.16\nv 0.05 -0.03 0.16\nf 1 2 3 4\n");
    return Subject(read_scene_file(file("scene.json", scene).string()));
  }
};

/// A run with a look at every step.
struct SurfaceRun {
  SimulationResult result;
  State<Vector> end;
  ContactCounts counts;
  long intersections = 0;
  double largest_gain = 0;    // of energy over the start, beyond what obstacles gave [J]
  double nearest = HUGE_VAL;  // of a particle to a plane or ball [thicknesses]
};

SurfaceRun run(Surfaces& scene, const std::string& method, double h, long steps) {
  Subject& subject = scene.subject;
  SurfaceRun run;
  run.end = subject.initial_state();
  const double first = scene.energy(run.end);
  const auto filter = subject.contact_filter();
  const EnergyWatch watch = with_obstacles(subject.energy_watch(run.end), *subject.contact());
  const Observer observe = [&](const RunSoFar& so_far, const State<Vector>& now) {
    run.intersections += scene.intersections(so_far.time, now.x);
    run.nearest = std::min(run.nearest, scene.nearest(so_far.time, now.x));
    run.largest_gain = std::max(run.largest_gain, scene.energy(now) - first - filter->counts().obstacle_work);
    return true;
  };
  run.result = simulate(subject.system(), *Method(method).stepper(), {h, steps}, watch, run.end, observe, {},
                        filter.get());
  run.counts = filter->counts();
  return run;
}

PairContact random_contact(test::RandomNets& random, int nodes) {
  PairContact c{{}, {}, Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)), 0};
  for (int k = 0; k < 4; ++k) {
    do c.nodes[k] = static_cast<int>(random.uniform(0, nodes));
    while (std::find(c.nodes.begin(), c.nodes.begin() + k, c.nodes[k]) != c.nodes.begin() + k);
  }
  c.normal.normalize();
  const double a = random.uniform(0, 1), b = random.uniform(0, 1 - a);
  if (random.uniform(0, 1) < 0.5)
    c.weights = {1, -a, -b, a + b - 1};
  else
    c.weights = {a, 1 - a, -b, b - 1};
  c.bound = -random.uniform(0, 0.5);
  return c;
}

double kinetic(const std::vector<Vector3d>& v, const std::vector<double>& inverse_mass) {
  double sum = 0;
  for (std::size_t i = 0; i < v.size(); ++i)
    if (inverse_mass[i] > 0) sum += v[i].squaredNorm() / inverse_mass[i] / 2;
  return sum;
}

Vector3d momentum(const std::vector<Vector3d>& v, const std::vector<double>& inverse_mass) {
  Vector3d sum(0, 0, 0);
  for (std::size_t i = 0; i < v.size(); ++i)
    if (inverse_mass[i] > 0) sum += v[i] / inverse_mass[i];
  return sum;
}

}  // namespace

// The conditions of the nearest velocity: all parting velocities at least what they must be, impulses that
// push, and only where it binds; to ten times what a last sweep may change.
BOOST_AUTO_TEST_CASE(coupled_impulses_lead_to_the_nearest_velocity_and_keep_momentum) {
  test::RandomNets random(3);
  for (int i = 0; i < 300; ++i) {
    const int nodes = 12, held = i % 3 == 0 ? 2 : 0;
    std::vector<double> inverse_mass;
    for (int k = 0; k < nodes; ++k) inverse_mass.push_back(k < held ? 0 : 1 / random.log_uniform(-1, 1));
    std::vector<PairContact> contacts;
    for (int k = 0; k < 6; ++k) contacts.push_back(random_contact(random, nodes));
    std::vector<Vector3d> v;
    for (int k = 0; k < nodes; ++k) v.push_back(k < held ? Vector3d::Zero() : random_vector(3, 100 * i + k));
    const std::vector<Vector3d> wanted = v;
    CoupledImpulses impulses(inverse_mass);
    const bool has_settled = impulses.solve(contacts, 0, v);
    BOOST_TEST(kinetic(v, inverse_mass) <= kinetic(wanted, inverse_mass) * (1 + 1e-14));
    if (held == 0) BOOST_TEST((momentum(v, inverse_mass) - momentum(wanted, inverse_mass)).norm() < 1e-13);
    if (!has_settled) continue;
    for (const PairContact& c : contacts) {
      const double parts = c.normal.dot(parting(c, v)) - c.bound;
      BOOST_TEST(c.r >= 0);
      BOOST_TEST(parts > -1e-4);
      BOOST_TEST(std::min(c.r * c.mobility, parts) < 1e-4);
    }
  }
}

// Eight contacts of six nodes, rough ones, of which sweeps with friction would give energy to some.
BOOST_AUTO_TEST_CASE(coupled_impulses_with_friction_give_no_energy) {
  test::RandomNets random(8);
  int unsettled = 0;
  for (int i = 0; i < 5000; ++i) {
    const int nodes = 6;
    std::vector<double> inverse_mass;
    for (int k = 0; k < nodes; ++k) inverse_mass.push_back(random.log_uniform(-1, 1));
    std::vector<Vector3d> v;
    for (int k = 0; k < nodes; ++k) v.push_back(random_vector(3, 100 * i + k));
    std::vector<PairContact> contacts;
    for (int k = 0; k < 8; ++k) contacts.push_back(random_contact(random, nodes));
    const double before = kinetic(v, inverse_mass);
    unsettled += !CoupledImpulses(inverse_mass).solve(contacts, 5, v);
    BOOST_TEST(kinetic(v, inverse_mass) <= before * (1 + 1e-14));
  }
  BOOST_TEST(unsettled > 0);
}

BOOST_AUTO_TEST_CASE(what_moves_as_one_keeps_momentum_and_loses_energy) {
  test::RandomNets random(4);
  for (int i = 0; i < 100; ++i) {
    std::vector<double> inverse_mass;
    std::vector<Vector3d> v;
    for (int k = 0; k < 12; ++k) {
      inverse_mass.push_back(1 / random.log_uniform(-1, 1));
      v.push_back(random_vector(3, 100 * i + k));
    }
    const std::vector<Vector3d> before = v;
    RigidZones zones(inverse_mass);
    BOOST_TEST(zones.join({0, 3, 5, 7}));
    BOOST_TEST(zones.join({5, 8, 8, 8}));
    BOOST_TEST(!zones.join({0, 8, 3, 3}));
    BOOST_TEST(zones.join({1, 2, 2, 2}));
    BOOST_TEST(zones.count() == 2);
    BOOST_TEST(zones.apply(v));
    BOOST_TEST((v[8] == v[0] && v[1] == v[2] && v[4] == before[4]));
    BOOST_TEST((momentum(v, inverse_mass) - momentum(before, inverse_mass)).norm() < 1e-13);
    BOOST_TEST(kinetic(v, inverse_mass) < kinetic(before, inverse_mass));
  }
  const std::vector<double> held{0, 1, 0};
  std::vector<Vector3d> v{Vector3d(1, 0, 0), Vector3d(5, 5, 5), Vector3d(2, 0, 0)};
  RigidZones zones(held);
  zones.join({0, 1, 1, 1});
  BOOST_TEST(zones.apply(v));
  BOOST_TEST((v[1] == v[0]));
  zones.join({1, 2, 2, 2});
  BOOST_TEST(!zones.apply(v));
}

// Against the checker, which decides by other determinants.
BOOST_AUTO_TEST_CASE(triangles_that_cut_each_other_are_found) {
  int cut_soups = 0;
  for (int soup = 0; soup < 400; ++soup) {
    const int triangles = 12;
    std::vector<Vector3d> x;
    std::vector<Corners> all;
    for (int i = 0; i < triangles; ++i) {
      const Vector3d center = random_vector(3, 1000 * soup + 4 * i);
      for (int c = 0; c < 3; ++c) x.push_back(center + 0.5 * random_vector(3, 1000 * soup + 4 * i + c + 1));
      all.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const auto pairs = intersecting_triangles(all, x);
    const auto cut = first_cut(all, all, x);
    BOOST_TEST(cut.has_value() == !pairs.empty());
    if (!cut || pairs.empty()) continue;
    ++cut_soups;
    BOOST_TEST((pairs[0] == std::array{cut->first, cut->second}));
    BOOST_TEST(cut->depth > 0);
    BOOST_TEST(cut->depth < 3);
  }
  BOOST_TEST(cut_soups > 100);
  BOOST_TEST(cut_soups < 390);
}

// Energy to first order in the step: of symplectic Euler in free fall it is hmgv/2 above.
BOOST_AUTO_TEST_CASE(no_step_of_any_method_ends_in_an_intersection, *boost::unit_test::label("slow")) {
  if (without_embree()) return;
  const double h = 8e-5;
  const std::pair<std::string, long> scenes[] = {{over_a_box(), 2500}, {folding(), 2500}};
  for (const Method& method : built_in_methods())
    for (const auto& [text, steps] : scenes) BOOST_TEST_CONTEXT(method.name() << text.substr(14, 40)) {
        Surfaces scene(text);
        const SurfaceRun done = run(scene, method.name(), h, steps);
        const double weight = 9.81 * scene.subject.scene()->total_free_mass();
        BOOST_TEST((done.result.status == StepStatus::done));
        BOOST_TEST(done.intersections == 0);
        BOOST_TEST(done.nearest > nearest_allowed);
        BOOST_TEST(done.counts.impulses > 1000);
        BOOST_TEST(done.counts.friction_work < 0);
        BOOST_TEST(done.largest_gain < 2 * h * weight);
        BOOST_TEST_MESSAGE(method.name()
                           << ": " << done.counts.impulses << " impulses, " << done.counts.lifts << " lifts, "
                           << done.counts.surfaces->zones << " zones, " << done.counts.unresolved
                           << " unresolved, gain " << done.largest_gain / (h * weight) << " hmg");
      }
}

// Until it has come to rest in layers, of which the floor bears all: lower than a third of the strip's
// length, and shorter than three quarters of it.
BOOST_AUTO_TEST_CASE(a_strip_that_folds_comes_to_lie_on_the_floor_without_an_intersection,
                     *boost::unit_test::label("slow")) {
  if (without_embree()) return;
  Surfaces scene(folding());
  const double h = 8e-5, length = 13 * 0.03;
  const SurfaceRun done = run(scene, "symplectic-euler", h, 20'000);
  BOOST_TEST((done.result.status == StepStatus::done));
  BOOST_TEST(done.intersections == 0);
  BOOST_TEST(done.nearest > nearest_allowed);
  BOOST_TEST(done.counts.surfaces->zones == 0);
  const double mass = scene.subject.scene()->total_free_mass();
  BOOST_TEST(scene.subject.system().kinetic_energy(done.end.v) < 1e-4 * mass * 9.81 * length);
  const Vector3d up = Vector3d(0, 0.1, 1).normalized(), along = Vector3d(0, 1, -0.1).normalized();
  double highest = 0, front = -HUGE_VAL, back = HUGE_VAL;
  for (const Vector3d& place : scene.subject.vertices(done.end.x)) {
    highest = std::max(highest, up.dot(place - Vector3d(0, 0, -0.02)));
    front = std::max(front, along.dot(place));
    back = std::min(back, along.dot(place));
  }
  BOOST_TEST_MESSAGE("it lies " << highest << " m high and " << front - back << " m long");
  BOOST_TEST(highest < length / 3);
  BOOST_TEST(front - back < 0.75 * length);
}

// Two strips without gravity, one thrown onto the other: every impulse is one on either side.
BOOST_AUTO_TEST_CASE(contact_of_a_cloth_with_itself_keeps_its_momentum_and_takes_kinetic_energy) {
  if (without_embree()) return;
  for (const char* more : {"", ", \"friction\": 0.5", ", \"model\": \"inelastic\""})
    BOOST_TEST_CONTEXT(more) {
      test::ScratchFolder folder;
      std::string mesh;
      for (int k = 0; k < 2; ++k)
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 5; ++j)
            mesh += "v " + std::to_string(0.03 * j + 0.017 * k) + ' ' +
                    std::to_string(0.02 * k + 0.003 * k * j) + ' ' + std::to_string(0.03 * i - 0.01 * k) +
                    '\n';
      for (int k = 0; k < 2; ++k)
        for (int i = 0; i < 3; ++i)
          for (int j = 1; j <= 4; ++j) {
            const int at = 20 * k + 5 * i + j;
            mesh += "f " + std::to_string(at) + ' ' + std::to_string(at + 1) + ' ' + std::to_string(at + 6) +
                    ' ' + std::to_string(at + 5) + '\n';
          }
      folder.file("strips.obj", mesh);
      Subject subject(read_scene_file(
          folder
              .file("scene.json", std::string(R"({"geometry": {"mesh": "strips.obj"}, "gravity": [0, 0, 0],
                    "contact": {"self": true, "thickness": 0.005)") +
                                      more + "}}")
              .string()));
      State<Vector> state = subject.initial_state(), before;
      for (Eigen::Index i = 60; i < 120; i += 3) state.v.segment<3>(i) = Vector3d(0.3, -1, 0.1);
      const std::vector<double>& mass = subject.scene()->free_masses();
      const auto momentum_of = [&](const Vector& v) {
        Vector3d sum(0, 0, 0);
        for (std::size_t i = 0; i < mass.size(); ++i)
          sum += mass[i] * v.segment<3>(3 * static_cast<Eigen::Index>(i));
        return sum;
      };
      const Vector3d first = momentum_of(state.v);
      const auto filter = subject.contact_filter();
      const auto stepper = Method("symplectic-euler").stepper();
      stepper->start(subject.system(), 1e-4, state);
      long pushed = 0;
      for (int i = 0; i < 600; ++i) {
        before = state;
        BOOST_REQUIRE((stepper->step(subject.system(), 1e-4, state) == StepStatus::done));
        const double kinetic_before = subject.system().kinetic_energy(state.v);
        const Vector3d momentum_before = momentum_of(state.v);
        pushed += filter->apply(1e-4 * (i + 1), 1e-4, before, state) == Filtered::changed;
        BOOST_TEST(subject.system().kinetic_energy(state.v) <= kinetic_before * (1 + 1e-12));
        BOOST_TEST((momentum_of(state.v) - momentum_before).norm() <= 1e-13 * first.norm());
      }
      BOOST_TEST(pushed > 20);
      BOOST_TEST(filter->counts().surfaces->zones == 0);
      BOOST_TEST((momentum_of(state.v) - first).norm() < 1e-12 * first.norm());
    }
}

namespace {

/// A patch of cloth on an incline of triangles that falls along x by θ, by gravity aslant.
std::string on_an_incline(double angle, double friction) {
  return R"({"geometry": {"grid": [3, 4], "spacing": 0.03}, "gravity": [)" +
         std::to_string(9.81 * std::sin(angle)) + ", " + std::to_string(-9.81 * std::cos(angle)) +
         R"(, 0], "contact": {"obstacles": [{"mesh": "box.obj"}], "thickness": 0.004, "friction": )" +
         std::to_string(friction) + "}}";
}

const char* const incline = R"(v -1 -0.00400001 -1
v 2 -0.00400001 -1.3
v -1 -0.00400001 1
v 2 -0.00400001 1.1
v 0.37 -0.00400001 0.07
f 1 5 2
f 2 5 4
f 4 5 3
f 3 5 1
)";

double slid(const std::string& scene, const std::string& method, double time, long steps) {
  test::ScratchFolder folder;
  folder.file("box.obj", incline);
  Subject subject(read_scene_file(folder.file("scene.json", scene).string()));
  State<Vector> state = subject.initial_state();
  const Vector start = state.x;
  const auto filter = subject.contact_filter();
  const EnergyWatch watch{.initial_energy = 1, .slack = 1e9};
  const SimulationResult result = simulate(subject.system(), *Method(method).stepper(),
                                           {time / double(steps), steps}, watch, state, {}, {}, filter.get());
  BOOST_TEST((result.status == StepStatus::done));
  double way = 0;
  for (Eigen::Index i = 0; i < state.x.size(); i += 3)
    way += (state.x[i] - start[i]) / double(state.x.size() / 3);
  return way;
}

}  // namespace

// The patch slides over a corner and edges of the incline's triangles, which are in one plane.
BOOST_AUTO_TEST_CASE(a_patch_on_an_incline_of_triangles_sticks_and_slides_as_coulomb_says) {
  if (without_embree()) return;
  const double friction = 0.4, g = 9.81, time = 0.4;
  for (const char* method : {"symplectic-euler", "rk4", "implicit-euler"}) BOOST_TEST_CONTEXT(method) {
      const double stays = slid(on_an_incline(std::atan(0.99 * friction), friction), method, time, 1000);
      BOOST_TEST(std::abs(stays) < 1e-6);
      const double angle = 0.6, pull = g * (std::sin(angle) - friction * std::cos(angle));
      const double slides = slid(on_an_incline(angle, friction), method, time, 1000);
      BOOST_TEST(std::abs(slides / (pull * time * time / 2) - 1) < 0.01);
      const double steep = std::atan(1.01 * friction);
      const double creeps = slid(on_an_incline(steep, friction), method, time, 1000);
      // 1 % of μ: half of it would be none, twice it twice as far
      const double slight = g * 0.01 * friction * std::cos(steep) * time * time / 2;
      BOOST_TEST(std::abs(creeps / slight - 1) < 0.5);
    }
}

BOOST_AUTO_TEST_CASE(where_surfaces_do_not_touch_nothing_changes) {
  if (without_embree()) return;
  const std::string scene = R"({"geometry": {"grid": [6, 7]}, "pins": [0, 6], "damping": {"d0": 0.5})";
  for (const char* method : {"symplectic-euler", "rk4", "newmark", "implicit-euler"})
    BOOST_TEST_CONTEXT(method) {
      State<Vector> ends[2];
      for (const bool with : {false, true}) {
        Subject subject(parse_scene(
            "scene.json", scene + (with ? ", \"contact\": {\"self\": true, \"thickness\": 0.002}}" : "}")));
        State<Vector> state = subject.initial_state();
        const EnergyWatch watch = subject.energy_watch(state);
        const auto filter = subject.contact_filter();
        BOOST_TEST((filter != nullptr) == with);
        simulate(subject.system(), *Method(method).stepper(), {1e-4, 500}, watch, state, {}, {},
                 filter.get());
        if (with) BOOST_TEST(filter->counts().impulses == 0);
        ends[with] = state;
      }
      BOOST_TEST((ends[0].x == ends[1].x && ends[0].v == ends[1].v));
    }
}

// What is kept of pairs is not part of a checkpoint.
BOOST_AUTO_TEST_CASE(a_run_of_surfaces_from_a_checkpoint_ends_in_the_same_bits) {
  if (without_embree()) return;
  for (const char* method : {"symplectic-euler", "bdf2", "rk4"}) BOOST_TEST_CONTEXT(method) {
      expect_same_when_resumed(
          [](const auto& run) {
            Surfaces scene(folding());
            run(scene.subject);
          },
          Method(method), 1200, 800);
    }
}

// The cloth is between a table that rises and a ceiling: it cannot pass, and the run says so.
BOOST_AUTO_TEST_CASE(where_obstacles_leave_no_way_the_run_stops_before_it) {
  if (without_embree()) return;
  Surfaces scene(R"({"geometry": {"mesh": "sheet.obj"}, "gravity": [0, 0, 0],
    "contact": {"obstacles": [{"mesh": "table.obj", "velocity": [0, 0.5, 0]},
                              {"plane": {"point": [0, 0.05, 0], "normal": [0, -1, 0]}}],
                "self": true, "thickness": 0.005}})");
  const SurfaceRun stopped = run(scene, "symplectic-euler", 2e-4, 3000);
  BOOST_TEST((stopped.result.status == StepStatus::not_converged));
  BOOST_TEST(stopped.counts.surfaces->blocked == 1);
  BOOST_TEST(stopped.intersections == 0);
  BOOST_TEST(stopped.nearest > nearest_allowed);
  // From 0.08 m to between one and two thicknesses.
  BOOST_TEST(stopped.result.time > 0.07 / 0.5 - 1e-3);
  BOOST_TEST(stopped.result.time < 0.075 / 0.5 + 1e-3);
}

BOOST_AUTO_TEST_CASE(what_is_wrong_with_surfaces_in_contact_is_said_with_its_line) {
  test::ScratchFolder folder;
  folder.file("box.obj", box);
  folder.file("ball.veg",
              "*VERTICES\n4 3 0 0\n1 0 -1 0\n2 1 -1 0\n3 0 -1 1\n4 0 -0.5 0\n*ELEMENTS\nTET\n1 4 "
              "0\n1 1 2 3 4\n");
  const auto refuse = [&](const std::string& contact, long line, const std::string& words,
                          const std::string& geometry = "{\"grid\": [3, 4]}") {
    const auto scene =
        folder.file("s.json", "{\"geometry\": " + geometry + ",\n\"contact\": " + contact + "}").string();
    expect_error([&] { Subject{read_scene_file(scene)}; }, scene + ":" + std::to_string(line), words);
  };
  refuse("{\"self\": 1}", 2, "'self' is 1, expected true or false");
  refuse("{\"self\": true}", 2,
         "'thickness' is zero or missing, expected a positive number of metres with 'self' or a mesh");
  refuse("{\"obstacles\": [{\"mesh\": 3}], \"thickness\": 0.001}", 2,
         "'mesh' is 3, expected the path of a mesh file");
  refuse("{\"self\": true,\n\"thickness\": 0.03}", 3,
         "'thickness' is 0.03 m, expected at most the edge 0-1 of 0.025 m");
  if (without_embree()) return refuse("{\"thickness\": 0.01,\n\"self\": true}", 3, embree_is_missing);
  expect_error(
      [&] {
        Subject{read_scene_file(folder
                                    .file("solid.json", R"({"geometry": {"grid": [3, 4]}, "contact": {
        "obstacles": [{"mesh": "ball.veg"}], "thickness": 0.001}})")
                                    .string())};
      },
      (folder.path() / "ball.veg").string(), "has tetrahedra, expected a surface as an obstacle");
  refuse("{\"thickness\": 0.01,\n\"self\": true}", 3,
         "the cloth has no faces, expected some for contact of surfaces", "{\"grid\": [1, 5]}");
  refuse("{\"thickness\": 0.02,\n\"self\": true}", 3,
         "the cloth is 0.0176777 m from itself at the start, at particle ");
  refuse("{\"thickness\": 0.05, \"obstacles\": [\n{\"mesh\": \"box.obj\"}]}", 3,
         "obstacle 0 (box.obj) is 0.0", "{\"grid\": [3, 4], \"spacing\": 0.1}");
  folder.file("post.obj", "v 0.11 -1 0.12\nv 0.13 -1 0.12\nv 0.12 0.3 0.13\nf 1 2 3\n");
  refuse(
      "{\"thickness\": 0.001, \"obstacles\": [{\"plane\": {\"point\": [0, -1, 0], \"normal\": [0, 1, "
      "0]}},\n{\"mesh\": \"post.obj\"}]}",
      3, "obstacle 1 (post.obj) cuts face 4 of the cloth at the start, ",
      "{\"grid\": [3, 4], \"spacing\": 0.1}");
  folder.file("cross.obj",
              "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 -1 -0.9\nv 0 1 -0.9\nv 0.01 0.2 0.7\nf 1 2 3 4\nf "
              "5 6 7\n");
  refuse("{\"thickness\": 0.001,\n\"self\": true}", 3, "face 0 of the cloth cuts its face 1 at the start, ",
         "{\"mesh\": \"cross.obj\"}");
}

BOOST_FIXTURE_TEST_CASE(limits_and_simulate_say_what_contact_of_surfaces_does, test::Command) {
  if (without_embree()) return;
  file("box.obj", box);
  file("sheet.obj", wavy(8, 9));
  file("open.obj", std::string(box).substr(0, std::string(box).rfind("f 2")));
  file("scene.json", over_a_box());
  std::string open = over_a_box();
  open.replace(open.find("box.obj"), 7, "open.obj");
  file("open.json", open);
  const auto limits = (*this)("limits scene.json --json").json().at("contact");
  BOOST_TEST(limits.at("proved").empty());
  BOOST_TEST(limits.at("obstacles") == 2);
  BOOST_TEST(limits.at("self") == true);
  const test::Outcome closed = (*this)("simulate scene.json --method symplectic-euler --duration 0.4 --json");
  const auto report = closed.json();
  BOOST_TEST(closed.err.find("watertight") == std::string::npos);
  BOOST_TEST(report.at("status") == "done");
  BOOST_TEST(report.at("counts").at("contact").at("impulses").get<long>() > 0);
  BOOST_TEST(report.at("counts").at("contact").at("blocked") == 0);
  BOOST_TEST(report.at("energy").at("contact").at("friction_work").get<double>() < 0);
  const test::Outcome noted = (*this)("simulate open.json --method rk4 --duration 0.1 --explain");
  BOOST_TEST(noted.status == 0);
  BOOST_TEST(noted.err.find("open.obj: is not watertight: it is met as a surface, and has no inside") !=
             std::string::npos);
  BOOST_TEST(noted.out.find("contact of surfaces") != std::string::npos);
  const auto two =
      (*this)("simulate scene.json --method symplectic-euler --duration 0.4 --json --threads 2").json();
  BOOST_TEST(two.at("counts").at("contact") == report.at("counts").at("contact"));
  BOOST_TEST(two.at("last_particle") == report.at("last_particle"));
}

BOOST_AUTO_TEST_SUITE_END()
