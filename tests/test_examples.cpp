// The worked example of each main header compiles as it stands there, and does what it says.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "analysis/errors/linear_motion.h"
#include "analysis/gsl/numerics.h"
#include "analysis/limits/step_policy.h"
#include "analysis/limits/structure_limits.h"
#include "analysis/limits/transient_growth.h"
#include "analysis/model.h"
#include "analysis/regions/stability_region.h"
#include "analysis/spectra/spectrum.h"
#include "scratch.h"
#include "solvers/io/matrix_file.h"
#include "solvers/methods/list.h"
#include "solvers/scene/element_term.h"
#include "solvers/scene/elements.h"
#include "solvers/scene/spring_cloth.h"
#include "solvers/simulation.h"
#include "solvers/spring_chain.h"

namespace springstab::test {
namespace {

#include "examples/solvers/methods/method_info.h"

/// Pulls a particle to where the origin is, with 1 N/m.
class MyAnchor final : public ElasticTerm {
 public:
  MyAnchor(int particle, int free_count) : particle_(particle), size_(particle < free_count ? 1 : 0) {}
  std::string_view name() const override { return "anchors"; }
  int size() const override { return size_; }
  double energy(const ParticleField& x) const override {
    return size_ ? Eigen::Map<const Eigen::Vector3d>(x[particle_]).squaredNorm() / 2 : 0;
  }
  void add_force(const ParticleField& x, double* force) const override {
    for (int r = 0; r < 3 && size_; ++r) force[3 * particle_ + r] -= x[particle_][r];
  }
  void add_stiffness_times(const ParticleField&, const double* u, double scale, double* out) const override {
    for (int r = 0; r < 3 && size_; ++r) out[3 * particle_ + r] += scale * u[3 * particle_ + r];
  }
  Couplings couplings() const override { return {}; }
  void add_stiffness(const ParticleField&, BlockSparseMatrix& stiffness) const override {
    for (int r = 0; r < 3 && size_; ++r) stiffness.block(stiffness.diagonal(particle_))[4 * r] += 1;
  }
  void add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override {
    add_stiffness(x, stiffness);
  }

 private:
  int particle_, size_;
};

/// In a folder with K.mtx = [[2, -1], [-1, 2]] and M.mtx = diag(1, 2), to which std::cout is silent.
class BesideMatrices {
 public:
  BesideMatrices() : before_(std::filesystem::current_path()), cout_(std::cout.rdbuf(said.rdbuf())) {
    std::filesystem::current_path(folder_.path());
    std::ofstream("K.mtx")
        << "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2\n2 1 -1\n2 2 2\n";
    std::ofstream("M.mtx") << "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 1\n2 2 2\n";
  }
  ~BesideMatrices() {
    std::cout.rdbuf(cout_);
    std::filesystem::current_path(before_);
  }
  std::ostringstream said;

 private:
  ScratchFolder folder_;
  std::filesystem::path before_;
  std::streambuf* cout_;
};

SparseMatrix matrix(double a, double b, double c) {
  SparseMatrix m(2, 2);
  m.insert(0, 0) = a;
  m.insert(0, 1) = m.insert(1, 0) = b;
  m.insert(1, 1) = c;
  return m;
}

const SparseMatrix stiffness = matrix(2, -1, 2), mass = matrix(1, 0, 2), damping = matrix(3, 0, 1);

Scene small_scene() { return {make_net(Grid{3, 3}, SpringMaterial{}), {0, 2}, {0, -9.81, 0}, {}}; }

}  // namespace

BOOST_AUTO_TEST_SUITE(examples)

BOOST_AUTO_TEST_CASE(a_scene_falls) {
#include "examples/solvers/scene/scene.h"
  BOOST_TEST(state.v.minCoeff() < -0.1);
  BOOST_TEST(state.x.allFinite());
}

BOOST_AUTO_TEST_CASE(a_term_of_ones_own_joins_a_scene) {
  Scene scene = small_scene();
#include "examples/solvers/scene/terms.h"
  BOOST_TEST(scene.terms().elastic.back()->size() == 1);
}

BOOST_AUTO_TEST_CASE(a_term_is_an_elements_energy) {
  const SpringNet net = make_net(Grid{4, 4}, SpringMaterial{});
  Scene scene(net, {0, 3}, {0, 0, 0}, {});
#include "examples/solvers/scene/element_term.h"
  State<Vector> state = scene.rest_state();
  state.x.array() += 0.1;
  const double moved = scene.elastic_energy(state.x);
  BOOST_TEST(scene.terms().elastic.back()->energy(scene.position_field(state.x)) == 5 * 0.03 / 2,
             boost::test_tools::tolerance(1e-12));
  BOOST_TEST(moved > 5 * 0.03 / 2);
}

BOOST_AUTO_TEST_CASE(what_elements_compute_reaches_their_particles) {
  const Elements<2> elements({{0, 1}}, 2);
  const double places[6] = {0, 0, 0, 2, 0, 0}, rest_[1][batch_size] = {{0.5}};
  const double stiffness_ = 3;
  double force[6] = {};
  const ParticleField x{places, nullptr, 2};
#include "examples/solvers/scene/elements.h"
  BOOST_TEST(force[0] == 3);
  BOOST_TEST(force[3] == -3);
}

BOOST_AUTO_TEST_CASE(a_run_stops_where_it_is_told) {
  Scene scene = small_scene();
  State<Vector> state = scene.rest_state();
#include "examples/solvers/simulation.h"
  BOOST_TEST((end.status == StepStatus::done));
  BOOST_TEST(end.steps == 50);
}

BOOST_AUTO_TEST_CASE(a_stepper_steps) {
  Scene system = small_scene();
  State<Vector> state = system.rest_state();
  const double h = 1e-3, end = 0.01;
  double time = 0;
#include "examples/solvers/stepper.h"
  BOOST_TEST(time >= end);
}

BOOST_AUTO_TEST_CASE(a_chain_swings_through) {
#include "examples/solvers/spring_chain.h"
  BOOST_TEST(state.x[1] <= 0);
}

BOOST_AUTO_TEST_CASE(matrices_are_made_ready) {
  BesideMatrices here;
#include "examples/solvers/linear/structural_matrices.h"
  BOOST_TEST(here.said.str() == "2 unknowns, 0 without mass were condensed\n");
}

BOOST_AUTO_TEST_CASE(matrices_move) {
#include "examples/solvers/linear/matrix_system.h"
  BOOST_TEST(state.v.norm() > 0);
}

BOOST_AUTO_TEST_CASE(a_method_of_ones_own_has_a_region_and_runs) {
  Scene scene = small_scene();
  State<Vector> state = scene.rest_state();
  const StepPlan plan{1e-4, 10};
  const EnergyWatch watch{.gravity = 9.81, .mass = scene.total_free_mass()};
#include "examples/analysis/method.h"
  BOOST_TEST(y_max == stability_region("explicit-euler").constants().y_max);
  BOOST_TEST(rk4.info().order == 4);
  BOOST_TEST(state.v.norm() > 0);
}

BOOST_AUTO_TEST_CASE(a_model_is_asked_and_run) {
  const SpringNet net = make_net(Grid{3, 3}, SpringMaterial{});
  const std::vector<int> pinned{0, 2};
  const Eigen::Vector3d gravity(0, -9.81, 0);
#include "examples/analysis/model.h"
  BOOST_TEST(state.v.norm() > 0);
}

BOOST_AUTO_TEST_CASE(the_answer_is_one_call) {
  BesideMatrices here;
#include "examples/analysis/limits/structure_limits.h"
  // λ² - 3λ + 3/2 = 0
  BOOST_TEST(answer.k0().value == (3 + std::sqrt(3)) / 2, boost::test_tools::tolerance(1e-14));
  BOOST_TEST(here.said.str().find("\nsymplectic-euler: ") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(a_structure_has_three_sources) {
  Scene scene = small_scene();
#include "examples/analysis/limits/structure.h"
  BOOST_TEST(hanging.matrices.size() == 21);
  BOOST_TEST((from_files.damping.kind == DampingModel::Kind::general));
  BOOST_TEST(!designed.matrices.has_damping());
}

BOOST_AUTO_TEST_CASE(a_chooser_plans_a_run) {
  Model model(std::make_unique<Scene>(small_scene()));
  model.design_damping();
#include "examples/analysis/limits/step_policy.h"
  BOOST_TEST(plan.h > 0);
  BOOST_TEST(state.v.norm() > 0);
}

BOOST_AUTO_TEST_CASE(powers_grow_before_they_decay) {
  std::ostringstream said;
  std::streambuf* const before = std::cout.rdbuf(said.rdbuf());
#include "examples/analysis/limits/transient_growth.h"
  std::cout.rdbuf(before);
  BOOST_TEST(growth > 1);
}

BOOST_AUTO_TEST_CASE(a_region_is_asked) {
#include "examples/analysis/regions/stability_region.h"
  BOOST_TEST(reach == 2 * std::sqrt(2), boost::test_tools::tolerance(1e-12));
  BOOST_TEST(h > 0);
  BOOST_TEST(!arcs.empty());
}

BOOST_AUTO_TEST_CASE(k0_is_bounded) {
#include "examples/analysis/spectra/spectrum.h"
  BOOST_TEST(certified < limit);
}

BOOST_AUTO_TEST_CASE(a_linear_motion_is_known) {
  const State<Vector> start{Vector::Ones(2), Vector::Zero(2)};
#include "examples/analysis/errors/linear_motion.h"
  BOOST_TEST(moved > 0);
}

BOOST_AUTO_TEST_CASE(a_root_is_found) {
#include "examples/analysis/gsl/numerics.h"
  BOOST_TEST(half_pi == std::acos(0.0), boost::test_tools::tolerance(1e-14));
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace springstab::test
