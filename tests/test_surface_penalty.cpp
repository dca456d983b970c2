// Springs and dampers between surfaces: forces are the energy's gradient, K and C the derivatives of forces,
// however two places lie to each other; what touches counts once and its force does not jump from face to
// face; momentum is kept; what contact adds to K and D is bounded, and limits with it are true; a cloth that
// falls on itself is planned for, rests on its springs, and a run that goes on ends in the same bits.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "analysis/method.h"
#include "analysis/structure_limits.h"
#include "experiments/contact_report.h"
#include "experiments/inputs/subject.h"
#include "experiments/runs/contact_steps.h"
#include "experiments/runs/step_run.h"
#include "solvers/contact/jet.h"
#include "solvers/contact/surface_penalty.h"
#include "solvers/scene/scene.h"
#include "tests/command.h"
#include "tests/dense.h"
#include "tests/loop_threads.h"
#include "tests/random_nets.h"
#include "tests/refusals.h"
#include "tests/scratch.h"

BOOST_AUTO_TEST_SUITE(surface_penalty)

using namespace springstab;
using boost::test_tools::tolerance;
using Eigen::Vector3d;
using springstab::test::expect_error;
using springstab::test::random_vector;

namespace {

bool lacks_embree() {
  if (!has_embree()) BOOST_TEST_MESSAGE("without Embree there is no contact of surfaces");
  return !has_embree();
}

constexpr TouchKind all_kinds[] = {TouchKind::vertex_vertex, TouchKind::vertex_edge, TouchKind::vertex_face,
                                   TouchKind::edge_edge};

Vector3d random_place(test::RandomNets& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

/// Four places that touch within what the kind says, nearer than 0.9 and no sliver.
FourPlaces random_touch(test::RandomNets& random, TouchKind kind) {
  while (true) {
    FourPlaces x;
    for (Vector3d& place : x) place = random_place(random);
    const TouchPlaces at = touch_places(kind, x);
    bool within = at.distance > 0.1 && at.distance < 0.9;
    const bool edges = kind == TouchKind::edge_edge;
    for (int k = 0; k < 4; ++k) within = within && (k < (edges ? 2 : 1) ? 1 : -1) * at.weights[k] >= 0;
    const PairDirections p = pair_directions(edges ? PairKind::edge_edge : PairKind::vertex_face, x);
    within = within && at.share > 1e-3;
    if (within && p.u.cross(p.w).norm() > 0.2 && p.u.norm() > 0.3) return x;
  }
}

FourPlaces moved(const FourPlaces& x, const Eigen::Vector<double, 12>& by) {
  FourPlaces to;
  for (int k = 0; k < 4; ++k) to[k] = x[k] + by.segment<3>(3 * k);
  return to;
}

/// Central differences at h are off by h²/6 third derivatives and rounding/h; what is left of both in
/// Richardson's (4 d(h/2) - d(h))/3 is h⁴.
template <class Of>
auto differenced(const Of& of, double h) {
  const auto central = [&](double e) { return ((of(e) - of(-e)) / (2 * e)).eval(); };
  return ((4 * central(h / 2) - central(h)) / 3).eval();
}

/// A patch of triangles of 0.03 m, aslant in its squares and bent by `bend`, at an angle about y and at a
/// height; numbers go on.
void add_sheet(std::string& obj, int rows, int columns, double bend, double angle, double height,
               int& vertices) {
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double x = 0.03 * (j - (columns - 1) / 2.), z = 0.03 * (i - (rows - 1) / 2.);
      const double y = height + bend * std::sin(1.3 * i + 0.4 * j * j);
      obj += "v " + std::to_string(std::cos(angle) * x + std::sin(angle) * z) + ' ' + std::to_string(y) +
             ' ' + std::to_string(std::cos(angle) * z - std::sin(angle) * x) + '\n';
    }
  for (int i = 1; i < rows; ++i)
    for (int j = 1; j < columns; ++j) {
      const int at = vertices + (i - 1) * columns + j, below = at + columns;
      const auto face = [&](int a, int b, int c) {
        obj += "f " + std::to_string(a) + ' ' + std::to_string(b) + ' ' + std::to_string(c) + '\n';
      };
      face(at, at + 1, below + 1), face(at, below + 1, below);
    }
  vertices += rows * columns;
}

/// Two sheets, one above the other, over a table, apart by 0.008 m.
struct TwoSheets : test::ScratchFolder {
  Subject subject;

  explicit TwoSheets(const std::string& model, const std::string& more = "", double bend = 0.0004,
                     const std::string& self = "true")
      : subject(read(model, more, bend, self)) {}

  Scene& scene() { return *subject.scene(); }

  /// With the upper one lowered by so much, turned a little, and all places off by up to `noise` [m].
  State<Vector> lowered(double by, double noise, std::uint64_t seed) {
    State<Vector> state = subject.initial_state();
    const Eigen::Index half = state.x.size() / 2;
    for (Eigen::Index i = half; i < state.x.size(); i += 3) state.x[i + 1] -= by;
    state.x += noise * random_vector(state.x.size(), seed);
    state.v = random_vector(state.x.size(), seed + 1);
    return state;
  }

 private:
  Subject read(const std::string& model, const std::string& more, double bend, const std::string& self) {
    std::string obj;
    int vertices = 0;
    add_sheet(obj, 5, 6, bend, 0, 0, vertices);
    add_sheet(obj, 5, 6, bend, 0.4, 0.008, vertices);
    file("sheets.obj", obj);
    file("table.obj",
         "v -0.2 -0.008 -0.21\nv 0.21 -0.008 -0.2\nv -0.2 -0.008 0.2\nv 0.2 -0.008 0.21\nf 1 2 4\nf 1 4 3\n");
    return Subject(read_scene_file(
        file("scene.json", R"({"geometry": {"mesh": "sheets.obj"}, "damping": {"d0": 2, "alpha": 0},
          "material": {"area_density": 0.2, "structural": 200, "shear": 100, "bending": 1},
          "contact": {"self": )" +
                               self + R"(, "obstacles": [{"mesh": "table.obj"}], "thickness": 0.005, "model":
          {"penalty": )" + model +
                               "}" + more + "}}")
            .string()));
  }
};

const ElasticTerm& springs_of(Scene& scene) {
  const ElasticTerm& springs = *scene.terms().elastic.back();
  BOOST_REQUIRE(springs.name() == "contact springs of surfaces");
  return springs;
}

Vector force_of(Scene& scene, const Vector& x) {
  Vector f = Vector::Zero(x.size());
  springs_of(scene).add_force(scene.position_field(x), f.data());
  return f;
}

SurfaceTouches touches_of(const Subject& subject) {
  return {*subject.contact(), subject.scene()->free_particles(), subject.contact_surface().first};
}

/// Σ c s (w wᵀ) ⊗ (n nᵀ), with or without those that count negatively.
Eigen::MatrixXd held_stiffness(const SurfaceTouches& touches, bool all) {
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(3 * touches.free_count(), 3 * touches.free_count());
  for (const Touch& touch : touches.touches()) {
    if (touch.count < 0 && !all) continue;
    const TouchPlaces at = touch_places(touch.kind, touches.places(touch));
    Eigen::VectorXd rate = Eigen::VectorXd::Zero(k.rows());
    for (int i = 0; i < 4; ++i)
      if (touch.particles[i] < touches.free_count())
        rate.segment<3>(3 * touch.particles[i]) += at.weights[i] * at.normal;
    k += touch.count * at.share * rate * rate.transpose();
  }
  return k;
}

Eigen::MatrixXd own_damping_at(Scene& scene, const State<Vector>& state) {
  return Eigen::MatrixXd(scene.linearization(state)->own_damping()->to_sparse());
}

Vector3d momentum_of(Scene& scene, const Vector& v) {
  Vector3d sum(0, 0, 0);
  for (int i = 0; i < scene.free_particles(); ++i) sum += scene.free_masses()[i] * v.segment<3>(3 * i);
  return sum;
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_jet_has_the_derivatives_of_what_it_went_through) {
  const double a = 0.7, b = -1.3;
  const auto x = Jet<2, true>::variable(a, 0), y = Jet<2, true>::variable(b, 1);
  const auto f = 2. * x / (1. - y) - sqrt(x * y * y) + x;
  BOOST_TEST(f.value == 2 * a / (1 - b) + b * std::sqrt(a) + a, tolerance(1e-14));  // √b² = -b
  BOOST_TEST(f.first[0] == 2 / (1 - b) + b / 2 / std::sqrt(a) + 1, tolerance(1e-14));
  BOOST_TEST(f.first[1] == 2 * a / std::pow(1 - b, 2) + std::sqrt(a), tolerance(1e-14));
  BOOST_TEST(f.second(0, 0) == -b / 4 * std::pow(a, -1.5), tolerance(1e-14));
  BOOST_TEST(f.second(0, 1) == 2 / std::pow(1 - b, 2) + 0.5 / std::sqrt(a), tolerance(1e-14));
  BOOST_TEST(f.second(1, 1) == 4 * a / std::pow(1 - b, 3), tolerance(1e-13));
  BOOST_TEST((f.second - f.second.transpose()).norm() < 1e-15);
}

BOOST_AUTO_TEST_CASE(a_touch_has_the_gradient_and_hessian_of_its_energy_and_neither_force_nor_moment) {
  test::RandomNets random(5);
  const TouchSpring spring{3, 1};
  for (const TouchKind kind : all_kinds)
    for (int i = 0; i < 50; ++i) {
      const FourPlaces x = random_touch(random, kind);
      const Eigen::Vector<double, 12> u = random_vector(12, i);
      const FourVectors g = spring.gradient(kind, x);
      const auto h = spring.hessian(kind, x);
      const auto energy = [&](double e) {
        return Eigen::Vector<double, 1>(spring.energy(kind, moved(x, e * u)));
      };
      const auto gradient = [&](double e) {
        return Eigen::Vector<double, 12>(spring.gradient(kind, moved(x, e * u)).reshaped());
      };
      BOOST_TEST(g.norm() > 1e-6);
      BOOST_TEST(std::abs(differenced(energy, 1e-3)[0] - g.reshaped().dot(u)) < 1e-7 * h.norm());
      BOOST_TEST((differenced(gradient, 1e-3) - h * u).norm() < 1e-6 * h.norm());
      BOOST_TEST((h - h.transpose()).norm() < 1e-12 * h.norm());
      BOOST_TEST(g.rowwise().sum().norm() < 1e-13 * g.norm());
      Vector3d moment(0, 0, 0);
      for (int k = 0; k < 4; ++k) moment += x[k].cross(Vector3d(g.col(k)));
      BOOST_TEST(moment.norm() < 1e-12 * g.norm());
      // In the linearization with n, w and s held. What it leaves out acts on the overlap alone.
      const TouchPlaces at = touch_places(kind, x);
      Vector3d between(0, 0, 0);
      for (int k = 0; k < 4; ++k) between += at.weights[k] * x[k];
      BOOST_TEST((between - at.distance * at.normal).norm() < 1e-12);
      BOOST_TEST(spring.energy(kind, x) == 1.5 * at.share * std::pow(1 - at.distance, 2), tolerance(1e-10));
    }
}

// With U = Σ w u how a vertex and a face part in a motion u, and G the slopes by which the face then rises
// along n: uᵀHu = k_c ((n·U)² + (t - d)(2 U·G + d |G|²)), what is beyond the held linearization without a
// bound.
BOOST_AUTO_TEST_CASE(what_turning_adds_to_the_stiffness_of_a_vertex_and_a_face_is_known) {
  test::RandomNets random(6);
  for (int i = 0; i < 50; ++i) {
    const FourPlaces x = random_touch(random, TouchKind::vertex_face);
    const Eigen::Vector<double, 12> u = random_vector(12, i);
    const TouchPlaces at = touch_places(TouchKind::vertex_face, x);
    FourPlaces by;
    for (int k = 0; k < 4; ++k) by[k] = u.segment<3>(3 * k);
    Vector3d parting(0, 0, 0);
    for (int k = 0; k < 4; ++k) parting += at.weights[k] * by[k];
    Eigen::Matrix3d directions;
    directions << (x[2] - x[1]).transpose(), (x[3] - x[1]).transpose(), at.normal.transpose();
    const Vector3d slopes =
        directions.inverse() * Vector3d(at.normal.dot(by[2] - by[1]), at.normal.dot(by[3] - by[1]), 0);
    const double expected =
        std::pow(at.normal.dot(parting), 2) +
        (1 - at.distance) * (2 * parting.dot(slopes) + at.distance * slopes.squaredNorm());
    const auto h = TouchSpring{3, 1}.hessian(TouchKind::vertex_face, x);
    BOOST_TEST(std::abs(u.dot(h * u) - 3 * expected) < 1e-10 * h.norm());
  }
}

// As edges become parallel their force goes to nothing, and where one comes closest at its end there is none.
BOOST_AUTO_TEST_CASE(edges_that_are_parallel_or_meet_at_an_end_do_not_push) {
  const TouchSpring spring{3, 1};
  double last = 1;
  for (const double angle : {1e-1, 1e-2, 1e-3, 1e-4}) {
    const FourPlaces x{Vector3d(-1, 0, 0), Vector3d(1, 0, 0.1),
                       Vector3d(-std::cos(angle), 0.5, -std::sin(angle)),
                       Vector3d(std::cos(angle), 0.5, std::sin(angle) + 0.1)};
    const double force = spring.gradient(TouchKind::edge_edge, x).norm();
    BOOST_TEST(force < 3 * angle);
    BOOST_TEST(force < last);
    last = force;
  }
  for (const double past : {1e-2, 1e-3, 1e-4}) {
    const FourPlaces x{Vector3d(-past, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 0.5, -1), Vector3d(0, 0.5, 1)};
    BOOST_TEST(spring.gradient(TouchKind::edge_edge, x).norm() < 100 * past);
  }
}

namespace {

/// A vertex, with two more of its triangle far above, over a sheet.
struct VertexOverSheet {
  ClothSurface surface;
  std::vector<Vector3d> sheet;
  Contact contact;

  explicit VertexOverSheet(double bend) {
    constexpr int rows = 5, columns = 6;
    contact.self = true;
    contact.thickness = 0.4;
    contact.model = Penalty{1, 0};
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j)
        sheet.push_back(
            {double(j) + 0.1 * std::sin(3. * i), bend * std::sin(1.3 * i + 0.9 * j * j), double(i)});
    for (int i = 1; i < rows; ++i)
      for (int j = 1; j < columns; ++j) {
        const int at = (i - 1) * columns + j - 1, below = at + columns;
        surface.triangles.push_back({at, at + 1, below + 1});
        surface.triangles.push_back({at, below + 1, below});
      }
    const int v = rows * columns;
    surface.triangles.push_back({v, v + 1, v + 2});
  }

  Vector at(const Vector3d& vertex) const {
    Vector x(3 * (sheet.size() + 3));
    for (std::size_t i = 0; i < sheet.size(); ++i) x.segment<3>(3 * i) = sheet[i];
    x.tail<9>() << vertex, vertex + Vector3d(0.3, 5, 0.1), vertex + Vector3d(-0.2, 5, 0.4);
    return x;
  }
};

/// Of all that touches, or of what the vertex touches alone, energy and force on it.
struct OverSheet {
  SurfaceTouches touches;
  const VertexOverSheet& sheet;
  int vertex;
  bool alone;

  OverSheet(const VertexOverSheet& s, bool is_alone)
      : touches(s.contact, static_cast<int>(s.sheet.size()) + 3, s.surface),
        sheet(s),
        vertex(static_cast<int>(s.sheet.size())),
        alone(is_alone) {}

  template <class Visit>
  void for_each(const Vector3d& place, const Visit& visit) {
    touches.find(sheet.at(place));
    for (const Touch& touch : touches.touches())
      if (!alone || touch.particles[0] == vertex)
        visit(touch, TouchSpring{1, sheet.contact.thickness}, touches.places(touch));
  }
  double energy(const Vector3d& place) {
    double sum = 0;
    for_each(place, [&](const Touch& touch, const TouchSpring& spring, const FourPlaces& x) {
      sum += touch.count * spring.energy(touch.kind, x);
    });
    return sum;
  }
  Vector3d force(const Vector3d& place) {
    Vector3d sum(0, 0, 0);
    for_each(place, [&](const Touch& touch, const TouchSpring& spring, const FourPlaces& x) {
      const FourVectors g = spring.gradient(touch.kind, x);
      for (int k = 0; k < 4; ++k)
        if (touch.particles[k] == vertex) sum -= touch.count * g.col(k);
    });
    return sum;
  }
};

}  // namespace

// Over faces, edges and vertices of a flat sheet, and beside its border, where it is the border that is near.
BOOST_AUTO_TEST_CASE(what_touches_counts_once_wherever_it_is_on_a_sheet) {
  if (lacks_embree()) return;
  const VertexOverSheet sheet(0);
  OverSheet over(sheet, true);
  const double t = sheet.contact.thickness;
  for (const Vector3d& corner : {sheet.sheet[8], sheet.sheet[14]})
    for (const Vector3d& along : {Vector3d(0, 0, 0), Vector3d(0.5, 0, 0), Vector3d(0.3, 0, 0.2),
                                  Vector3d(0.01, 0, 0.02), Vector3d(-0.2, 0, 0.001)}) {
      const Vector3d vertex = corner + along + Vector3d(0, 0.15, 0);
      BOOST_TEST(over.energy(vertex) == std::pow(t - 0.15, 2) / 2, tolerance(1e-12));
      BOOST_TEST((over.force(vertex) - Vector3d(0, t - 0.15, 0)).norm() < 1e-12);
    }
  const Vector3d border(2.3, 0.15, -0.2);  // beyond the first row
  const double distance = std::hypot(0.15, 0.2);
  BOOST_TEST(over.energy(border) == std::pow(t - distance, 2) / 2, tolerance(1e-12));
  BOOST_TEST((over.force(border) - (t - distance) * Vector3d(0, 0.15, -0.2) / distance).norm() < 1e-12);
}

// Along lines over hills and valleys the force changes by no more than so much a way: by a tenth in a tenth.
BOOST_AUTO_TEST_CASE(the_force_of_a_vertex_does_not_jump_and_is_the_energys_gradient) {
  if (lacks_embree()) return;
  const VertexOverSheet sheet(0.25);
  OverSheet over(sheet, false);
  test::RandomNets random(11);
  const auto largest_change = [&](const Vector3d& from, const Vector3d& to, int steps) {
    double largest = 0;
    Vector3d last = over.force(from);
    for (int i = 1; i <= steps; ++i) {
      const Vector3d now = over.force(from + double(i) / steps * (to - from));
      largest = std::max(largest, (now - last).norm());
      last = now;
    }
    return largest;
  };
  int near = 0;
  for (int i = 0; i < 8; ++i) {
    const Vector3d from(random.uniform(0.5, 1), random.uniform(0.35, 0.5), random.uniform(0.2, 3.8)),
        to(random.uniform(4, 4.5), random.uniform(0.35, 0.5), random.uniform(0.2, 3.8));
    const double coarse = largest_change(from, to, 400), fine = largest_change(from, to, 4000);
    BOOST_TEST(fine < 0.2 * coarse + 1e-12);
    near += coarse > 1e-4;
    const Vector3d u = random_vector(3, i), middle = from + 0.43 * (to - from);
    const double e = 1e-6, slope = (over.energy(middle + e * u) - over.energy(middle - e * u)) / (2 * e);
    BOOST_TEST(std::abs(slope + over.force(middle).dot(u)) < 1e-8);
  }
  BOOST_TEST(near >= 5);
}

// Differences over 2e-7 m are off by rounding, 1e-16 k_c t / 1e-7, and where what is closest passes a border.
BOOST_AUTO_TEST_CASE(forces_of_surfaces_have_their_exact_derivatives_in_scenes) {
  if (lacks_embree()) return;
  TwoSheets sheets(R"({"stiffness": 300, "damping": 0.7})");
  Scene& scene = sheets.scene();
  BOOST_REQUIRE(scene.terms().damping.size() == 1);
  const Vector start = sheets.subject.initial_state().x;
  BOOST_TEST(force_of(scene, start).norm() == 0);
  const auto blocks = [&](const State<Vector>& state) {
    return scene.linearization(state)->stiffness().blocks();
  };
  const long apart = blocks(sheets.subject.initial_state());
  for (const std::uint64_t seed : {3, 4, 5}) {
    const State<Vector> state = sheets.lowered(0.0055, 0.0008, seed);
    const ElasticTerm& springs = springs_of(scene);
    const Vector u = random_vector(start.size(), seed + 10), f = force_of(scene, state.x);
    const double e = 1e-7;
    BOOST_TEST(f.norm() > 1);
    const double slope = (springs.energy(scene.position_field(state.x + e * u)) -
                          springs.energy(scene.position_field(state.x - e * u))) /
                         (2 * e);
    BOOST_TEST(std::abs(slope + f.dot(u)) < 1e-5 * f.norm());
    Vector ku = Vector::Zero(u.size());
    springs.add_stiffness_times(scene.position_field(state.x), u.data(), 1, ku.data());
    const Vector difference = (force_of(scene, state.x - e * u) - force_of(scene, state.x + e * u)) / (2 * e);
    BOOST_TEST(ku.norm() > 300);
    BOOST_TEST((ku - difference).norm() < 1e-4 * ku.norm());

    // Matrices have whatever is near in them.
    const auto linear = scene.linearization(state);
    BOOST_TEST(linear->stiffness().blocks() > apart);
    Vector whole = Vector::Zero(u.size());
    for (const auto& term : scene.terms().elastic)
      term->add_stiffness_times(scene.position_field(state.x), u.data(), 1, whole.data());
    BOOST_TEST((linear->stiffness().to_sparse() * u - whole).norm() < 1e-12 * whole.norm());
    Vector drag = Vector::Zero(u.size());
    scene.terms().damping[0]->add_force(scene.position_field(state.x),
                                        {u.data(), nullptr, scene.free_particles()}, drag.data());
    BOOST_TEST(drag.norm() > 0.1);
    BOOST_TEST((linear->own_damping()->to_sparse() * u + drag).norm() < 1e-12 * drag.norm());
    BOOST_TEST(test::smallest_eigenvalue(Eigen::MatrixXd(linear->own_damping()->to_sparse())) > -1e-12);
  }
  BOOST_TEST(blocks(sheets.subject.initial_state()) == apart);
}

// In states of all kinds what the bound leaves is positive semidefinite, and less than all of it.
BOOST_AUTO_TEST_CASE(no_contact_of_surfaces_exceeds_the_bound_on_stiffness_and_damping) {
  if (lacks_embree()) return;
  TwoSheets sheets(R"({"stiffness": 300, "damping": 0.7})");
  SurfaceTouches touches = touches_of(sheets.subject);
  long most = 0;
  double tightest = 1;
  for (int i = 0; i < 8; ++i) {
    const State<Vector> state = sheets.lowered(0.001 * i, 0.0015, 20 + i);
    touches.find(state.x);
    const long contacts = whole_contacts(touches.most_contacts());
    BOOST_TEST(contacts == sheets.subject.contacts(state.x));
    most = std::max(most, contacts);
    const ContactBound bound = sheets.subject.contact_bound(contacts).value();
    BOOST_TEST(bound.stiffness == 600. * double(contacts));
    BOOST_TEST(bound.damping == 1.4 * double(contacts));
    for (const bool all : {false, true}) {
      const Eigen::MatrixXd held = 300 * held_stiffness(touches, all);
      const double largest = -test::smallest_eigenvalue(-held);
      BOOST_TEST(largest <= bound.stiffness * (1 + 1e-12));
      tightest = std::min(tightest, 1 - largest / bound.stiffness);
    }
    const Eigen::MatrixXd c = own_damping_at(sheets.scene(), state);
    BOOST_TEST((c - 0.7 * held_stiffness(touches, false)).norm() < 1e-12 * (1 + c.norm()));
  }
  BOOST_TEST(most >= 3);
  BOOST_TEST(tightest < 0.8);
}

// A mesh does not move: half of that, beside planes and balls.
BOOST_AUTO_TEST_CASE(no_contact_with_a_mesh_exceeds_half_the_bound) {
  if (lacks_embree()) return;
  TwoSheets sheets(R"({"stiffness": 300})", "", 0.0004, "false");
  SurfaceTouches touches = touches_of(sheets.subject);
  double tightest = 1;
  for (int i = 0; i < 4; ++i) {
    State<Vector> state = sheets.lowered(0, 0.002, 40 + i);
    for (Eigen::Index y = 1; y < state.x.size(); y += 3) state.x[y] -= 0.005;
    touches.find(state.x);
    const long contacts = whole_contacts(touches.most_contacts());
    const ContactBound bound = sheets.subject.contact_bound(contacts).value();
    BOOST_TEST(bound.stiffness == 300. * double(contacts));
    const double largest = -test::smallest_eigenvalue(-300 * held_stiffness(touches, false));
    BOOST_TEST(largest > 0);
    BOOST_TEST(largest <= bound.stiffness * (1 + 1e-12));
    tightest = std::min(tightest, 1 - largest / bound.stiffness);
  }
  BOOST_TEST(tightest < 0.5);
}

// With no damping h = 2/√λ_max(M⁻¹K), K with all that touches.
BOOST_AUTO_TEST_CASE(limits_at_a_state_in_contact_are_those_of_its_exact_stiffness) {
  if (lacks_embree()) return;
  TwoSheets sheets(R"({"stiffness": 3000})");
  const State<Vector> state = sheets.lowered(0.0055, 0.0005, 8);
  const auto undamped = [&](const State<Vector>& at) {
    Structure structure = sheets.subject.structure(at);
    structure.damping = {};
    return structure;
  };
  const StructuralMatrices s = undamped(state).matrices;
  const Eigen::VectorXd root = Eigen::VectorXd(s.mass.diagonal()).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd k = root.asDiagonal() * Eigen::MatrixXd(s.stiffness) * root.asDiagonal();
  const double h = 2 / std::sqrt(-test::smallest_eigenvalue(-k));
  const auto limit = [&](const State<Vector>& at) {
    return *StructureLimits(undamped(at)).limits("symplectic-euler").h_max;
  };
  BOOST_TEST(limit(state) == h, tolerance(1e-8));
  BOOST_TEST(h < 0.8 * limit(sheets.subject.initial_state()));
}

BOOST_AUTO_TEST_CASE(springs_and_friction_of_a_cloth_with_itself_keep_its_momentum) {
  if (lacks_embree()) return;
  TwoSheets sheets(R"({"stiffness": 50, "damping": 0.01})", ", \"friction\": 0.4");
  Scene& scene = sheets.scene();
  State<Vector> state = sheets.subject.initial_state(), before;
  for (Eigen::Index i = state.x.size() / 2; i < state.x.size(); i += 3)
    state.v.segment<3>(i) = Vector3d(0.3, -0.5, 0.1);
  const Vector3d first = momentum_of(scene, state.v);
  const auto filter = sheets.subject.contact_filter();
  const auto stepper = Method("symplectic-euler").stepper();
  const double h = 1e-4, decay = 1 - 2 * h;  // d0 = 2 takes momentum, and gravity gives it
  Vector3d expected = first;
  const double mass = scene.total_free_mass();
  SurfaceTouches touches = touches_of(sheets.subject);
  const auto is_on_table = [&] {
    touches.find(state.x);
    return std::ranges::any_of(touches.touches(), [&](const Touch& touch) {
      return std::ranges::any_of(touch.particles, [&](int p) { return p >= touches.free_count(); });
    });
  };
  for (int i = 0; !is_on_table(); ++i) {
    BOOST_TEST((momentum_of(scene, state.v) - expected).norm() < 1e-12 * first.norm());
    before = state;
    BOOST_REQUIRE((stepper->step(scene, h, state) == StepStatus::done));
    filter->apply(h * (i + 1), h, before, state);
    expected = decay * expected + h * mass * scene.gravity();
  }
  BOOST_TEST(filter->counts().impulses > 100);
  BOOST_TEST(filter->counts().friction_work < 0);
}

namespace {

/// As `simulate` runs it.
struct PlannedRun {
  SimulationResult result;
  State<Vector> end;
  ContactCounts counts;
  double first_step = 0, last_step = 0;
  double most_gained = 0;  // of energy over the start [J]
};

struct Kept {
  RunSoFar run;
  State<Vector> state;
  Json chooser, contact;
};

/// From the start, or from what was kept; keeps what there is at the first checkpoint after a plan was made
/// on the way, or in the last fifth.
PlannedRun planned_run(TwoSheets& sheets, const std::string& method, double duration, Kept* keep = nullptr,
                       const Kept* from = nullptr) {
  Subject& subject = sheets.subject;
  PlannedRun run;
  run.end = subject.initial_state();
  const EnergyWatch watch = subject.energy_watch(run.end);
  const double first = watch.initial_total;
  StepsInContact contact(subject, run.end, {.method = method, .duration = duration, .max_step = 1e-3});
  StepChooser chooser(subject, contact.options());
  const StepPlan plan = chooser.first_plan().value();
  run.first_step = plan.h;
  const auto filter = subject.contact_filter();
  if (from) {
    go_on(chooser, from->chooser);
    filter->set_counts(contact_counts_of(from->contact));
    run.end = from->state;
  }
  contact.follow(filter.get(), chooser);
  const Observer observe = [&](const RunSoFar& so_far, const State<Vector>& now) {
    const double energy = subject.system().kinetic_energy(now.v) + subject.system().potential_energy(now.x);
    run.most_gained = std::max(run.most_gained, energy - first);
    const bool is_due = filter->counts().springs->plans > 0 || so_far.time > 0.8 * duration;
    if (keep && so_far.at_checkpoint && is_due && keep->chooser.is_null())
      *keep = {so_far, now, kept(chooser, subject), json_of(filter->counts())};
    return true;
  };
  const auto stepper = Method(method).stepper();
  if (!from) stepper->start(subject.system(), plan.h, run.end);
  run.result = resume_simulation(subject.system(), *stepper, from ? from->run : start_of(plan), watch,
                                 run.end, observe, contact.policy(chooser), filter.get());
  run.counts = filter->counts();
  run.last_step = chooser.decisions().h;
  return run;
}

}  // namespace

// The watch over a run sees it.
BOOST_AUTO_TEST_CASE(what_has_diverged_touches_nothing) {
  if (lacks_embree()) return;
  TwoSheets sheets(R"({"stiffness": 1e3})");
  State<Vector> state = sheets.lowered(0.005, 0, 1);
  BOOST_TEST(force_of(sheets.scene(), state.x).norm() > 0);
  for (const double far : {HUGE_VAL, std::nan(""), 1e200}) {
    state.x[4] = far;
    BOOST_TEST(force_of(sheets.scene(), state.x).norm() == 0);
    BOOST_TEST(sheets.subject.contacts(state.x) == 1);
  }
}

// The table carries both sheets: Σ k_c overlap is their weight, over as many vertices as the lower one has.
BOOST_AUTO_TEST_CASE(a_sheet_that_falls_on_another_rests_on_its_springs_with_the_step_that_was_planned) {
  if (lacks_embree()) return;
  const double stiffness = 400;
  TwoSheets sheets(R"({"stiffness": 400, "damping": 0.1})", "", 0);
  const PlannedRun run = planned_run(sheets, "symplectic-euler", 0.25);
  BOOST_TEST((run.result.status == StepStatus::done));
  const SpringCounts& counts = run.counts.springs.value();
  BOOST_TEST(counts.plans >= 1);
  BOOST_TEST(counts.plans == run.result.failures);
  BOOST_TEST(counts.contacts >= 2);
  BOOST_TEST(run.last_step < run.first_step);
  const double weight = 9.81 * sheets.scene().total_free_mass();
  BOOST_TEST(run.most_gained < 0.01 * weight * 0.008);
  SurfaceTouches touches = touches_of(sheets.subject);
  touches.find(run.end.x);
  double carried = 0, overlaps = 0, on_table = 0;
  for (const Touch& touch : touches.touches()) {
    const TouchPlaces at = touch_places(touch.kind, touches.places(touch));
    if (touch.particles[3] < touches.free_count()) continue;
    const double overlap = 0.005 - at.distance;
    carried += stiffness * touch.count * at.share * overlap * at.normal.y();
    overlaps += overlap;
    ++on_table;
  }
  BOOST_TEST(carried == weight, tolerance(0.02));
  BOOST_TEST(on_table >= 20);
  BOOST_TEST(overlaps / on_table < 2 * weight / (30 * stiffness));
  BOOST_TEST(overlaps / on_table > 0.5 * weight / (30 * stiffness));
}

// At the step that the cloth alone allows it does not.
BOOST_AUTO_TEST_CASE(a_stiff_penalty_of_surfaces_explodes_at_the_step_without_contact) {
  if (lacks_embree()) return;
  TwoSheets sheets(R"({"stiffness": 1e5})");
  State<Vector> state = sheets.subject.initial_state();
  const double h = 0.95 * *StructureLimits(sheets.subject.structure(state)).limits("symplectic-euler").h_max;
  EnergyWatch watch = sheets.subject.energy_watch(state);
  watch.slack = 30;
  const auto filter = sheets.subject.contact_filter();
  const SimulationResult result =
      simulate(sheets.subject.system(), *Method("symplectic-euler").stepper(),
               {h, static_cast<long>(0.5 / h)}, watch, state, {}, {}, filter.get());
  BOOST_TEST((result.status == StepStatus::diverged));
  BOOST_TEST(result.failed_at > 0.024);  // not before they touch: √(2 · 0.003 m/g)
  const PlannedRun planned = planned_run(sheets, "symplectic-euler", 0.05);
  BOOST_TEST((planned.result.status == StepStatus::done));
  BOOST_TEST(planned.most_gained < 0.1 * 9.81 * sheets.scene().total_free_mass() * 0.008);
}

BOOST_AUTO_TEST_CASE(a_run_with_plans_made_on_the_way_goes_on_to_the_same_bits_with_any_number_of_threads) {
  if (lacks_embree()) return;
  for (const char* method : {"symplectic-euler", "implicit-euler", "linearized-rk4"})
    BOOST_TEST_CONTEXT(method) {
      const auto scene = [] {
        return TwoSheets(R"({"stiffness": 400, "damping": 0.05})", ", \"friction\": 0.3");
      };
      Kept kept;
      TwoSheets one = scene(), other = scene(), third = scene();
      const PlannedRun whole = planned_run(one, method, 0.06, &kept);
      BOOST_REQUIRE(!kept.chooser.is_null());
      BOOST_TEST((whole.result.status == StepStatus::done));
      if (std::string(method) == "symplectic-euler") {
        BOOST_TEST(contact_counts_of(kept.contact).springs->plans > 0);
        BOOST_TEST(whole.counts.springs->plans > contact_counts_of(kept.contact).springs->plans);
      }
      const PlannedRun rest = planned_run(other, method, 0.06, nullptr, &kept);
      const test::LoopThreads threads(3);
      const PlannedRun shared = planned_run(third, method, 0.06);
      for (const PlannedRun* run : {&rest, &shared}) {
        BOOST_TEST((run->end.x == whole.end.x && run->end.v == whole.end.v));
        BOOST_TEST(json_of(run->counts) == json_of(whole.counts));
        BOOST_TEST(run->last_step == whole.last_step);
      }
    }
}

BOOST_AUTO_TEST_CASE(limits_and_simulate_say_for_how_many_contacts_a_step_is) {
  if (lacks_embree()) return;
  const test::Command springstab;
  std::string obj;
  int vertices = 0;
  add_sheet(obj, 5, 6, 0.0004, 0, 0, vertices);
  add_sheet(obj, 4, 5, 0.0004, 0.4, 0.008, vertices);
  springstab.file("sheets.obj", obj);
  springstab.file("s.json", R"({"geometry": {"mesh": "sheets.obj"}, "pins": [0, 5, 24, 29], "contact":
    {"self": true, "thickness": 0.005, "friction": 0.2, "model": {"penalty": {"stiffness": 1000}}}})");
  const auto limits = springstab("limits s.json --methods symplectic-euler --json").json();
  const auto any = limits["contact"]["any_contact"];
  BOOST_TEST(any["contacts"] == 1);
  BOOST_TEST(any["h_certified"].get<double>() > 0);
  const test::Outcome told = springstab("limits s.json --methods symplectic-euler");
  BOOST_TEST(
      told.out.find("in any contact with at most 1 at a particle, while normals and weights stay: proved") !=
      std::string::npos);
  BOOST_TEST(told.out.find("in every pose") == std::string::npos);
  const auto run =
      springstab("simulate s.json --method symplectic-euler --duration 0.08 --json --quiet").json();
  BOOST_TEST(run["status"] == "done");
  BOOST_TEST(run["counts"]["contact"]["contacts"].get<long>() > 1);
  BOOST_TEST(run["counts"]["contact"]["plans"].get<long>() >= 1);
  BOOST_TEST(run["last_step"].get<double>() < run["step"].get<double>());
  BOOST_TEST(run["counts"]["rollbacks"] == 0);
  BOOST_TEST(run["energy"]["contact"]["friction_work"].get<double>() < 0);
  const test::Outcome text = springstab("simulate s.json --method symplectic-euler --duration 0.08");
  BOOST_TEST(text.out.find("at a particle, for which steps were planned anew") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(what_moves_is_refused_with_springs_between_surfaces) {
  test::ScratchFolder folder;
  folder.file("box.obj", "v 0 -1 0\nv 1 -1 0\nv 0 -1 1\nf 1 2 3\n");
  const auto refuse = [&](const std::string& contact, long line, const std::string& words) {
    const std::filesystem::path scene =
        folder.file("s.json", "{\"geometry\": {\"grid\": [3, 4]},\n\"contact\": " + contact + "}");
    expect_error([&] { Subject{read_scene_file(scene.string())}; },
                 scene.string() + ':' + std::to_string(line), words);
  };
  refuse(
      "{\"thickness\": 0.01, \"model\": {\"penalty\": {\"stiffness\": 10}}, \"obstacles\": [\n{\"mesh\": "
      "\"box.obj\",\n\"velocity\": [0, 1, 0]}]}",
      4, "'velocity' stands with the model 'penalty', expected it with 'impulses' or 'inelastic' only");
  refuse("{\"self\": true,\n\"model\": {\"penalty\": {\"stiffness\": 10}}}", 2,
         "'thickness' is zero or missing, expected a positive number of metres with 'self' or a mesh");
  if (lacks_embree()) return;
  Contact contact;
  contact.meshes = {{{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}}, {0, 1, 0}}};
  contact.thickness = 0.1;
  contact.model = Penalty{1, 0};
  BOOST_CHECK_THROW(SurfaceTouches(contact, 3, {{{0, 1, 2}}, {}}), std::invalid_argument);
}

BOOST_AUTO_TEST_SUITE_END()
