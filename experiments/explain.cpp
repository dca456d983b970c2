#include "experiments/explain.h"

#include <algorithm>

#include "analysis/method.h"
#include "experiments/command/optional_parts.h"
#include "experiments/runs/measured_run.h"

namespace springstab {
namespace {

constexpr long steps_to_try = 10;

// CPU time of the fastest of several calls [s].
template <class Work>
double seconds_each(const Work& work) {
  double fastest = std::numeric_limits<double>::infinity();
  const double begin = cpu_seconds();
  for (int calls = 0; calls < 3 || (calls < 100 && cpu_seconds() - begin < 0.02); ++calls) {
    const double before = cpu_seconds();
    work();
    fastest = std::min(fastest, cpu_seconds() - before);
  }
  return fastest;
}

Json part(std::string_view name, long elements, const char* work, double seconds, double times) {
  return {{"name", name},       {"elements", elements},    {"work", work},
          {"seconds", seconds}, {"times_per_step", times}, {"bytes", nullptr}};
}

// Forces, for methods that evaluate any.
void add_forces(Json& parts, Scene& scene, const State<Vector>& at, double times) {
  const ParticleField x = scene.position_field(at.x);
  const std::vector<double> resting(3 * static_cast<std::size_t>(scene.particles()));
  const ParticleField v{at.v.data(), resting.data(), scene.free_particles()};
  Vector force = Vector::Zero(scene.size());
  const double alpha = scene.damping().alpha;
  for (const auto& term : scene.terms().elastic)
    parts.push_back(part(term->name(), term->size(), "force", seconds_each([&] {
                           if (alpha == 0) {
                             term->add_force(x, force.data());
                           } else {
                             term->add_damped_force(x, at.v.data(), alpha, force.data());
                           }
                         }),
                         times));
  for (const auto& term : scene.terms().damping)
    parts.push_back(part(term->name(), term->size(), "force",
                         seconds_each([&] { term->add_force(x, v, force.data()); }), times));
}

// Assembly, term by term.
void add_assembly(Json& parts, Scene& scene, const State<Vector>& at, double times) {
  const ParticleField x = scene.position_field(at.x);
  const auto linear = scene.linearization(at);
  for (const auto& term : scene.terms().elastic)
    parts.push_back(part(term->name(), term->size(), "Hessian", seconds_each([&] {
                           if (scene.hessian() == Hessian::exact) {
                             term->add_stiffness(x, linear->stiffness());
                           } else {
                             term->add_projected_stiffness(x, linear->stiffness());
                           }
                         }),
                         times));
  for (const auto& term : scene.terms().damping)
    parts.push_back(part(term->name(), term->size(), "damping matrix",
                         seconds_each([&] { term->add_damping(x, *linear->own_damping()); }), times));
}

// Products with K and D, and solving: a factorization, or the iterations of conjugate gradients.
void add_algebra(Json& parts, Scene& scene, const State<Vector>& at, double h, double products, bool solves,
                 double iterations) {
  const auto linear = scene.linearization(at);
  Vector out(scene.size());
  const auto stored = [](Json row, const BlockSparseMatrix& matrix) {
    row["bytes"] = matrix.bytes();
    return row;
  };
  const auto add_product = [&](const char* name, const BlockSparseMatrix& matrix) {
    const double seconds = seconds_each([&] { matrix.multiply(at.x.data(), out.data()); });
    parts.push_back(stored(part(name, matrix.blocks(), "product", seconds, products), matrix));
  };
  add_product("blocks of K", linear->stiffness());
  if (linear->own_damping()) add_product("blocks of D", *linear->own_damping());
  if (!solves) return;
  SolveReport report;
  const double seconds = seconds_each([&] { report = linear->solve_shifted({1, h, h * h}, at.x, out); });
  if (scene.solver().kind == SolverKind::cholesky) {
    parts.push_back(part("Cholesky factorization", scene.size(), "solve", seconds, 1));
  } else {
    parts.push_back(part("conjugate gradients", scene.size(), "iteration",
                         seconds / static_cast<double>(std::max(1L, report.iterations)), iterations));
  }
}

// What acts between steps.
void add_contact_part(Json& parts, const Subject& subject, const State<Vector>& at, double h) {
  const auto filter = subject.contact_filter();
  if (!filter) return;
  State<Vector> after = at;
  const Contact& contact = *subject.contact();
  const bool has_surfaces = contact.has_surfaces();
  long elements = has_surfaces ? std::ssize(subject.contact_surface().first.triangles)
                               : subject.scene()->free_particles() * std::ssize(contact.obstacles);
  for (const MeshObstacle& mesh : contact.meshes) elements += std::ssize(mesh.triangles);
  parts.push_back(
      part(has_surfaces ? "contact of surfaces, triangles" : "contact, pairs of particle and obstacle",
           elements, subject.counts_contacts() ? "count" : "impulses", seconds_each([&] {
             after = at;
             filter->apply(h, h, at, after);
           }),
           1));
}

std::vector<std::string> absent_parts(const SpringMaterial& material) {
  std::vector<std::string> absent;
  const auto need = [&](double stiffness, const char* kind) {
    if (stiffness == 0) absent.push_back(text("%s springs, and what they alone couple in K", kind));
  };
  need(material.stiffness.structural, "structural");
  need(material.stiffness.shear, "shear");
  need(material.stiffness.bending, "bending");
  return absent;
}

std::vector<std::string> absent_parts(const ClothMaterial& material) {
  std::vector<std::string> absent;
  if (!material.stiffness.any_in_plane()) absent.push_back("triangles that resist stretch and shear");
  if (material.stiffness.bending == 0)
    absent.push_back("hinges that resist bending, and what they alone couple in K");
  return absent;
}

std::vector<std::string> absent_parts(const SolidMaterial& material) {
  std::vector<std::string> absent;
  if (material.stiffness.edge == 0) absent.push_back("springs along edges");
  if (material.stiffness.altitude == 0) absent.push_back("altitude springs");
  return absent;
}

std::vector<std::string> left_out(const Subject& subject, Scene& scene, bool assembles) {
  std::vector<std::string> absent =
      std::visit([](const auto& material) { return absent_parts(material); }, *subject.material());
  if (!scene.has_own_damping()) absent.push_back("damping of the material's own: no force, and no matrix D");
  if (scene.damping().alpha == 0) absent.push_back("damping αK: no product K v in a force");
  if (!assembles)
    absent.push_back(scene.has_matrices() ? "K in a step: it was assembled for the choice of the step alone"
                                          : "K: neither assembled nor stored");
  return absent;
}

}  // namespace

Json explain(Subject& subject, std::string_view method, const StepPlan& plan, const State<Vector>& start) {
  Scene& scene = *subject.scene();
  const long each = plan.steps_per_linearization;
  const long steps = std::min(plan.steps, (steps_to_try + each - 1) / each * each);
  const auto filter = subject.contact_filter();
  const Counts counts = measured_run(scene, method, {plan.h, steps, each}, subject.energy_watch(start), start,
                                     {}, {}, filter.get())
                            .counts;
  const auto a_step = [&](long count) { return static_cast<double>(count) / static_cast<double>(steps); };

  Json parts = Json::array();
  add_forces(parts, scene, start, a_step(counts.force_evaluations));
  if (counts.hessian_assemblies > 0) {
    add_assembly(parts, scene, start, a_step(counts.hessian_assemblies));
    add_algebra(parts, scene, start, plan.h, a_step(counts.block_products - counts.cg_iterations),
                Method(method).info().implicit, a_step(counts.cg_iterations));
  }
  add_contact_part(parts, subject, start, plan.h);
  return {{"particles", scene.particles()},
          {"pinned", scene.particles() - scene.free_particles()},
          {"steps_tried", steps},
          {"parts", parts},
          {"left_out", left_out(subject, scene, counts.hessian_assemblies > 0)},
          {"built", optional_parts_text()}};
}

std::string explanation_table(const Json& e) {
  std::string out = text("%d particles, %d of them pinned; times a step on average of the first %ld\n",
                         e["particles"].get<int>(), e["pinned"].get<int>(), e["steps_tried"].get<long>());
  out += text("%-38s %9s %9s  %-14s %10s %9s %11s\n", "has", "number", "MB", "work", "each [ms]", "a step",
              "a step [ms]");
  for (const Json& p : e["parts"]) {
    const double milliseconds = 1e3 * p["seconds"].get<double>(), times = p["times_per_step"].get<double>();
    out += text("%-38s %9ld %9s  %-14s %10.4g %9.4g %11.4g\n", p["name"].get<std::string>().c_str(),
                p["elements"].get<long>(),
                p["bytes"].is_null() ? "-" : text("%.3g", 1e-6 * p["bytes"].get<double>()).c_str(),
                p["work"].get<std::string>().c_str(), milliseconds, times, milliseconds * times);
  }
  for (const Json& absent : e["left_out"]) out += "left out: " + absent.get<std::string>() + '\n';
  return out;
}

}  // namespace springstab
