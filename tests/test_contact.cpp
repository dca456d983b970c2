// Contact with obstacles: nothing is below a surface at any step of any method, impulses take kinetic energy
// and at any step below the limit without contact never raise symplectic Euler's own energy, friction is
// Coulomb's, penalties are forces with exact derivatives and a bound on what they add; and what is wrong with
// a scene's contact is said.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "analysis/limits/penalty_contact.h"
#include "analysis/method.h"
#include "analysis/structure_limits.h"
#include "experiments/inputs/subject.h"
#include "solvers/contact/contact_filter.h"
#include "solvers/contact/friction.h"
#include "solvers/contact/penalty.h"
#include "solvers/methods/symplectic_euler.h"
#include "solvers/scene/scene.h"
#include "tests/allocation_counter.h"
#include "tests/command.h"
#include "tests/dense.h"
#include "tests/random_nets.h"
#include "tests/refusals.h"
#include "tests/resumed_contact.h"
#include "tests/scratch.h"

BOOST_AUTO_TEST_SUITE(contact)

using namespace springstab;
using Eigen::Vector3d;
using springstab::test::expect_error;
using springstab::test::expect_same_when_resumed;
using springstab::test::random_vector;

namespace {

Vector3d random_direction(test::RandomNets& random) {
  return Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
}

/// The largest step of symplectic Euler: 1/h = λ_max([[D'/2, B/2], [Bᵀ/2, 0]]), BBᵀ = K'.
double exact_limit(const StructuralMatrices& s) {
  const Eigen::VectorXd root = Eigen::VectorXd(s.mass.diagonal()).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd k = scaled(s.stiffness, root);
  const Eigen::Index n = s.size();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(k);
  const Eigen::MatrixXd b = modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  if (s.has_damping()) all.topLeftCorner(n, n) = Eigen::MatrixXd(scaled(s.damping, root)) / 2;
  all.topRightCorner(n, n) = b / 2;
  all.bottomLeftCorner(n, n) = b.transpose() / 2;
  return 1 / Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(all).eigenvalues()[2 * n - 1];
}

/// E = ½vᵀ(M - hD/2 - h²K/4)v + ½x̄ᵀKx̄, x̄ = x + hv/2: of the step from x to x + hv.
double step_energy(const StructuralMatrices& s, double h, const State<Vector>& state) {
  const Vector &v = state.v, mean = state.x + h / 2 * v;
  double kinetic = v.dot(s.mass * v) - h * h / 4 * v.dot(s.stiffness * v);
  if (s.has_damping()) kinetic -= h / 2 * v.dot(s.damping * v);
  return kinetic / 2 + mean.dot(s.stiffness * mean) / 2;
}

std::vector<double> masses(const StructuralMatrices& s) {
  std::vector<double> all;
  for (Eigen::Index i = 0; i < s.size(); i += 3) all.push_back(s.mass.coeff(i, i));
  return all;
}

/// Walls around the places of all masses, which hold zero, and at which none moves faster into them than it
/// lands.
Contact random_walls(test::RandomNets& random, double friction, const ContactModel& model) {
  Contact contact;
  const int walls = static_cast<int>(random.uniform(1, 5));
  for (int k = 0; k < walls; ++k) {
    const Vector3d normal = random_direction(random);
    const double distance = random.uniform(0, 1) < 0.5 ? 0 : random.log_uniform(-3, 0);
    contact.obstacles.push_back({Plane{-distance * normal, normal}});
  }
  contact.friction = friction;
  contact.model = model;
  return contact;
}

struct WalledRun {
  double growth = 0;  // of E, the largest over a step, relative to the first
  double last = 0;    // E at the end over the first
  ContactCounts counts;
};

/// A random net between random walls, from a random push, at a part of its own exact limit.
WalledRun run_between_walls(std::uint64_t seed, double part, bool damped, double friction,
                            const ContactModel& model, int steps) {
  test::RandomNets random(seed);
  StructuralMatrices s = test::matrices(random.net(random.uniform(0, 1) < 0.5));
  if (!damped) s.damping = SparseMatrix();
  const double h = part * exact_limit(s);
  const auto filter = make_contact_filter(random_walls(random, friction, model), masses(s));
  MatrixSystem system(s);
  const auto stepper = Method("symplectic-euler").stepper();
  State<Vector> state{Vector::Zero(s.size()), random_vector(s.size(), seed)}, before = state;
  stepper->start(system, h, state);
  filter->apply(0, h, before, state);  // the first step lands, too
  WalledRun run;
  const double first = step_energy(s, h, state);
  double last = first;
  for (int i = 0; i < steps && last < 1e12 * first; ++i) {
    before = state;
    BOOST_REQUIRE((stepper->step(system, h, state) == StepStatus::done));
    filter->apply((i + 1) * h, h, before, state);
    const double now = step_energy(s, h, state);
    run.growth = std::max(run.growth, (now - last) / first);
    last = now;
  }
  run.last = last / first;
  run.counts = filter->counts();
  return run;
}

/// One mass on an incline that falls along x by θ, in a frame turned at random.
struct Incline {
  Eigen::Matrix3d frame;
  Scene scene;
  Contact contact;

  Incline(double angle, double friction)
      : frame(Eigen::AngleAxisd(1.1, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix()),
        scene({frame * Vector3d(0.3, 0, -0.2)}, {0.37}, [](const auto&, int) { return SceneTerms(); }, {},
              frame * Vector3d(9.81 * std::sin(angle), -9.81 * std::cos(angle), 0), {}) {
    contact.obstacles = {{Plane{frame * Vector3d(1, 0, 1), frame * Vector3d::UnitY()}}};
    contact.friction = friction;
  }

  /// Where it is after the time, from its start, in the incline's frame; down the slope, out of it, across.
  Vector3d slide(const Method& method, double time, long steps, const Vector3d& velocity = {0, 0, 0}) {
    State<Vector> state = scene.rest_state();
    const Vector start = state.x;
    state.v = frame * velocity;
    const auto filter = make_contact_filter(contact, scene.free_masses());
    const EnergyWatch watch{.initial_energy = 1, .slack = 1e9};
    const SimulationResult result =
        simulate(scene, *method.stepper(), {time / double(steps), steps}, watch, state, {}, {}, filter.get());
    BOOST_TEST((result.status == StepStatus::done));
    return frame.transpose() * (state.x - start);
  }
};

/// A cloth that falls past a ball onto a floor that is not level.
std::string falling_cloth(const std::string& model, const std::string& more = "") {
  return R"({"geometry": {"grid": [9, 8], "spacing": 0.03}, "damping": {"d0": 1, "alpha": 1e-4},
    "contact": {"obstacles": [{"sphere": {"center": [0.09, -0.07, 0.13], "radius": 0.06}},
                              {"plane": {"point": [0, -0.14, 0], "normal": [0.1, 1, -0.05]}}],
                "thickness": 0.004, "friction": 0.3, "model": )" +
         model + "}" + more + "}";
}

Subject subject_of(const std::string& scene) { return Subject(parse_scene("scene.json", scene)); }

double energy(System& system, const State<Vector>& s) {
  return system.kinetic_energy(s.v) + system.potential_energy(s.x);
}

double least_gap(const Contact& contact, double t, const State<Vector>& s) {
  double least = std::numeric_limits<double>::infinity();
  for (const Obstacle& obstacle : contact.obstacles)
    for (Eigen::Index i = 0; i < s.x.size(); i += 3)
      least = std::min(least, gap_at(obstacle, s.x.segment<3>(i), t).gap - contact.thickness);
  return least;
}

}  // namespace

// The walls may touch at the start and meet in edges and corners; K and D do not commute.
BOOST_AUTO_TEST_CASE(impulses_never_raise_the_energy_up_to_the_limit_without_contact) {
  long impulses = 0;
  double friction_work = 0;
  for (std::uint64_t seed = 1; seed <= 96; ++seed) BOOST_TEST_CONTEXT("seed " << seed) {
      const WalledRun run =
          run_between_walls(seed, 0.9999, seed % 3 != 0, seed % 2 == 0 ? 0.4 : 0, LandingImpulses(), 800);
      BOOST_TEST(run.growth < 1e-9);
      BOOST_TEST(run.counts.largest_rise <= 1e-9);
      BOOST_TEST(run.counts.normal_work < 1e-12);
      BOOST_TEST(run.counts.friction_work <= 0);
      BOOST_TEST(run.last < 1.000001);
      impulses += run.counts.impulses;
      friction_work += run.counts.friction_work;
    }
  BOOST_TEST(impulses > 10000);
  BOOST_TEST(friction_work < 0);
}

// Which is a property of where the impulses let a mass go, not of their taking kinetic energy: these do, too.
BOOST_AUTO_TEST_CASE(inelastic_impulses_diverge_below_the_limit_without_contact,
                     *boost::unit_test::label("slow")) {
  int inelastic = 0, landing = 0, inelastic_at_half = 0;
  for (std::uint64_t seed = 1; seed <= 96; ++seed) {
    inelastic += run_between_walls(seed, 0.99, false, 0, InelasticImpulses(), 3000).last > 1e3;
    landing += run_between_walls(seed, 0.99, false, 0, LandingImpulses(), 3000).last > 1 + 1e-9;
    inelastic_at_half += run_between_walls(seed, 0.5, false, 0, InelasticImpulses(), 3000).last > 1e3;
  }
  BOOST_TEST_MESSAGE("inelastic: " << inelastic << " of 96 diverge at 0.99, " << inelastic_at_half
                                   << " at half");
  BOOST_TEST(inelastic > 0);
  BOOST_TEST(landing == 0);
  BOOST_TEST(inelastic_at_half == 0);
}

// Velocities from which nothing enters are a convex set that holds zero: the nearest one is no faster. With
// friction each impulse in turn is against the slip and not beyond stopping it.
BOOST_AUTO_TEST_CASE(no_impulse_raises_kinetic_energy_and_what_enters_nothing_is_left_alone) {
  test::RandomNets random(5);
  int pushed = 0, left_alone = 0;
  for (int i = 0; i < 20000; ++i) {
    Contact contact;
    const int count = i % 3 + 1;
    for (int k = 0; k < count; ++k) {
      const Vector3d normal = random_direction(random);
      if (random.uniform(0, 1) < 0.5)
        contact.obstacles.push_back({Plane{-random.uniform(0, 0.3) * normal, normal}});
      else
        contact.obstacles.push_back({Sphere{-random.uniform(0.4, 0.7) * normal, 0.4}});
    }
    contact.thickness = i % 2 == 0 ? 0.01 : 0;
    contact.friction = i % 4 < 2 ? 0 : random.uniform(0, 2);
    if (i % 5 == 0) contact.model = InelasticImpulses();
    const double h = random.log_uniform(-3, -1), mass = random.log_uniform(-3, 1);
    const State<Vector> before{0.2 * random_vector(3, 7 * i), random_vector(3, 7 * i + 1)},
        moved{0.2 * random_vector(3, 7 * i + 2), 3 * random_vector(3, 7 * i + 3)};
    State<Vector> after = moved;
    const auto filter = make_contact_filter(contact, {mass});
    const bool changed = filter->apply(0, h, before, after) == Filtered::changed;
    if (filter->counts().unresolved > 0) continue;  // no room between three of them
    pushed += filter->counts().impulses > 0;
    BOOST_TEST(after.v.norm() <= moved.v.norm() * (1 + 1e-12));
    BOOST_TEST(least_gap(contact, 0, after) >= -1e-12);
    const State<Vector> next{after.x + h * after.v, after.v};
    BOOST_TEST(least_gap(contact, 0, next) >= -1e-12);
    const State<Vector> was_next{moved.x + h * moved.v, moved.v};
    if (changed || contact.obstacles.size() > 1) continue;
    ++left_alone;
    BOOST_TEST((after.x == moved.x && after.v == moved.v));
    BOOST_TEST(least_gap(contact, 0, was_next) >= -1e-12);
  }
  BOOST_TEST(pushed > 2000);
  BOOST_TEST(left_alone > 500);
}

BOOST_AUTO_TEST_CASE(friction_is_within_coulombs_cone_and_takes_energy_against_the_mean_slip) {
  test::RandomNets random(6);
  int stopped = 0, full = 0, held_back = 0;
  for (int i = 0; i < 10000; ++i) {
    const double mass = random.log_uniform(-2, 1), most = random.log_uniform(-3, 1);
    const Vector3d before = random_vector(3, 2 * i), slip = random_vector(3, 2 * i + 1),
                   q = friction_impulse(most, mass, before, slip), after = slip + q / mass;
    BOOST_TEST(q.norm() <= most * (1 + 1e-12));
    BOOST_TEST(q.dot(before + after) <= 1e-15 * mass);
    BOOST_TEST(q.dot(slip) <= 0);
    BOOST_TEST(after.dot(slip) >= -1e-15);
    const bool stops = after.norm() < 1e-12, is_full = std::abs(q.norm() - most) < 1e-12 * most;
    stopped += stops;
    full += is_full;
    held_back += !stops && !is_full;
  }
  BOOST_TEST(stopped > 100);
  BOOST_TEST(full > 100);
  BOOST_TEST(held_back > 100);
}

// Sticks if and only if tan θ <= μ; else slides with g (sin θ - μ cos θ), and on the level for v²/(2μg). A
// step's order of accuracy is met by steps of a thousandth.
BOOST_AUTO_TEST_CASE(a_mass_on_an_incline_sticks_and_slides_as_coulomb_says_with_every_method) {
  const double friction = 0.4, g = 9.81, time = 0.5;
  for (const Method& method : built_in_methods()) BOOST_TEST_CONTEXT(method.name()) {
      const Vector3d stays = Incline(std::atan(0.999 * friction), friction).slide(method, time, 1000);
      BOOST_TEST(stays.norm() < 1e-9);
      const Vector3d creeps = Incline(std::atan(1.001 * friction), friction).slide(method, time, 1000);
      const double slight = g * 0.001 * friction * std::cos(std::atan(1.001 * friction)) * time * time / 2;
      BOOST_TEST(std::abs(creeps.x() / slight - 1) < 0.01);
      const double angle = 0.9, pull = g * (std::sin(angle) - friction * std::cos(angle));
      const Vector3d slides = Incline(angle, friction).slide(method, time, 1000);
      BOOST_TEST(std::abs(slides.x() / (pull * time * time / 2) - 1) < 0.01);
      BOOST_TEST(std::abs(slides.y()) < 1e-9);
      BOOST_TEST(std::abs(slides.z()) < 1e-9);
      const Vector3d stops = Incline(0, friction).slide(method, time, 1000, {1.5, 0, -0.7});
      BOOST_TEST(std::abs(stops.norm() / ((1.5 * 1.5 + 0.7 * 0.7) / (2 * friction * g)) - 1) < 0.01);
      BOOST_TEST(std::abs(stops.z() / stops.x() + 0.7 / 1.5) < 1e-6);
    }
}

// Energy to first order in the step: of symplectic Euler in free fall it is hmgv/2 above.
BOOST_AUTO_TEST_CASE(no_particle_is_below_an_obstacle_at_any_step_of_any_method,
                     *boost::unit_test::label("slow")) {
  for (const char* model : {"\"impulses\"", "\"inelastic\""})
    for (const Method& method : built_in_methods()) BOOST_TEST_CONTEXT(method.name() << ' ' << model) {
        Subject subject = subject_of(falling_cloth(model));
        const State<Vector> start = subject.initial_state();
        const auto filter = subject.contact_filter();
        State<Vector> state = start;
        double least = 1, h = 8e-5, most_energy = energy(subject.system(), start);
        const double first = most_energy, weight = 9.81 * subject.scene()->total_free_mass();
        const Observer observe = [&](const RunSoFar& run, const State<Vector>& now) {
          least = std::min(least, least_gap(*subject.contact(), run.time, now));
          most_energy = std::max(most_energy, energy(subject.system(), now));
          return true;
        };
        const SimulationResult result =
            simulate(subject.system(), *method.stepper(), {h, 4000}, subject.energy_watch(start), state,
                     observe, {}, filter.get());
        BOOST_TEST((result.status == StepStatus::done));
        BOOST_TEST(least >= -1e-14);
        BOOST_TEST(filter->counts().impulses > 3000);
        BOOST_TEST(filter->counts().unresolved == 0);
        BOOST_TEST(filter->counts().friction_work < 0);
        BOOST_TEST(most_energy <= first + 0.01 * weight * 0.14);
        BOOST_TEST(energy(subject.system(), state) < first - 0.1 * weight * 0.14);
      }
}

// Seen from a frame in which the floor moves, the same motion: impulses know nothing but relative velocities.
BOOST_AUTO_TEST_CASE(contact_is_the_same_in_every_frame_that_moves_uniformly) {
  const Vector3d u(0.3, -0.2, 0.1);
  const double h = 1e-3;
  for (const Method& method : built_in_methods()) BOOST_TEST_CONTEXT(method.name()) {
      Vector end[2];
      for (const bool moves : {false, true}) {
        Incline incline(0.7, 0.3);
        const Vector3d shift = moves ? u : Vector3d::Zero();
        incline.contact.obstacles[0].velocity = shift;
        State<Vector> state = incline.scene.rest_state();
        state.v = incline.frame * Vector3d(0.4, 0.8, 0.2) + shift;  // it jumps, and falls back
        const auto filter = make_contact_filter(incline.contact, incline.scene.free_masses());
        simulate(incline.scene, *method.stepper(), {h, 600}, {.initial_energy = 1, .slack = 1e9}, state, {},
                 {}, filter.get());
        end[moves] = state.x - 600 * h * Vector(shift);
        BOOST_TEST(filter->counts().impulses > 100);
      }
      BOOST_TEST((end[0] - end[1]).norm() < 1e-9);
    }
}

BOOST_AUTO_TEST_CASE(a_ball_that_moves_carries_a_cloth_without_gravity_along_and_says_what_it_gave) {
  Subject subject = subject_of(R"({"geometry": {"grid": [6, 7]}, "gravity": [0, 0, 0], "damping": {"d0": 0.1},
    "contact": {"obstacles": [{"sphere": {"center": [0.06, -0.12, 0.07], "radius": 0.1},
                               "velocity": [0.1, 0.7, 0]}], "friction": 0.5}})");
  const State<Vector> start = subject.initial_state();
  const auto filter = subject.contact_filter();
  const EnergyWatch watch = with_obstacles(subject.energy_watch(start), *subject.contact());
  State<Vector> state = start;
  double least = 1;
  const Observer observe = [&](const RunSoFar& run, const State<Vector>& now) {
    least = std::min(least, least_gap(*subject.contact(), run.time, now));
    return true;
  };
  const SimulationResult result = simulate(subject.system(), *Method("symplectic-euler").stepper(),
                                           {2e-4, 2500}, watch, state, observe, {}, filter.get());
  BOOST_TEST((result.status == StepStatus::done));
  BOOST_TEST(least >= -1e-14);
  double height = 0;
  for (Eigen::Index i = 1; i < state.x.size(); i += 3) height += state.x[i] / double(state.x.size() / 3);
  BOOST_TEST(height > 0.25);
  BOOST_TEST(filter->counts().obstacle_work > energy(subject.system(), state));
}

// (A step that changes nothing else than x and v.)
BOOST_AUTO_TEST_CASE(steps_in_contact_allocate_nothing) {
  Subject subject = subject_of(falling_cloth("\"impulses\""));
  const auto filter = subject.contact_filter();
  State<Vector> state = subject.initial_state();
  long early = 0, late = 0;
  const Observer observe = [&](const RunSoFar& run, const State<Vector>&) {
    if (run.steps == 32) early = allocations();
    if (run.steps == 1500) late = allocations();
    return true;
  };
  simulate(subject.system(), *Method("symplectic-euler").stepper(), {2e-4, 1500},
           {.initial_energy = 1, .slack = 1e9}, state, observe, {}, filter.get());
  BOOST_TEST(filter->counts().impulses > 1000);
  BOOST_TEST(late == early);
}

BOOST_AUTO_TEST_CASE(a_run_from_a_checkpoint_in_contact_ends_in_the_same_bits) {
  for (const char* method : {"symplectic-euler", "bdf2", "newmark", "velocity-verlet"})
    BOOST_TEST_CONTEXT(method) {
      expect_same_when_resumed(
          [](const auto& run) {
            Subject subject = subject_of(falling_cloth("\"impulses\""));
            run(subject);
          },
          Method(method), 1600, 1024);
    }
}

// Central differences: off by h²/6 third derivatives, and of the forces' kink where contact begins there are
// none.
BOOST_AUTO_TEST_CASE(penalty_forces_are_the_energys_gradient_and_stiffness_and_damping_theirs) {
  Subject subject = subject_of(falling_cloth(R"({"penalty": {"stiffness": 300, "damping": 0.7}})"));
  Scene& scene = *subject.scene();
  State<Vector> state = subject.initial_state();
  for (Eigen::Index i = 1; i < state.x.size(); i += 3) state.x[i] -= 0.06;
  state.x += 0.002 * random_vector(state.x.size(), 3);
  const SceneTerms& terms = scene.terms();
  BOOST_REQUIRE(terms.elastic.back()->name() == "contact springs");
  BOOST_REQUIRE(terms.damping.size() == 1);
  const ElasticTerm& springs = *terms.elastic.back();
  const auto force = [&](const Vector& x) {
    Vector f = Vector::Zero(x.size());
    springs.add_force(scene.position_field(x), f.data());
    return f;
  };
  const Vector u = random_vector(state.x.size(), 4);
  const double e = 1e-6;
  const Vector f = force(state.x);
  const double slope = (springs.energy(scene.position_field(state.x + e * u)) -
                        springs.energy(scene.position_field(state.x - e * u))) /
                       (2 * e);
  BOOST_TEST(f.norm() > 1);
  BOOST_TEST(std::abs(slope + f.dot(u)) < 1e-7 * f.norm());
  Vector ku = Vector::Zero(u.size());
  springs.add_stiffness_times(scene.position_field(state.x), u.data(), 1, ku.data());
  const Vector differenced = (force(state.x - e * u) - force(state.x + e * u)) / (2 * e);
  BOOST_TEST(ku.norm() > 100);
  BOOST_TEST((ku - differenced).norm() < 1e-6 * ku.norm());
  const auto linear = scene.linearization(state);
  Vector drag = Vector::Zero(u.size());
  const std::vector<double> none(3 * 9 * 8);
  terms.damping[0]->add_force(scene.position_field(state.x), {u.data(), none.data(), scene.free_particles()},
                              drag.data());
  BOOST_TEST(drag.norm() > 0.1);
  BOOST_TEST((linear->own_damping()->to_sparse() * u + drag).norm() < 1e-12 * drag.norm());
}

// In states of all kinds the bound minus what contact adds is positive semidefinite, and not by much.
BOOST_AUTO_TEST_CASE(no_contact_state_exceeds_the_bound_on_stiffness_and_damping) {
  const std::string with = falling_cloth(R"({"penalty": {"stiffness": 300, "damping": 0.7}})");
  Subject subject = subject_of(with);
  const ContactBound bound = subject.contact_bound().value();
  BOOST_TEST(bound.stiffness == 600);
  BOOST_TEST(bound.damping == 1.4);
  Subject free =
      subject_of(R"({"geometry": {"grid": [9, 8], "spacing": 0.03}, "damping": {"d0": 1, "alpha": 1e-4}})");
  double least = 1e9, least_damping = 1e9;
  for (int i = 0; i < 6; ++i) {
    State<Vector> state = subject.initial_state();
    for (Eigen::Index y = 1; y < state.x.size(); y += 3) state.x[y] -= 0.03 * i;
    state.x += 0.004 * random_vector(state.x.size(), 10 + i);
    // An exact K of contact may be less than none: what is pressed into a ball is unstable sideways.
    const StructuralMatrices in = subject.structure(state).matrices;
    Structure out = free.structure(state);
    out.damping.kind = DampingModel::Kind::general;
    out.matrices.damping = out.matrices.mass + 1e-4 * out.matrices.stiffness;
    const StructuralMatrices above = in_any_contact(out, bound).matrices;
    least = std::min(least, test::smallest_eigenvalue(Eigen::MatrixXd(above.stiffness - in.stiffness)));
    least_damping =
        std::min(least_damping, test::smallest_eigenvalue(Eigen::MatrixXd(above.damping - in.damping)));
  }
  BOOST_TEST(least >= 299.999);  // none of them is in both the floor and the ball
  BOOST_TEST(least < 300.001);
  BOOST_TEST(least_damping >= 0.69);
}

// A penalty explodes at the step that is stable without it, and at the one that is proved with it does not.
BOOST_AUTO_TEST_CASE(a_stiff_penalty_explodes_at_the_step_without_contact_and_not_at_the_one_that_is_proved) {
  Subject subject = subject_of(falling_cloth(R"({"penalty": {"stiffness": 3e4}})"));
  const State<Vector> start = subject.initial_state();
  const double without = *StructureLimits(subject.structure(start)).limits("symplectic-euler").h_max;
  const double with = *StructureLimits(in_any_contact(subject.structure(start), *subject.contact_bound()))
                           .limits("symplectic-euler")
                           .h_certified;
  BOOST_TEST(with < without / 3);
  // What a run has gained at most, over all that gravity gives on the way to the floor.
  const auto gained = [&](double h) {
    State<Vector> state = start;
    const auto filter = subject.contact_filter();
    const double first = energy(subject.system(), start);
    double most = first;
    const Observer observe = [&](const RunSoFar&, const State<Vector>& now) {
      most = std::max(most, energy(subject.system(), now));
      return true;
    };
    simulate(subject.system(), *Method("symplectic-euler").stepper(), {h, static_cast<long>(0.4 / h)},
             subject.energy_watch(start), state, observe, {}, filter.get());
    return (most - first) / (subject.scene()->total_free_mass() * 9.81 * 0.14);
  };
  BOOST_TEST(gained(0.9 * without) > 1);
  BOOST_TEST(gained(0.9 * with) < 0.1);
}

BOOST_AUTO_TEST_CASE(what_is_wrong_with_contact_is_said_with_its_line) {
  const auto refuse = [](const std::string& contact, long line, const std::string& words) {
    const std::string scene = "{\"geometry\": {\"grid\": [3, 4]},\n\"contact\": " + contact + "}";
    expect_error([&] { Subject{parse_scene("s.json", scene)}; }, "s.json:" + std::to_string(line), words);
  };
  const std::string floor = R"("obstacles": [{"plane": {"point": [0, -1, 0], "normal": [0, 2, 0]}}])";
  refuse("3", 2, "'contact' is 3, expected an object");
  refuse("{}", 2, "'obstacles' is missing in 'contact'");
  refuse("{\"obstacles\": []}", 2, "expected an array of obstacles, at least one");
  refuse("{\"obstacles\": [{}]}", 2, "has none of 'plane', 'sphere' and 'mesh', expected one of them");
  refuse(R"({"obstacles": [{"plane": {}, "mesh": "body.obj"}]})", 2,
         "has more than one of 'plane', 'sphere' and 'mesh', expected one of them");
  refuse("{" + floor + ", \"thickness\": -1}", 2, "'thickness' is -1, expected zero or a positive number");
  refuse("{" + floor + ",\n\"thickness\": 0.03}", 3,
         "'thickness' is 0.03 m, expected at most the edge 0-1 of 0.025 m");
  refuse("{" + floor + ", \"friction\": -0.1}", 2, "'friction' is -0.1, expected zero or a positive number");
  refuse("{" + floor + ", \"model\": \"penalty\"}", 2, "expected 'impulses', 'inelastic' or");
  refuse("{" + floor + ", \"model\": {\"penalty\": {}}}", 2, "'stiffness' is missing in 'penalty'");
  refuse("{" + floor + ", \"glue\": 1}", 2, "unknown key 'glue' in 'contact'");
  refuse(R"({"obstacles": [{"plane": {"point": [0, -1, 0], "normal": [0, 0, 0]}}]})", 2,
         "'normal' is zero, expected a direction");
  refuse(R"({"obstacles": [{"sphere": {"center": [0, -1, 0], "radius": 0}}]})", 2,
         "'radius' is 0, expected a positive number");
  refuse(
      "{\"obstacles\": [{\"plane\": {\"point\": [0, -1, 0], \"normal\": [0, 1, 0]},\n\"velocity\": [0, 1, "
      "0]}], "
      "\"model\": {\"penalty\": {\"stiffness\": 10}}}",
      3, "'velocity' stands with the model 'penalty'");
  // row 1, column 2 of three by four
  refuse("{\"obstacles\": [\n{\"sphere\": {\"center\": [0.05, -0.01, 0.025], \"radius\": 0.012}}]}", 3,
         "obstacle 0 holds particle 6 of the cloth at the start, 0.002 m deep, expected them apart");
  refuse(
      "{\"thickness\": 0.002, \"obstacles\": [\n{\"plane\": {\"point\": [0, -0.001, 0], \"normal\": [0, 1, "
      "0]}}]}",
      3,
      "obstacle 0 holds particle 0 of the cloth at the start, 0.001 m deep, expected them apart by the "
      "thickness");
  // between four particles: in the face, not at its corners
  refuse("{\"obstacles\": [\n{\"sphere\": {\"center\": [0.03, 0.001, 0.012], \"radius\": 0.003}}]}", 3,
         "obstacle 0 holds face ");
  BOOST_TEST(!subject_of("{\"geometry\": {\"grid\": [3, 4]}}").contact());
  BOOST_CHECK_NO_THROW(
      subject_of("{\"geometry\": {\"grid\": [3, 4]}, \"contact\": {" + floor + ", \"self\": false}}"));
}

BOOST_FIXTURE_TEST_CASE(limits_and_simulate_say_what_contact_does, test::Command) {
  file("cloth.json", falling_cloth("\"impulses\""));
  file("flat.json", R"({"geometry": {"grid": [6, 5]}, "contact": {"obstacles": [
    {"plane": {"point": [0, -0.01, 0], "normal": [0, 1, 0]}}], "friction": 0.5}})");
  file("stiff.json", falling_cloth(R"({"penalty": {"stiffness": 3e4}})"));
  const auto limits = (*this)("limits cloth.json --json").json().at("contact");
  BOOST_TEST(limits.at("model") == "impulses");
  BOOST_TEST(limits.at("proved").empty());  // the ball is round
  const auto flat = (*this)("limits flat.json --json").json().at("contact");
  BOOST_TEST(flat.at("proved") == nlohmann::json::array({"symplectic-euler"}));
  BOOST_TEST(flat.at("measured").size() == 6);
  const auto stiff = (*this)("limits stiff.json --json").json();
  BOOST_TEST(stiff.at("contact").at("any_contact").at("h_certified").get<double>() < 1e-3);

  const auto report = (*this)("simulate cloth.json --method symplectic-euler --duration 0.3 --json").json();
  BOOST_TEST(report.at("status") == "done");
  BOOST_TEST(report.at("counts").at("contact").at("impulses").get<long>() > 0);
  BOOST_TEST(report.at("energy").at("contact").at("friction_work").get<double>() < 0);
  BOOST_TEST(report.at("energy").at("contact").at("largest_rise").get<double>() < 1e-4);
  const auto planned = (*this)("simulate stiff.json --method symplectic-euler --duration 0.3 --json").json();
  BOOST_TEST(planned.at("status") == "done");
  BOOST_TEST(planned.at("counts").at("rollbacks") == 0);
  const test::Outcome told = (*this)("simulate cloth.json --method rk4 --duration 0.2 --explain");
  BOOST_TEST(told.status == 0);
  BOOST_TEST(told.out.find("contact, pairs of particle and obstacle") != std::string::npos);
  BOOST_TEST(told.out.find("\ncontact: ") != std::string::npos);
  for (const char* other : {"work-precision cloth.json --duration 0.1", "limits cloth.json --error 0.01",
                            "simulate cloth.json --error 0.01 --duration 0.1"}) {
    const test::Outcome refused = (*this)(other);
    BOOST_TEST(refused.status == 2);
    BOOST_TEST(refused.err.find("takes no account of contact, expected a scene without 'contact'") !=
               std::string::npos);
  }
}

BOOST_AUTO_TEST_CASE(a_program_brings_its_own_obstacles) {
  Scene scene(make_net(Grid{9, 8, 0.07}, {}), {}, {0.1, -9.81, 0}, RayleighDamping{});
  State<Vector> state = scene.rest_state();
  const EnergyWatch watch{.gravity = 9.81, .mass = scene.total_free_mass()};
  Contact contact;
  contact.obstacles = {{Plane{{0, -1, 0}, {0, 1, 0}}}, {Sphere{{0.5, -0.3, 0.5}, 0.2}}};
  contact.friction = 0.3;
  const auto filter = make_contact_filter(contact, scene.free_masses());  // solvers/contact/contact_filter.h
  simulate(scene, *make_stepper(SymplecticEuler()), {1e-3, 400}, watch, state, {}, {}, filter.get());
  BOOST_TEST(filter->counts().impulses > 0);
  BOOST_TEST(least_gap(contact, 0.4, state) > -1e-12);
}

BOOST_AUTO_TEST_SUITE_END()
