// The library's one call, against the command and against what its parts say.
#include <boost/test/unit_test.hpp>
#include <fstream>
#include <map>

#include "analysis/limits/step_policy.h"
#include "analysis/limits/transient_growth.h"
#include "analysis/method.h"
#include "analysis/structure_limits.h"
#include "experiments/command/output.h"
#include "solvers/linear/matrix_system.h"
#include "solvers/scene/every_pose.h"
#include "solvers/scene/spring_cloth.h"
#include "solvers/scene/tet_solid.h"
#include "solvers/scene/triangle_cloth.h"
#include "solvers/spring_chain.h"
#include "tests/command.h"

BOOST_AUTO_TEST_SUITE(structure_limits)

using namespace springstab;
using springstab::test::Command;

namespace {

SparseMatrix sparse(const Eigen::MatrixXd& a) { return a.sparseView(0.0, 0.0); }

std::string matrix_market(const SparseMatrix& a) {
  std::string file = "%%MatrixMarket matrix coordinate real general\n" + std::to_string(a.rows()) + ' ' +
                     std::to_string(a.cols()) + ' ' + std::to_string(a.nonZeros()) + '\n';
  for (Eigen::Index j = 0; j < a.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(a, j); it; ++it)
      file += text("%ld %ld %.17g\n", static_cast<long>(it.row() + 1), static_cast<long>(it.col() + 1),
                   it.value());
  return file;
}

/// K, M and D of three masses with a damper at one of them: D' and K' do not commute.
StructuralMatrices uneven_matrices() {
  const Eigen::MatrixXd k{{30, -10, 0}, {-10, 35, -25}, {0, -25, 27}};
  const Eigen::MatrixXd m{{1, 0, 0}, {0, 2.5, 0}, {0, 0, 0.7}}, d{{0.3, 0, 0}, {0, 0, 0}, {0, 0, 0.02}};
  return prepare(sparse(k), sparse(m), sparse(d));
}

const std::vector<int> pinned{0, 3};
constexpr const char* scene_end =
    R"("pins": [0, 3], "gravity": [0, -9.81, 0], "damping": {"d0": 0.5, "alpha": 0.001}})";

/// What the command printed of every number of the answer, to the last bit.
void expect_same(StructureLimits& answer, const Json& report) {
  const auto expect = [](const std::optional<double>& ours, const Json& theirs) {
    BOOST_TEST(number(ours).dump() == theirs.dump());
  };
  expect(answer.k0().value, report["k0"]["value"]);
  expect(answer.k0().upper_bound, report["k0"]["upper_bound"]);
  expect(answer.growth(), report["growth_rate"]);
  BOOST_TEST(report["methods"].size() == all_methods().size());
  for (const Json& theirs : report["methods"]) {
    const MethodLimits& ours = answer.limits(theirs["name"].get<std::string>());
    BOOST_TEST_CONTEXT(theirs["name"]) {
      expect(ours.h_max, theirs["h_max"]);
      expect(ours.h_certified, theirs["h_certified"]);
      expect(ours.recommended, theirs["recommended_step"]);
      expect(ours.every_pose, theirs["h_every_pose"]);
      expect(ours.transient_growth, theirs["transient_growth"]);
      BOOST_TEST(ours.designed.has_value() == !theirs["designed"].is_null());
      if (ours.designed) expect(ours.designed->alpha, theirs["designed"]["alpha"]);
      if (!ours.h_certified) BOOST_TEST(ours.unproved == theirs["reason"].get<std::string>());
    }
  }
}

const StructureLimitsOptions as_the_command{.max_step = 0.01};

template <class Cloth>
Structure structure_of_scene(const Cloth& cloth) {
  Scene scene(cloth, pinned, {0, -9.81, 0}, {0.5, 0.001});
  return structure_of(scene, scene.rest_state());
}

}  // namespace

BOOST_AUTO_TEST_CASE(numbers_equal_those_of_the_command, *boost::unit_test::label("slow")) {
  const Command command;
  const auto report = [&](const std::string& scene) {
    command.file("scene.json", scene);
    return Json::parse(command("limits scene.json --json").out);
  };
  const std::string grid = R"({"geometry": {"grid": [5, 4], "spacing": 0.2}, )";
  const Grid size{5, 4, 0.2};
  BOOST_TEST_CONTEXT("net") {
    SpringMaterial material;
    material.stiffness = {20, 10, 2};
    const SpringNet net = make_net(size, material);
    Structure structure = structure_of_scene(net);
    structure.every_pose = [&] { return every_pose(net, pinned, {0.5, 0.001}); };
    StructureLimits answer(std::move(structure), as_the_command);
    const Json theirs =
        report(grid + R"("material": {"structural": 20, "shear": 10, "bending": 2}, )" + scene_end);
    expect_same(answer, theirs);
    BOOST_TEST(answer.limits("symplectic-euler").every_pose.has_value());
  }
  BOOST_TEST_CONTEXT("damped net") {
    SpringMaterial material;
    material.stiffness = {20, 10, 2};
    material.damping = {0.01, 0.02, 0.03};
    StructureLimits answer(structure_of_scene(make_net(size, material)), as_the_command);
    BOOST_TEST((answer.structure().damping.kind == DampingModel::Kind::general));
    const std::string springs = R"("material": {"structural": 20, "shear": 10, "bending": 2, )"
                                R"("damping": {"structural": 0.01, "shear": 0.02, "bending": 0.03}}, )";
    Json theirs = report(grid + springs + scene_end);
    for (Json& method : theirs["methods"]) method["h_every_pose"] = nullptr;  // for which ours was not asked
    expect_same(answer, theirs);
  }
  BOOST_TEST_CONTEXT("cloth") {
    StructureLimits answer(structure_of_scene(make_cloth(size, ClothMaterial{})), as_the_command);
    expect_same(answer, report(grid + R"("material": {"model": "baraff-witkin"}, )" + scene_end));
  }
  BOOST_TEST_CONTEXT("matrices") {
    const StructuralMatrices s = uneven_matrices();
    command.file("K.mtx", matrix_market(s.stiffness));
    command.file("M.mtx", matrix_market(s.mass));
    command.file("D.mtx", matrix_market(s.damping));
    StructureLimits answer(structure_of(s), as_the_command);
    const std::string files = "--stiffness K.mtx --mass M.mtx --damping-matrix D.mtx";
    expect_same(answer, Json::parse(command("limits " + files + " --json").out));
    BOOST_TEST(answer.growth().value() == 0);
  }
  BOOST_TEST_CONTEXT("chain") {
    const SpringChain chain({1, 2, 0.5}, {100, 30, 70, 20}, {0.4, 0.002});
    const StructuralMatrices s = chain.matrices();
    command.file("K.mtx", matrix_market(s.stiffness));
    command.file("M.mtx", matrix_market(s.mass));
    StructureLimits undamped(structure_of(SpringChain({1, 2, 0.5}, {100, 30, 70, 20}, {})), as_the_command);
    expect_same(undamped, Json::parse(command("limits --stiffness K.mtx --mass M.mtx --json").out));
    StructureLimits answer(structure_of(chain), as_the_command);
    for (const Method& method : all_methods()) {  // D as a matrix is found to be Rayleigh's, to 1e-12
      StructuralMatrices damped = s;
      damped.damping = 0.4 * s.mass + 0.002 * s.stiffness;
      StructureLimits other(structure_of(damped), as_the_command);
      const MethodLimits &one = answer.limits(method), &two = other.limits(method);
      BOOST_TEST((one.status == two.status));
      if (one.h_max) BOOST_TEST(*one.h_max == two.h_max.value(), boost::test_tools::tolerance(1e-10));
    }
  }
}

BOOST_AUTO_TEST_CASE(numbers_of_tetrahedra_equal_those_of_the_command) {
  const Command command;
  command.file("solid.vtk",
               "# vtk DataFile Version 2.0\nsolid\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
               "0 0 0\n1.1 0 0.1\n0 0.9 0\n0.2 0.1 1.3\n1 1 1\n"
               "CELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\n");
  command.file("scene.json",
               std::string(R"({"geometry": {"mesh": "solid.vtk"}, "material": {"model": "tetrahedra"}, )") +
                   scene_end);
  TetMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1.1, 0, 0.1}, {0, 0.9, 0}, {0.2, 0.1, 1.3}, {1, 1, 1}};
  mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  StructureLimits answer(structure_of_scene(make_solid(mesh, SolidMaterial{})), as_the_command);
  expect_same(answer, Json::parse(command("limits scene.json --json").out));
}

// The sanitizers see what would be read after its end.
BOOST_AUTO_TEST_CASE(the_answer_owns_what_it_was_asked_of) {
  const auto answer_of = [] {
    StructuralMatrices matrices = uneven_matrices();
    Structure structure = structure_of(matrices);
    structure.every_pose = [=] { return matrices; };
    StructureLimits answer(std::move(structure));
    answer.limits("rk4");  // so that all of it is built, and then moved
    return std::make_unique<StructureLimits>(std::move(answer));
  };
  const std::unique_ptr<StructureLimits> answer = answer_of();
  const StructuralMatrices kept = uneven_matrices();
  StructureLimits other(structure_of(kept));
  for (const Method& method : all_methods()) {
    BOOST_TEST((answer->limits(method).status == other.limits(method).status));
  }
  BOOST_TEST(answer->limits("rk4").h_max.value() ==
             StructureLimits(structure_of(kept)).limits("rk4").h_max.value());
  BOOST_TEST(answer->growth().value() == other.growth().value());
  BOOST_TEST(answer->limits("symplectic-euler").every_pose.value() > 0);

  const auto scene_limits = [] {
    Scene scene(make_net(Grid{4, 4}, SpringMaterial{}), pinned, {0, 0, 0}, {});
    return StructureLimits(structure_of(scene, scene.rest_state()));
  };
  StructureLimits net = scene_limits();
  BOOST_TEST(net.limits("rk4").recommended.value() < net.limits("rk4").h_max.value());
  static_assert(!std::is_constructible_v<NumericalRange, StructuralMatrices>);
  static_assert(!std::is_constructible_v<CertifiedSteps, StructuralMatrices>);
}

// What is asked for twice is the same object, and k0 that is known is not computed again.
BOOST_AUTO_TEST_CASE(each_answer_is_computed_once_and_on_demand) {
  StructureLimits answer(structure_of(uneven_matrices()));
  const StiffestMode* const k0 = &answer.k0();
  const MethodLimits* const limits = &answer.limits("rk4");
  for (const Method& method : all_methods()) answer.limits(method);
  BOOST_TEST(&answer.k0() == k0);
  BOOST_TEST(&answer.limits("rk4") == limits);

  StiffestMode known;  // of no matrix at all
  known.converged = true;
  known.value = 16;
  StructureLimits without_matrices(Structure{}, {.certify = false}, known);
  BOOST_TEST(without_matrices.limits("symplectic-euler").h_max.value() == 0.5,
             boost::test_tools::tolerance(1e-12));

  StructureLimits quick(structure_of(uneven_matrices()), {.certify = false});
  BOOST_TEST(std::isinf(quick.k0().upper_bound));
  BOOST_TEST(!quick.limits("symplectic-euler").h_certified);
}

BOOST_AUTO_TEST_CASE(damping_is_all_of_it_or_none) {
  Scene rayleigh(make_net(Grid{4, 3}, SpringMaterial{}), pinned, {0, 0, 0}, {0.7, 0.003});
  const Structure left_out = structure_of(rayleigh, rayleigh.rest_state());
  BOOST_TEST(!left_out.matrices.has_damping());
  BOOST_TEST((left_out.damping.kind == DampingModel::Kind::rayleigh));
  BOOST_TEST(left_out.damping.d0 == 0.7);

  SpringMaterial damped;
  damped.damping = {0.1, 0.2, 0.3};
  Scene own(make_net(Grid{4, 3}, damped), pinned, {0, 0, 0}, {0.7, 0.003});
  State<Vector> state = own.rest_state();
  const Structure whole = structure_of(own, state);
  BOOST_TEST((whole.damping.kind == DampingModel::Kind::general));
  for (Eigen::Index i = 0; i < state.v.size(); ++i) state.v[i] = std::sin(static_cast<double>(3 * i + 1));
  Vector expected;
  own.linearization(state)->damping_times(state.v, expected);
  const Vector ours = (whole.matrices.damping * state.v).cwiseQuotient(whole.matrices.mass.diagonal());
  BOOST_TEST((ours - expected).norm() <= 1e-13 * expected.norm());
}

// Every reason has its case, and a plan ends where the run does.
BOOST_AUTO_TEST_CASE(a_choice_is_the_limit_or_a_reason) {
  StiffestMode k0;
  k0.converged = true;
  const StepOptions options{.method = "rk4", .duration = 1};
  MethodLimits limits;
  BOOST_TEST((choose_step(StiffestMode{}, limits, options).reason == NoStep::k0_not_converged));
  BOOST_TEST((choose_step(k0, limits, options).reason == NoStep::not_known));
  limits.status = LimitStatus::none;
  BOOST_TEST((choose_step(k0, limits, options).reason == NoStep::none_stable));
  BOOST_TEST(!choose_step(k0, limits, options).step);
  limits.status = LimitStatus::limited;
  limits.recommended = 0.03;
  BOOST_TEST(choose_step(k0, limits, options).step.value() == 0.03);
  BOOST_TEST(choose_step(k0, limits, {.method = "rk4", .duration = 1, .max_step = 0.02}).step.value() ==
             0.02);
  BOOST_TEST(choose_step(k0, limits, {.method = "rk4", .duration = 1, .step = 7}).step.value() == 7);

  for (const Method& method : all_methods())
    for (const double largest : {0.03, 0.0123}) {
      const StepPlan plan = plan_steps(method.info(), largest, 1, 0.07);
      BOOST_TEST(plan.h <= largest * (1 + 1e-12));
      BOOST_TEST(plan.h * static_cast<double>(plan.steps) == 1, boost::test_tools::tolerance(1e-12));
      BOOST_TEST(plan.steps % plan.steps_per_linearization == 0);
      if (method.info().linearized)
        BOOST_TEST(plan.h * static_cast<double>(plan.steps_per_linearization) <= 0.07 * (1 + 1e-12));
    }
  BOOST_CHECK_THROW(plan_steps(Method("rk4").info(), 1e-16, 1, 1), TooManySteps);
}

BOOST_AUTO_TEST_CASE(scenes_matrices_and_chains_are_models_alike) {
  const std::vector<double> mass{1, 2, 0.5}, stiffness{100, 30, 70, 20};
  const Vector x{{0.3, -0.2, 0.1}};
  Model chain(SpringChain(mass, stiffness, {0.4, 0}), x);
  StructuralMatrices s = chain.structure(chain.initial_state()).matrices;
  s.damping = 0.4 * s.mass;
  Model matrices(std::make_unique<MatrixSystem>(s));
  const State<Vector> start = chain.initial_state();
  BOOST_TEST(start.x == x);
  BOOST_TEST(chain.energy_watch(start).initial_energy == matrices.energy_watch(start).initial_energy,
             boost::test_tools::tolerance(1e-14));
  for (Model* model : {&chain, &matrices}) {
    BOOST_TEST(StructureLimits(model->structure(start)).limits("rk4").h_max.value() ==
                   StructureLimits(structure_of(s)).limits("rk4").h_max.value(),
               boost::test_tools::tolerance(1e-9));
  }
  BOOST_CHECK_THROW(matrices.design_damping(), std::invalid_argument);
  BOOST_CHECK_THROW(matrices.set_alpha(1), std::invalid_argument);
  chain.design_damping();
  BOOST_TEST((chain.structure(start).damping.kind == DampingModel::Kind::designed));
  chain.set_alpha(0.01);
  BOOST_TEST((chain.structure(start).damping.kind == DampingModel::Kind::rayleigh));
  BOOST_TEST(chain.damping().d0 == 0.4);
}

BOOST_AUTO_TEST_SUITE_END()
