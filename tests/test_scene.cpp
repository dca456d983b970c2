// The laws of springs and of the scene that sums them: forces are differenced energies, K and D differenced
// forces; and what pendulums, chains and falling particles are known to do.
#include <Eigen/Geometry>
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "analysis/method.h"
#include "solvers/linear/dense_solvers.h"
#include "solvers/linear/structural_matrices.h"
#include "solvers/methods/rk4.h"
#include "solvers/scene/element_term.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/springs.h"
#include "solvers/stepper.h"
#include "tests/dense.h"

BOOST_AUTO_TEST_SUITE(scene)

using namespace springstab;
using springstab::test::smallest_eigenvalue;

namespace {

using Dense = Eigen::MatrixXd;
using boost::test_tools::tolerance;
using Eigen::Vector3d;

constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double pi = 3.14159265358979323846;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double operator()(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }
  Vector vector(Eigen::Index size, double scale = 1) {
    Vector v(size);
    for (double& entry : v) entry = (*this)(-scale, scale);
    return v;
  }

 private:
  std::mt19937_64 engine_;
};

/// Seven particles of unequal masses in no plane, almost all of them joined by unequal damped springs.
SpringNet random_net(Random& random) {
  SpringNet net;
  for (int i = 0; i < 7; ++i) {
    net.rest.emplace_back(random(-1, 1), random(-1, 1), random(-1, 1));
    net.mass.push_back(std::pow(10, random(-2, 2)));
  }
  for (int i = 0; i < 7; ++i)
    for (int j = i + 1; j < 7; ++j)
      if ((i + j) % 5 != 0)
        net.springs.push_back({i, j, random(5, 200), random(0.1, 3), (net.rest[i] - net.rest[j]).norm()});
  return net;
}

const std::vector<int> some_pins{1, 4};

/// A state of the net, as the positions of all its particles, and how far to go from it for a difference.
struct Pose {
  std::string name;
  std::vector<Vector3d> x;
  double shortest;  // distance of two joined particles [m]
};

std::vector<Pose> poses(const SpringNet& net, Random& random) {
  const auto scaled = [&](double factor, double noise) {
    std::vector<Vector3d> x;
    for (const Vector3d& p : net.rest) x.push_back(factor * p + Vector3d(random.vector(3, noise)));
    return x;
  };
  std::vector<Pose> all{{"rest", scaled(1, 0), 0},
                        {"random", scaled(1, 0.2), 0},
                        {"stretched", scaled(2.5, 0.02), 0},
                        {"compressed", scaled(0.3, 0.02), 0},
                        {"two nearly in one place", scaled(1, 0.1), 0}};
  all.back().x[3] = all.back().x[0] + Vector3d(3e-4, -2e-4, 1e-4);
  for (Pose& pose : all) {
    pose.shortest = 1e300;
    for (const Spring& s : net.springs)
      pose.shortest = std::min(pose.shortest, (pose.x[s.i] - pose.x[s.j]).norm());
  }
  return all;
}

/// Puts the scene's pinned particles where the pose has them and returns the coordinates of the others.
Vector take(Scene& scene, const Pose& pose, const std::vector<int>& pinned) {
  std::vector<Vector3d> held;
  Vector x(scene.size());
  Eigen::Index next = 0;
  for (int i = 0; i < static_cast<int>(pose.x.size()); ++i) {
    if (std::find(pinned.begin(), pinned.end(), i) != pinned.end()) {
      held.push_back(pose.x[i]);
    } else {
      x.segment<3>(next) = pose.x[i];
      next += 3;
    }
  }
  scene.place_pinned(held);
  return x;
}

void for_each_pose(const std::function<void(const SpringNet&, const Pose&, Random&)>& visit) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Random random(seed);
    const SpringNet net = random_net(random);
    for (const Pose& pose : poses(net, random)) BOOST_TEST_CONTEXT("seed " << seed << ", " << pose.name) {
        visit(net, pose, random);
      }
  }
}

Vector mass_vector(const BlockLinearSystem& linear) {
  return springstab::lumped_mass(linear.mass()).diagonal();
}

/// M a [N].
Vector force(Scene& scene, const Vector& x, const Vector& v) {
  Vector a;
  scene.acceleration(x, v, a);
  return mass_vector(*scene.linearization({x, v})).cwiseProduct(a);
}

Dense stiffness(Scene& scene, const Vector& x) {
  return Dense(scene.linearization({x, Vector::Zero(x.size())})->stiffness().to_sparse());
}

/// The Jacobian of f at x by central differences.
Dense differenced(const std::function<Vector(const Vector&)>& f, const Vector& x, double step) {
  Dense jacobian(f(x).size(), x.size());
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const Vector u = step * Vector::Unit(x.size(), j);
    jacobian.col(j) = (f(x + u) - f(x - u)) / (2 * step);
  }
  return jacobian;
}

void check_equal(const Dense& found, const Dense& expected, double relative) {
  BOOST_REQUIRE_EQUAL(found.rows(), expected.rows());
  BOOST_REQUIRE_EQUAL(found.cols(), expected.cols());
  BOOST_TEST((found - expected).norm() <= relative * expected.norm(),
             "relative difference " << (found - expected).norm() / expected.norm());
}

/// One particle on one spring to the origin: a pendulum of length l hanging in gravity along -y.
struct Pendulum {
  double l = 0.7, m = 0.3, g = 9.81;
  double k;

  /// `give` is the stretch m g / k under the weight at rest, relative to l.
  explicit Pendulum(double give) : k(m * g / (give * l)) {}
  Scene scene() const {
    SpringNet net;
    net.rest = {{0, 0, 0}, {0, -l, 0}};
    net.mass = {m, m};
    net.springs = {{0, 1, k, 0, l}};
    return {net, {0}, {0, -g, 0}, {}};
  }
  /// Still, at this angle from the vertical, stretched by what the weight pulls along the link there.
  State<Vector> at(double angle) const {
    const double length = l + m * g * std::cos(angle) / k;
    return {length * Vector{{std::sin(angle), -std::cos(angle), 0}}, Vector::Zero(3)};
  }
};

}  // namespace

// Differences with a step of 1e-4 of the shortest spring: that step squared is the truncation, and rounding
// is eps times the energy divided by the step, relative to a gradient of about the energy.
BOOST_AUTO_TEST_CASE(a_force_is_the_differenced_energy) {
  for_each_pose([](const SpringNet& net, const Pose& pose, Random&) {
    Scene scene(net, some_pins, {0.4, -9.81, 0.2}, {});
    const Vector x = take(scene, pose, some_pins);
    const auto energy = [&](const Vector& at) { return Vector::Constant(1, scene.potential_energy(at)); };
    const Vector gradient = differenced(energy, x, 1e-4 * pose.shortest).transpose();
    BOOST_TEST(gradient.norm() > 1);
    check_equal(force(scene, x, Vector::Zero(x.size())), -gradient, 1e-7);
  });
}

// Here the step is 3e-5 of the shortest spring: 1e-9 from the third derivative, and from the rounding of the
// coordinates, which are about 1, eps divided by the step, 2e-8 where two particles are closest.
BOOST_AUTO_TEST_CASE(the_stiffness_matrix_is_the_differenced_force) {
  for_each_pose([](const SpringNet& net, const Pose& pose, Random& random) {
    Scene scene(net, some_pins, {0.4, -9.81, 0.2}, {});
    const Vector x = take(scene, pose, some_pins), rest = Vector::Zero(x.size());
    const Dense k = stiffness(scene, x);
    const auto f = [&](const Vector& at) { return force(scene, at, rest); };
    check_equal(k, -differenced(f, x, 3e-5 * pose.shortest), 5e-8);
    BOOST_TEST((k == k.transpose()));
    for (Eigen::Index i = 0; i < k.rows(); i += 3) BOOST_TEST((k.block<3, 3>(i, i).norm() > 5));
    BOOST_TEST(k.cwiseAbs().maxCoeff() < 1e6);  // 200 N/m at 3e-4 m of a length of 1 m
    // Tension holds a spring sideways too, pressure makes it buckle.
    if (pose.name == "stretched") BOOST_TEST(smallest_eigenvalue(k) > 1);
    if (pose.name == "compressed") BOOST_TEST(smallest_eigenvalue(k) < -1);

    // The product of the term itself, without pins.
    const Springs springs(net.springs, 7);
    const Vector direction = random.vector(21), before = random.vector(21);
    Vector all(21), whole = before;
    for (int i = 0; i < 7; ++i) all.segment<3>(3 * i) = pose.x[i];
    springs.add_stiffness_times({all.data(), nullptr, 7}, direction.data(), -0.7, whole.data());
    Scene loose(net, {}, {0, 0, 0}, {});
    check_equal(whole - before, -0.7 * stiffness(loose, all) * direction, 1e-12);
    BOOST_TEST((whole - before).norm() > 1);
  });
}

// Σ over springs of k_s nnᵀ and of the positive part of k_s (1 - l0/l)(I - nnᵀ), each positive semidefinite.
BOOST_AUTO_TEST_CASE(a_projected_stiffness_is_positive_semidefinite_and_exact_where_nothing_is_compressed) {
  for_each_pose([](const SpringNet& net, const Pose& pose, Random&) {
    Scene scene(net, some_pins, {0, 0, 0}, {});
    const Vector x = take(scene, pose, some_pins);
    const Dense exact = stiffness(scene, x);
    scene.set_hessian(Hessian::projected);
    const Dense projected = stiffness(scene, x);
    BOOST_TEST(smallest_eigenvalue(projected) > -1e-13 * projected.norm());
    BOOST_TEST(smallest_eigenvalue(projected - exact) > -1e-13 * exact.norm());
    if (pose.name == "stretched") BOOST_TEST((projected == exact));
    if (pose.name == "compressed") {
      BOOST_TEST((projected - exact).norm() > 1e-2 * exact.norm());
      Dense axial = Dense::Zero(21, 21);  // all that is left of a net in which every spring is too short
      for (const Spring& s : net.springs) {
        const Vector3d n = (pose.x[s.i] - pose.x[s.j]).normalized();
        Dense along = Dense::Zero(21, 1);
        along.block<3, 1>(3 * s.i, 0) = n;
        along.block<3, 1>(3 * s.j, 0) = -n;
        axial += s.stiffness * along * along.transpose();
      }
      Scene loose(net, {}, {0, 0, 0}, {});
      loose.set_hessian(Hessian::projected);
      Vector all(21);
      for (int i = 0; i < 7; ++i) all.segment<3>(3 * i) = pose.x[i];
      check_equal(stiffness(loose, all), axial, 1e-13);
    }
  });
}

// The damping force is linear in v: any difference is exact.
BOOST_AUTO_TEST_CASE(the_damping_matrix_is_the_differenced_force) {
  for_each_pose([](const SpringNet& net, const Pose& pose, Random& random) {
    Scene scene(net, some_pins, {0, 0, 0}, {});
    const Vector x = take(scene, pose, some_pins), v = random.vector(x.size());
    BOOST_TEST(scene.has_own_damping());
    const Dense c(scene.linearization({x, v})->own_damping()->to_sparse());
    // Without springs' stiffness, lest its rounding covers the damping's.
    std::vector<Spring> dampers = net.springs;
    for (Spring& s : dampers) s.stiffness = 0;
    Scene damped(SpringNet{net.rest, net.mass, dampers}, some_pins, {0, 0, 0}, {});
    take(damped, pose, some_pins);
    const auto f = [&](const Vector& at) { return force(damped, x, at); };
    check_equal(c, -differenced(f, v, 1), 1e-12);
    BOOST_TEST((c == c.transpose()));
    BOOST_TEST(smallest_eigenvalue(c) > -1e-13 * c.norm());
    for (Eigen::Index i = 0; i < c.rows(); i += 3) BOOST_TEST((c.block<3, 3>(i, i).norm() > 0.1));
    // The power along the axes: Σ k_d ((v_i - v_j)·n)².
    double power = 0;
    int place[7], next = 0;
    for (int i = 0; i < 7; ++i) place[i] = i == 1 || i == 4 ? -1 : next++;
    const auto velocity = [&](int i) {
      return place[i] < 0 ? Vector3d(0, 0, 0) : Vector3d(v.segment<3>(3 * place[i]));
    };
    for (const Spring& s : net.springs) {
      const double rate = (velocity(s.i) - velocity(s.j)).dot((pose.x[s.i] - pose.x[s.j]).normalized());
      power += s.damping * rate * rate * (place[s.i] >= 0 || place[s.j] >= 0);
    }
    BOOST_TEST(v.dot(c * v) == power, tolerance(1e-12));
    BOOST_TEST(-v.dot(f(v)) == power, tolerance(1e-12));
  });
}

BOOST_AUTO_TEST_CASE(a_free_net_exerts_no_force_and_no_torque_on_itself) {
  for_each_pose([](const SpringNet& net, const Pose& pose, Random& random) {
    Scene scene(net, {}, {0, 0, 0}, {0, 0.01});
    const Vector x = take(scene, pose, {}), v = random.vector(x.size());
    const Vector f = force(scene, x, v);
    Vector3d sum(0, 0, 0), torque(0, 0, 0);
    double size = 0;
    for (Eigen::Index i = 0; i < f.size(); i += 3) {
      sum += f.segment<3>(i);
      size += f.segment<3>(i).norm();
    }
    BOOST_TEST(size > 1);
    // Dividing by the mass and multiplying again rounds each force; 18 springs are summed.
    BOOST_TEST(sum.norm() <= 20 * eps * size);
    // (x_i - x_j) × n vanishes for forces along the springs; alpha K v is not along them.
    Scene undamped(net, {}, {0, 0, 0}, {});
    const Vector along = force(undamped, x, v);
    for (Eigen::Index i = 0; i < f.size(); i += 3)
      torque += Vector3d(x.segment<3>(i)).cross(Vector3d(along.segment<3>(i)));
    BOOST_TEST(torque.norm() <= 100 * eps * along.lpNorm<1>() * x.lpNorm<Eigen::Infinity>());
  });
}

BOOST_AUTO_TEST_CASE(forces_turn_with_the_net) {
  for_each_pose([](const SpringNet& net, const Pose& pose, Random& random) {
    const Eigen::Matrix3d turn(Eigen::AngleAxisd(1.1, Vector3d(0.2, -0.7, 0.4).normalized()));
    Scene scene(net, some_pins, {0, 0, 0}, {0.3, 0.02});
    const auto turned = [&](const Vector& u) -> Vector {
      return (turn * u.reshaped(3, u.size() / 3)).reshaped();
    };
    const Vector x = take(scene, pose, some_pins), v = random.vector(x.size());
    const Vector f = force(scene, x, v);
    Pose other = pose;
    for (Vector3d& p : other.x) p = turn * p;
    const Vector turned_x = take(scene, other, some_pins);
    // Differences of positions lose eps/shortest.
    check_equal(force(scene, turned_x, turned(v)), turned(f), 100 * eps / pose.shortest);
  });
}

BOOST_AUTO_TEST_CASE(a_pinned_scene_is_a_part_of_the_free_one) {
  for_each_pose([](const SpringNet& net, const Pose& pose, Random& random) {
    Scene free(net, {}, {0.1, -9.81, 0}, {0.3, 0.02}), pinned(net, some_pins, {0.1, -9.81, 0}, {0.3, 0.02});
    const Vector all = take(free, pose, {}), x = take(pinned, pose, some_pins);
    Eigen::ArrayXi kept(15);
    for (int i = 0, next = 0; i < 7; ++i)
      if (i != some_pins[0] && i != some_pins[1])
        for (int r = 0; r < 3; ++r) kept[next++] = 3 * i + r;
    BOOST_REQUIRE_EQUAL(pinned.size(), 15);
    BOOST_TEST((all(kept) == x));
    // A block on the diagonal is a sum of at most six, in the order of each scene's own numbers.
    const auto check_blocks = [](const Dense& found, const Dense& expected) {
      const double largest = expected.cwiseAbs().maxCoeff();
      BOOST_TEST((found - expected).cwiseAbs().maxCoeff() <= 6 * 5 * eps * largest);
      BOOST_TEST(largest > 0);
    };
    check_blocks(stiffness(pinned, x), stiffness(free, all)(kept, kept));
    const auto damping = [](Scene& scene, const Vector& at) {
      return Dense(scene.linearization({at, at})->own_damping()->to_sparse());
    };
    check_blocks(damping(pinned, x), damping(free, all)(kept, kept));
    const Vector v = random.vector(15);
    Vector all_v = Vector::Zero(21);
    all_v(kept) = v;
    check_equal(force(pinned, x, v), force(free, all, all_v)(kept), 1e-13);

    const std::vector<Vector3d> everywhere = pinned.positions(x);
    for (int i = 0; i < 7; ++i) BOOST_TEST((everywhere[i] == pose.x[i]));
    double mass = 0;
    for (int i = 0; i < 7; ++i) mass += i == 1 || i == 4 ? 0 : net.mass[i];
    BOOST_TEST(pinned.total_free_mass() == mass, tolerance(1e-15));
    BOOST_TEST(pinned.particles() == 7);
    BOOST_TEST(pinned.free_particles() == 5);
  });
}

BOOST_AUTO_TEST_CASE(a_scene_starts_at_rest_where_the_net_is) {
  Random random(4);
  const SpringNet net = random_net(random);
  Scene scene(net, some_pins, {0, 0, 0}, {});
  const State<Vector> start = scene.rest_state();
  const std::vector<Vector3d> everywhere = scene.positions(start.x);
  for (int i = 0; i < 7; ++i) BOOST_TEST((everywhere[i] == net.rest[i]));
  BOOST_TEST(start.v.isZero(0));
  BOOST_TEST(scene.elastic_energy(start.x) == 0);
  BOOST_TEST(force(scene, start.x, start.v).isZero(1e-12));
}

// M a = f_elastic + M g - d0 M v - alpha K(x) v - C(x) v, each part from elsewhere.
BOOST_AUTO_TEST_CASE(rayleigh_damping_acts_through_the_stiffness_of_the_moment) {
  for_each_pose([](const SpringNet& net, const Pose& pose, Random& random) {
    const RayleighDamping damping{0.8, 0.05};
    Scene scene(net, some_pins, {0.4, -9.81, 0.2}, damping), plain(net, some_pins, {0.4, -9.81, 0.2}, {});
    const Vector x = take(scene, pose, some_pins), v = random.vector(x.size()),
                 still = Vector::Zero(x.size());
    take(plain, pose, some_pins);
    BlockLinearSystem linear = *plain.linearization({x, still});
    const Vector m = mass_vector(linear);
    const Dense k(linear.stiffness().to_sparse()), c(linear.own_damping()->to_sparse());
    const Vector damped = -damping.d0 * m.cwiseProduct(v) - damping.alpha * (k * v) - c * v;
    const Vector expected = force(plain, x, still) + damped;
    check_equal(force(scene, x, v), expected, 1e-12);
    BOOST_TEST(damped.norm() > 1e-3 * expected.norm());

    // The frozen system: -K'u - D'v, without gravity and without what the springs pull already.
    BlockLinearSystem frozen = *scene.linearization({x, v});
    const Vector u = random.vector(x.size());
    Vector a;
    frozen.acceleration(u, v, a);
    check_equal(m.cwiseProduct(a), -k * u + damped, 1e-12);

    plain.set_damping(damping);
    BOOST_TEST((force(plain, x, v) == force(scene, x, v)));
    plain.linearization({x, v})->acceleration(u, v, a);
    check_equal(m.cwiseProduct(a), -k * u + damped, 1e-12);
  });
}

BOOST_AUTO_TEST_CASE(energies_are_those_of_the_particles) {
  for_each_pose([](const SpringNet& net, const Pose& pose, Random& random) {
    const Vector3d g(0.4, -9.81, 0.2);
    Scene scene(net, some_pins, g, {});
    const Vector x = take(scene, pose, some_pins), v = random.vector(x.size());
    double elastic = 0, weight = 0, kinetic = 0;
    for (const Spring& s : net.springs)
      if (!(s.i == 1 && s.j == 4))
        elastic += 0.5 * s.stiffness * std::pow((pose.x[s.i] - pose.x[s.j]).norm() - s.rest_length, 2);
    for (int i = 0, place = 0; i < 7; ++i) {
      if (i == 1 || i == 4) continue;
      weight -= net.mass[i] * g.dot(pose.x[i]);
      kinetic += 0.5 * net.mass[i] * v.segment<3>(3 * place++).squaredNorm();
    }
    if (pose.name == "rest") {
      BOOST_TEST(elastic < 1e-25);
    } else {
      BOOST_TEST(elastic > 0.1);
      BOOST_TEST(scene.elastic_energy(x) == elastic, tolerance(1e-12));
    }
    BOOST_TEST(std::abs(scene.potential_energy(x) - elastic - weight) <=
               1e-12 * (elastic + std::abs(weight)));
    BOOST_TEST(scene.kinetic_energy(v) == kinetic, tolerance(1e-13));
  });
}

BOOST_AUTO_TEST_CASE(a_scene_without_linearizations_has_no_matrix) {
  Random random(6);
  const SpringNet net = random_net(random);
  Scene scene(net, some_pins, {0, -9.81, 0}, {0.1, 1e-3});
  State<Vector> state = scene.rest_state();
  state.v.setConstant(0.1);
  const auto explicit_method = Method("rk4").stepper();
  BOOST_REQUIRE((explicit_method->step(scene, 1e-4, state) == StepStatus::done));
  scene.set_damping({0.2, 2e-3});
  BOOST_TEST(scene.kinetic_energy(state.v) > 0);
  BOOST_TEST(!scene.has_matrices());
  const RayleighDamping damping = scene.linearization(state)->damping();
  BOOST_TEST(scene.has_matrices());
  BOOST_TEST(damping.d0 == 0.2);
  BOOST_TEST(damping.alpha == 2e-3);
}

// A scene that forgot its matrices makes the same ones again.
BOOST_AUTO_TEST_CASE(matrices_that_were_forgotten_come_again) {
  Random random(6);
  const SpringNet net = random_net(random);
  Scene scene(net, some_pins, {0, -9.81, 0}, {0.1, 1e-3});
  State<Vector> state = scene.rest_state();
  for (double& x : state.x) x += 0.01 * random(-1, 1);
  const auto first = scene.linearization(state);
  scene.forget_matrices();
  BOOST_TEST(!scene.has_matrices());
  const auto again = scene.linearization(state);
  BOOST_TEST(scene.has_matrices());
  BOOST_TEST(first->stiffness().blocks() > first->stiffness().rows());
  BOOST_TEST(
      (Eigen::MatrixXd(first->stiffness().to_sparse()) == Eigen::MatrixXd(again->stiffness().to_sparse())));
  BOOST_REQUIRE((first->own_damping() && again->own_damping()));
  BOOST_TEST((Eigen::MatrixXd(first->own_damping()->to_sparse()) ==
              Eigen::MatrixXd(again->own_damping()->to_sparse())));
}

// Each who asks has a linearization of its own, and what one does with it the others do not see.
BOOST_AUTO_TEST_CASE(a_linearization_is_owned_by_who_asked) {
  Random random(8);
  const SpringNet net = random_net(random);
  const auto scene =
      std::make_unique<Scene>(net, some_pins, Eigen::Vector3d(0, -9.81, 0), RayleighDamping{0.1, 1e-3});
  State<Vector> state = scene->rest_state(), moved = state;
  for (double& x : moved.x) x += 0.01 * random(-1, 1);
  Linearization<Vector> mine, shared;
  scene->linearize(state.x, state.v, mine);
  const LinearSystem* const first = mine.get();
  Vector before, after;
  mine->stiffness_times(moved.x, before);

  const auto other = scene->linearization(moved);
  scene->set_damping({5, 5});
  mine->stiffness_times(moved.x, after);
  BOOST_TEST((before == after));
  BOOST_TEST(other->damping().alpha == 1e-3);
  BOOST_TEST((other->stiffness().pattern() == scene->linearization(state)->stiffness().pattern()));

  shared = mine;  // the next one does not take from under the second holder
  scene->linearize(moved.x, moved.v, mine);
  BOOST_TEST(mine.get() != first);
  shared->stiffness_times(moved.x, after);
  BOOST_TEST((before == after));
  shared.reset();
  const LinearSystem* const second = mine.get();
  scene->linearize(state.x, state.v, mine);
  BOOST_TEST(mine.get() == second);  // its own memory again
  mine->stiffness_times(moved.x, after);
  BOOST_TEST((before == after));

  // One that another scene made is not written over.
  const auto twin = std::make_unique<Scene>(net, some_pins, Eigen::Vector3d(0, -9.81, 0), RayleighDamping{});
  auto theirs = twin->linearization(moved);
  const BlockLinearSystem* const of_twin = theirs.get();
  const auto kept = theirs;
  scene->linearize(state.x, state.v, theirs);
  BOOST_TEST(theirs.get() != of_twin);
}

BOOST_AUTO_TEST_CASE(what_a_scene_lacks_is_not_stored) {
  Random random(5);
  SpringNet net = random_net(random);
  const auto blocks = [](Scene& scene) {
    const State<Vector> start = scene.rest_state();
    return scene.linearization(start)->stiffness().blocks();
  };
  long between_free = 0;
  for (const Spring& s : net.springs) between_free += s.i != 1 && s.j != 1 && s.i != 4 && s.j != 4;
  Scene pinned(net, some_pins, {0, 0, 0}, {});
  BOOST_TEST(blocks(pinned) == 5 + between_free);

  for (std::size_t i = 1; i < net.springs.size(); ++i) net.springs[i].damping = 0;
  Scene one_damper(net, {}, {0, 0, 0}, {});
  const State<Vector> start = one_damper.rest_state();
  BOOST_TEST(one_damper.linearization(start)->own_damping()->blocks() == 7 + 1);

  net.springs[0].damping = 0;
  Scene undamped(net, {}, {0, 0, 0}, {0.1, 0.1});
  BOOST_TEST(!undamped.has_own_damping());
  BOOST_TEST(undamped.linearization(start)->own_damping() == nullptr);

  net.springs.clear();
  Scene dust(net, some_pins, {0, -9.81, 0}, {0.1, 0.1});
  BOOST_TEST(blocks(dust) == 5);
  BOOST_TEST(!dust.has_own_damping());
  BOOST_TEST(dust.elastic_energy(dust.rest_state().x) == 0);
}

BOOST_AUTO_TEST_CASE(impossible_pins_are_refused) {
  Random random(6);
  const SpringNet net = random_net(random);
  const auto scene = [&](const std::vector<int>& pinned) { return Scene(net, pinned, {0, 0, 0}, {}); };
  BOOST_CHECK_THROW(scene({-1}), std::invalid_argument);
  BOOST_CHECK_THROW(scene({7}), std::invalid_argument);
  BOOST_CHECK_THROW(scene({0, 1, 2, 3, 4, 5, 6}), std::invalid_argument);
  Scene last = scene({0, 1, 2, 3, 4, 5});
  BOOST_TEST(last.size() == 3);
  BOOST_CHECK_THROW(last.place_pinned({{0, 0, 0}}), std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(two_particles_in_one_place_make_a_step_diverge_and_leave_the_state) {
  Random random(7);
  const SpringNet net = random_net(random);
  Scene scene(net, {}, {0, 0, 0}, {});
  for (const Method& method : all_methods()) BOOST_TEST_CONTEXT(method.name()) {
      State<Vector> state = scene.rest_state();
      state.x.segment<3>(0) = state.x.segment<3>(9);
      const Vector before = state.x;
      BOOST_TEST((method.stepper()->step(scene, 1e-3, state) == StepStatus::diverged));
      BOOST_TEST((state.x == before));
      BOOST_TEST(state.v.isZero(0));
    }
}

// Constant acceleration: x_n = x0 + n h v0 + ½ g h² (n² + c n) with c = -1 where the old velocity moves the
// particle, 1 where the new one does, and 0 for the methods of second order and beyond, which are exact.
BOOST_AUTO_TEST_CASE(an_unconnected_particle_falls_as_each_method_must_have_it) {
  SpringNet net;
  net.rest = {{1, 2, 3}, {0, 0, 0}};
  net.mass = {0.02, 50};
  const Vector g{{0.5, -9.81, 1}};
  Scene scene(net, {1}, g, {});
  const double h = 0.01;
  const int n = 200;
  for (const Method& method : all_methods()) BOOST_TEST_CONTEXT(method.name()) {
      State<Vector> state = scene.rest_state();
      state.v << 3, 1, -2;
      const State<Vector> start = state;
      const auto stepper = method.stepper();
      for (int i = 0; i < n; ++i) BOOST_REQUIRE((stepper->step(scene, h, state) == StepStatus::done));
      const int c = method.info().order >= 2 ? 0 : method.info().implicit ? 1 : -1;
      const Vector fallen = start.x + n * h * start.v + 0.5 * h * h * (n * n + c * n) * g;
      check_equal(state.x, fallen, n * eps);
      check_equal(state.v, start.v + n * h * g, n * eps);
    }
}

// A term as a user writes one: one particle is held to a point of space by E = ½ k |d|² + ¼ q |d|⁴, so that
// K = (k + q |d|²) 1 + 2 q d dᵀ.
class Anchor final : public ElasticTerm {
 public:
  Anchor(int particle, const Vector3d& point, double k, double q)
      : particle_(particle), point_(point), k_(k), q_(q) {}
  std::string_view name() const override { return "anchors"; }
  int size() const override { return 1; }
  double energy(const ParticleField& x) const override {
    const double s = offset(x).squaredNorm();
    return k_ * s / 2 + q_ * s * s / 4;
  }
  void add_force(const ParticleField& x, double* force) const override {
    const Vector3d d = offset(x);
    at(force) -= (k_ + q_ * d.squaredNorm()) * d;
  }
  void add_stiffness_times(const ParticleField& x, const double* u, double scale,
                           double* out) const override {
    at(out) += scale * (hessian(x) * Eigen::Map<const Vector3d>(u + 3 * particle_));
  }
  Couplings couplings() const override { return {}; }  // the diagonal is always there
  void add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override {
    Eigen::Map<Eigen::Matrix3d>(stiffness.block(stiffness.diagonal(particle_))) += hessian(x);
  }
  void add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override {
    add_stiffness(x, stiffness);  // it is positive semidefinite everywhere
  }

 private:
  Vector3d offset(const ParticleField& x) const { return Eigen::Map<const Vector3d>(x[particle_]) - point_; }
  Eigen::Matrix3d hessian(const ParticleField& x) const {
    const Vector3d d = offset(x);
    return (k_ + q_ * d.squaredNorm()) * Eigen::Matrix3d::Identity() + 2 * q_ * d * d.transpose();
  }
  Eigen::Map<Vector3d> at(double* field) const { return Eigen::Map<Vector3d>(field + 3 * particle_); }

  int particle_;
  Vector3d point_;
  double k_, q_;
};

TermMaker anchor(int particle, const Vector3d& point, double k, double q) {
  return [=](const std::vector<int>& number, int) {
    SceneTerms terms;
    terms.elastic.push_back(std::make_unique<Anchor>(number[particle], point, k, q));
    return terms;
  };
}

BOOST_AUTO_TEST_CASE(a_users_term_acts_beside_those_of_a_net) {
  for_each_pose([](const SpringNet& net, const Pose& pose, Random& random) {
    const RayleighDamping damping{0.3, 0.02};
    Scene without(net, some_pins, Vector3d::Zero(), damping), with(net, some_pins, Vector3d::Zero(), damping);
    with.add(anchor(5, Vector3d(0.4, -0.3, 0.2), 30, 70));
    const Vector x = take(with, pose, some_pins), v = random.vector(x.size(), 1);
    take(without, pose, some_pins);
    BOOST_TEST(with.terms().elastic.size() == without.terms().elastic.size() + 1);

    const Dense added = stiffness(with, x) - stiffness(without, x);
    const auto more_force = [&](const Vector& at) {
      return Vector(force(with, at, 0 * v) - force(without, at, 0 * v));
    };
    const auto more_energy = [&](const Vector& at) {
      return Vector::Constant(1, with.elastic_energy(at) - without.elastic_energy(at));
    };
    BOOST_TEST(added.norm() > 10);
    const Vector gradient = differenced(more_energy, x, 1e-4).transpose();
    BOOST_TEST((more_force(x) + gradient).norm() <= 1e-5 * (1 + gradient.norm()));
    check_equal(added, -differenced(more_force, x, 1e-4), 1e-5);
    // Rayleigh damping resists with the term's stiffness, too.
    const Vector damped = force(with, x, v) - force(without, x, v) - more_force(x);
    check_equal(damped, Vector(-damping.alpha * (added * v)), 1e-9);
  });
}

/// ½ k (l - l0)² of two corners.
ElementEnergy<2> spring_energy(double k, double rest, const Eigen::Matrix<double, 3, 2>& at) {
  const Vector3d d = at.col(0) - at.col(1), n = d.normalized();
  const double l = d.norm();
  const Eigen::Matrix3d block =
      k * ((1 - rest / l) * (Eigen::Matrix3d::Identity() - n * n.transpose()) + n * n.transpose());
  ElementEnergy<2> e{k * (l - rest) * (l - rest) / 2, {}, {}};
  e.gradient << k * (l - rest) * n, -k * (l - rest) * n;
  e.hessian << block, -block, -block, block;
  return e;
}

// Springs said as elements are springs: pinned ends, every product, and the projection.
BOOST_AUTO_TEST_CASE(a_term_from_an_elements_energy_is_that_term) {
  for_each_pose([](const SpringNet& net, const Pose& pose, Random& random) {
    std::vector<std::array<int, 2>> ends;
    std::vector<Spring> springs;
    for (const Spring& s : net.springs)
      if (s.stiffness > 0) ends.push_back({s.j, s.i}), springs.push_back(s);
    const RayleighDamping damping{0.3, 0.02};
    const TermMaker law = element_term<2>("springs", ends, [springs](int e, const auto& at) {
      return spring_energy(springs[e].stiffness, springs[e].rest_length, at);
    });
    SpringNet elastic = net;
    for (Spring& s : elastic.springs) s.damping = 0;
    Scene theirs(elastic, some_pins, Vector3d::Zero(), damping),
        ours(net.rest, net.mass, law, some_pins, Vector3d::Zero(), damping);
    const Vector x = take(theirs, pose, some_pins), v = random.vector(x.size(), 1);
    take(ours, pose, some_pins);
    BOOST_TEST(ours.elastic_energy(x) == theirs.elastic_energy(x), tolerance(1e-12));
    check_equal(force(ours, x, v), force(theirs, x, v), 1e-12);
    check_equal(stiffness(ours, x), stiffness(theirs, x), 1e-12);
    for (Scene* scene : {&ours, &theirs}) scene->set_hessian(Hessian::projected);
    check_equal(stiffness(ours, x), stiffness(theirs, x), 1e-12);
  });
}

BOOST_AUTO_TEST_CASE(a_scene_of_users_terms_alone_moves_as_they_say) {
  const double k = 12, m = 0.4;
  const Vector3d point(0.1, 0.2, -0.3);
  Scene scene({{0.5, 0.2, -0.3}, {3, 0, 0}}, {m, 1}, anchor(0, point, k, 0), {1}, Vector3d::Zero(), {});
  BOOST_TEST(scene.size() == 3);
  BOOST_TEST(stiffness(scene, scene.rest_state().x)(1, 1) == k);
  State<Vector> state = scene.rest_state();
  const double period = 2 * pi * std::sqrt(m / k);
  const auto stepper = make_stepper(Rk4());
  for (int i = 0; i < 250; ++i)
    BOOST_REQUIRE((stepper->step(scene, period / 1000, state) == StepStatus::done));
  BOOST_TEST((state.x - point).norm() <= 1e-8);  // after a quarter of a period
  BOOST_TEST(state.v[0] == -0.4 * std::sqrt(k / m), tolerance(1e-8));

  BOOST_CHECK_THROW(scene.add(anchor(0, point, 1, 0)), std::invalid_argument);  // it has matrices
  for (const double bad : {0.0, -1.0, double{NAN}, double{INFINITY}})
    BOOST_CHECK_THROW(Scene({{0, 0, 0}}, {bad}, anchor(0, point, 1, 0), {}, point, {}),
                      std::invalid_argument);
  BOOST_CHECK_THROW(Scene({{0, 0, 0}}, {1, 1}, anchor(0, point, 1, 0), {}, point, {}), std::invalid_argument);
}

// v' = g - d0 v; g/d0 is a fixed point of every method, approached by |R(-0.5)| <= 2/3 a step.
BOOST_AUTO_TEST_CASE(air_drag_ends_in_the_terminal_velocity) {
  SpringNet net;
  net.rest = {{0, 0, 0}};
  net.mass = {3};
  const Vector g{{0.5, -9.81, 1}};
  const double d0 = 0.7;
  Scene scene(net, {}, g, {d0, 0.4});
  for (const Method& method : all_methods()) BOOST_TEST_CONTEXT(method.name()) {
      State<Vector> state = scene.rest_state();
      state.v << 100, 50, -20;
      const auto stepper = method.stepper();
      for (int i = 0; i < 100; ++i)
        BOOST_REQUIRE((stepper->step(scene, 0.5 / d0, state) == StepStatus::done));
      // Implicit Euler leaves the tolerance of its solve, of a change that itself vanishes.
      check_equal(state.v, g / d0, 1e-13);
    }
}

// T/T0 = (2/π) K(sin²(θ/2)). The link bears at most 3 - 2 cos θ < 5 weights, so that its length is within 5
// give of l and the period within half of that. RK4 with ten steps per radial oscillation adds far less.
BOOST_AUTO_TEST_CASE(a_pendulum_swings_with_the_period_of_the_elliptic_integral) {
  const double give = 1e-6;
  const Pendulum pendulum(give);
  Scene scene = pendulum.scene();
  const double h = 0.6 * std::sqrt(pendulum.m / pendulum.k), t0 = 2 * pi * std::sqrt(pendulum.l / pendulum.g);
  const std::pair<double, double> known[] = {
      {30, 1.01740879759596}, {90, 1.1803405990161}, {150, 1.76220372950376}};
  for (const auto& [degrees, ratio] : known) BOOST_TEST_CONTEXT(degrees << " degrees") {
      State<Vector> state = pendulum.at(degrees * pi / 180);
      const auto stepper = Method("rk4").stepper();
      double t = 0, above = 0;
      while (state.x[0] > 0 && t < t0) {
        above = state.x[0];
        BOOST_REQUIRE((stepper->step(scene, h, state) == StepStatus::done));
        t += h;
      }
      const double quarter = t - h * state.x[0] / (state.x[0] - above);
      BOOST_TEST(std::abs(4 * quarter / t0 / ratio - 1) <= 2.5 * give,
                 "relative difference " << 4 * quarter / t0 / ratio - 1);
    }
}

// At its equilibrium, link i of a chain of springs is stretched by what hangs below it, and K sideways is
// that of the inextensible chain but for 1/(1 + stretch): so is every eigenvalue ω². In between lies a root
// of L_n.
BOOST_AUTO_TEST_CASE(a_hanging_chain_has_the_frequencies_of_the_laguerre_polynomial) {
  constexpr int n = 12;
  const double l = 0.25, m = 0.4, g = 9.81, stretch = 1e-5;
  const double k = n * m * g / (stretch * l);
  SpringNet net;
  Vector x(3 * n);
  double y = 0;
  net.rest.emplace_back(0, 0, 0);
  for (int i = 0; i < n; ++i) {
    net.rest.emplace_back(0, -(i + 1) * l, 0);
    net.springs.push_back({i, i + 1, k, 0, l});
    y -= l + (n - i) * m * g / k;
    x.segment<3>(3 * i) = Vector3d(0, y, 0);
  }
  net.mass.assign(n + 1, m);
  Scene scene(net, {0}, {0, -g, 0}, {});
  Vector a;
  scene.acceleration(x, Vector::Zero(3 * n), a);
  BOOST_TEST(a.norm() <= 1e-8 * g);  // k eps (n l) / m
  const Dense matrix = stiffness(scene, x) / (m * g / l);
  const Vector squares = Eigen::SelfAdjointEigenSolver<Dense>(matrix).eigenvalues();
  for (unsigned j = 0; j < n; ++j) BOOST_TEST_CONTEXT("mode " << j) {
      const double across = squares[2 * j], again = squares[2 * j + 1];  // in x and in z
      BOOST_TEST(across == again, tolerance(1e-9));
      const double low = across * (1 - 1e-9), high = again * (1 + stretch) * (1 + 1e-9);
      BOOST_TEST(std::laguerre(n, low) * std::laguerre(n, high) < 0, low << " to " << high);
    }
  BOOST_TEST(squares[2 * n] > 100 * squares[2 * n - 1]);  // along the chain
}

BOOST_AUTO_TEST_SUITE_END()
