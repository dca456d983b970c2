// What contact does to the limit, as two figures. (1) Linear chains, nets and cloths, held by one particle,
// between walls, by methods and rules for the impulses: which share of the runs diverges at which part of the
// limit without contact, by the watch of `simulate` (solvers/simulation.h). (2) One drape with contact by
// springs k_c, at steps up to the limit without contact: where it explodes, and the step that is proved for
// any contact (analysis/limits/penalty_contact.h).
#include <cmath>
#include <random>

#include "analysis/limits/penalty_contact.h"
#include "analysis/structure_limits.h"
#include "experiments/inputs/subject.h"
#include "experiments/studies/divergence/divergence.h"
#include "experiments/studies/gnuplot.h"
#include "experiments/studies/parallel.h"
#include "solvers/contact/contact_filter.h"

namespace springstab {
namespace {

constexpr const char* contact_methods[] = {"symplectic-euler", "implicit-damping-euler", "velocity-verlet",
                                           "rk4"};
constexpr const char* contact_structures[] = {"chain", "net", "cloth"};
constexpr double parts_of_limit[] = {0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99};

void write_whole(const std::string& path, const std::string& text) {
  OutputFile file(path);
  file.stream() << text;
  file.commit();
}

class ContactDice {
 public:
  explicit ContactDice(std::uint64_t seed) : engine_(seed) {}
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine_); }
  Eigen::Vector3d direction() {
    Eigen::Vector3d d(0, 0, 0);
    while (d.norm() < 0.1 || d.norm() > 1) d = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    return d.normalized();
  }

 private:
  std::mt19937_64 engine_;
};

// Random masses and springs, half of the structures under tension; their first particle is held.
SpringNet random_structure(const std::string& kind, ContactDice& dice) {
  const bool stretched = dice.uniform(0, 1) < 0.5, cloth = kind == "cloth", chain = kind == "chain";
  SpringNet net;
  if (cloth) net = make_net(Grid{4, 4, 0.5}, SpringMaterial{});
  const int n = cloth ? 16 : static_cast<int>(dice.uniform(3, 10));
  for (int i = 0; i < n && !cloth; ++i)
    net.rest.push_back(chain ? Eigen::Vector3d(i, 0, 0) : Eigen::Vector3d(dice.direction()));
  net.mass.clear();
  for (int i = 0; i < n; ++i) net.mass.push_back(std::pow(10, dice.uniform(-2, 1)));
  for (int j = 1; j < n && !cloth; ++j)
    for (int i = 0; i < j; ++i)
      if (i + 1 == j || (!chain && dice.uniform(0, 1) < 0.4)) net.springs.push_back({i, j, 0, 0, 0});
  for (Spring& spring : net.springs) {
    spring.stiffness = std::pow(10, dice.uniform(0, 4));
    spring.rest_length = (net.rest[spring.i] - net.rest[spring.j]).norm();
    if (stretched) spring.rest_length *= dice.uniform(0.5, 1);
  }
  return net;
}

// One to four walls in front of every particle's displacement, touching it or a little apart.
Contact random_walls(const ContactModel& model, ContactDice& dice) {
  Contact contact;
  const int count = static_cast<int>(dice.uniform(1, 5));
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d n = dice.direction();
    const double gap = dice.uniform(0, 1) < 0.5 ? 0 : std::pow(10, dice.uniform(-3, 0));
    contact.obstacles.push_back({Plane{-gap * n, n}});
  }
  contact.model = model;
  return contact;
}

/// A rule for impulses, and a part of the limit.
struct ContactCase {
  const char* model;
  double part;
};

std::vector<ContactCase> contact_cases() {
  std::vector<ContactCase> cases;
  for (const char* model : {"inelastic", "impulses"})
    for (const double part : parts_of_limit) cases.push_back({model, part});
  return cases;
}

bool contact_run_diverges(Scene& scene, const Method& method, double h, long steps, const ContactCase& c,
                          std::uint64_t seed) {
  ContactDice dice(seed);
  const ContactModel model = c.model == std::string("impulses") ? ContactModel(LandingImpulses())
                                                                : ContactModel(InelasticImpulses());
  BlockLinearSystem linear = *scene.linearization(scene.rest_state());
  const auto filter = make_contact_filter(random_walls(model, dice), scene.free_masses());
  State<Vector> state{Vector::Zero(linear.size()), Vector(linear.size())};
  for (double& v : state.v) v = dice.uniform(-1, 1);
  const State<Vector> before = state;
  filter->apply(0, h, before, state);  // the first step, too, enters nothing
  const EnergyWatch watch{.initial_energy = linear.kinetic_energy(before.v)};
  return simulate(linear, *method.stepper(), {h, steps}, watch, state, {}, {}, filter.get()).status !=
         StepStatus::done;
}

// One random structure under one method, in all cases.
std::vector<bool> diverged_of(const std::string& kind, const Method& method, long steps, std::uint64_t seed) {
  ContactDice dice(seed);
  Model held(std::make_unique<Scene>(random_structure(kind, dice), std::vector<int>{0},
                                     Eigen::Vector3d::Zero(), RayleighDamping{}));
  Scene& scene = *held.scene();
  const double limit =
      StructureLimits(held.structure(scene.rest_state()), {.seed = seed}).limits(method).h_max.value();
  std::vector<bool> diverged;
  for (const ContactCase& c : contact_cases())
    diverged.push_back(contact_run_diverges(scene, method, c.part * limit, steps, c, seed + 1));
  return diverged;
}

Json draw_contact(const FigureFiles& files, const CommonOptions& common, const FiguresOptions& options) {
  const int runs = options.quick ? 4 : 96;
  const long steps = options.quick ? 300 : 3000;
  const std::vector<ContactCase> cases = contact_cases();
  constexpr long method_count = std::size(contact_methods), kinds = std::size(contact_structures);
  std::vector<std::vector<bool>> diverged(kinds * method_count * runs);
  parallel_ranges(static_cast<long>(diverged.size()), 1, common.threads, [&](long first, long last) {
    for (long i = first; i < last; ++i)
      diverged[i] = diverged_of(contact_structures[i / runs / method_count],
                                Method(contact_methods[i / runs % method_count]), steps,
                                common.seed + 1000 * static_cast<std::uint64_t>(i % runs));
  });
  std::string csv = "structure,method,model,ratio,runs,diverged\n";
  long inelastic = 0, impulses = 0;
  bool holds = true;
  for (long group = 0; group < kinds * method_count; ++group)
    for (std::size_t k = 0; k < cases.size(); ++k) {
      long count = 0;
      for (int run = 0; run < runs; ++run) count += diverged[group * runs + run][k];
      const std::string method = contact_methods[group % method_count], model = cases[k].model;
      csv += text("%s,%s,%s,%.2f,%d,%ld\n", contact_structures[group / method_count], method.c_str(),
                  model.c_str(), cases[k].part, runs, count);
      (model == "inelastic" ? inelastic : impulses) += count;
      const bool proved = model == "impulses" && method == "symplectic-euler";
      holds = holds && !(proved && count > 0);
    }
  const std::string file = files.data + ".csv";
  write_whole(file, csv);
  std::vector<std::string> written{file};
  const std::vector<std::string> drawn =
      draw(options.plots + "/divergence_contact.gp",
           "data=" + gnuplot_literal(file) + text("; runs=%d; steps=%ld; ", runs, steps), files.picture);
  written.insert(written.end(), drawn.begin(), drawn.end());
  return {{"files", written},
          {"holds", holds},
          {"summary", text("%zu runs in contact: %ld runs diverge with inelastic impulses, %ld with "
                           "those that land",
                           diverged.size() * cases.size(), inelastic, impulses)}};
}

// A small drape onto a ball; k_c <= 0 leaves out contact.
Subject springy_drape(double stiffness) {
  std::string scene = R"({"geometry": {"grid": [16, 16], "spacing": 0.03},
    "material": {"area_density": 0.2, "structural": 200, "shear": 100, "bending": 2},
    "damping": {"d0": 1.5, "alpha": 0})";
  if (stiffness > 0)
    scene += text(R"(, "contact": {"obstacles": [{"sphere": {"center": [0.22, -0.16, 0.23], "radius": 0.15}}],
      "thickness": 0.004, "model": {"penalty": {"stiffness": %.17g}}})",
                  stiffness);
  return Subject(parse_scene("drape.json", scene + "}"));
}

double limit_of(Structure structure, const std::string& method, std::uint64_t seed) {
  return StructureLimits(std::move(structure), {.seed = seed}).limits(method).h_max.value();
}

bool drape_explodes(Subject& subject, const std::string& method, double h, double duration) {
  State<Vector> state = subject.initial_state();
  const EnergyWatch watch = subject.energy_watch(state);
  const StepPlan plan{h, std::max(1L, std::lround(duration / h))};
  return simulate(subject.system(), *Method(method).stepper(), plan, watch, state).status != StepStatus::done;
}

Json draw_penalty(const FigureFiles& files, const CommonOptions& common, const FiguresOptions& options) {
  const std::string method = "symplectic-euler";
  const double duration = 0.5, step_ratio = std::pow(10, options.quick ? -0.5 : -0.125);
  Subject without = springy_drape(0);
  const double free_limit = limit_of(without.structure(without.initial_state()), method, common.seed);
  std::string csv = "k_c,h,ratio,diverged\n", bounds = "k_c,h_proved,ratio\n";
  long exploded = 0, against_proof = 0;
  for (double k = 1e2; k < 1.1e7; k *= options.quick ? 10 : std::sqrt(10.)) {
    Subject subject = springy_drape(k);
    Structure any = in_any_contact(subject.structure(subject.initial_state()), *subject.contact_bound());
    const double proved = limit_of(std::move(any), method, common.seed);
    bounds += text("%.6g,%.6g,%.6g\n", k, proved, proved / free_limit);
    for (double part = 0.95; part > 0.3 * proved / free_limit; part *= step_ratio) {
      const bool explodes = drape_explodes(subject, method, part * free_limit, duration);
      csv += text("%.6g,%.6g,%.6g,%d\n", k, part * free_limit, part, explodes);
      exploded += explodes;
      against_proof += explodes && part * free_limit < proved;
    }
  }
  std::vector<std::string> written{files.data + ".csv", files.data + "_proved.csv"};
  write_whole(written[0], csv);
  write_whole(written[1], bounds);
  const std::vector<std::string> drawn = draw(
      options.plots + "/penalty_contact.gp",
      "data=" + gnuplot_literal(files.data) + text("; free_limit=%.6g; duration=%g; ", free_limit, duration),
      files.picture);
  written.insert(written.end(), drawn.begin(), drawn.end());
  return {{"files", written},
          {"holds", exploded > 0 && against_proof == 0},
          {"summary", text("%ld drapes on springs explode, %ld of them at a step that is proved", exploded,
                           against_proof)}};
}

}  // namespace

std::vector<Figure> contact_figures() {
  return {{.file = "divergence_contact", .name = "divergence-contact", .draw = draw_contact},
          {.file = "penalty_contact", .name = "penalty-contact", .draw = draw_penalty}};
}

}  // namespace springstab
