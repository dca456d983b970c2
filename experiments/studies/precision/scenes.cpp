#include "experiments/studies/precision/scenes.h"

#include <cmath>
#include <numbers>

#include "experiments/inputs/subject.h"
#include "experiments/studies/complexity/drape.h"

namespace springstab {
namespace {

constexpr double particle_mass = 1.25e-4;  // [kg], as in the paper's drape

Problem chain(const std::string& title, double tenth_spring, const CommonOptions& common) {
  constexpr int n = 1000;
  std::vector<double> stiffness(n + 1, 1e6);
  for (int i = 0; i <= n; i += 10) stiffness[i] = tenth_spring;
  Vector x(n);
  for (int i = 0; i < n; ++i) {
    const double s = (i + 1.) / (n + 1.), away = (s - 0.3) / 0.05;
    x[i] = std::exp(-away * away);
  }
  return {title, Model(SpringChain(std::vector<double>(n, 1.), stiffness, {1, 1e-4}), x), 1, common};
}

SceneDescription net(int rows, int columns, const PerKind& stiffness, double factor) {
  SpringMaterial material;
  material.particle_mass = particle_mass;
  material.stiffness = {factor * stiffness.structural, factor * stiffness.shear, factor * stiffness.bending};
  SceneDescription scene;
  scene.geometry = Grid{rows, columns};
  scene.material = material;
  return scene;
}

Pins pins(Pins::Kind kind) { return {.kind = kind, .ranges = {}, .source = "scene"}; }

Pins rim(int side) {
  Pins pins{.kind = Pins::Kind::indices, .ranges = {}, .source = "scene"};
  for (int p = 0; p < side * side; ++p)
    if (p < side || p >= side * (side - 1) || p % side == 0 || p % side == side - 1)
      pins.ranges.push_back({p, p});
  return pins;
}

const char* how_stiff(double factor) { return factor > 1 ? ", stiff" : ", soft"; }

}  // namespace

Problem oscillator(const CommonOptions& common) {
  const double omega = 2 * std::numbers::pi;
  return {"Undamped oscillator", Model(SpringChain({1.}, {omega * omega, 0}, {0, 0}), Vector::Ones(1)), 1,
          common};
}

Problem uniform_chain(const CommonOptions& common) {
  return chain("Uniform chain of 1000 masses", 1e6, common);
}

Problem stiff_chain(const CommonOptions& common) {
  return chain("The same, every tenth spring 10⁴ times stiffer", 1e10, common);
}

Problem hanging_chain(double stiffness_factor, const CommonOptions& common) {
  SceneDescription scene = net(32, 1, {2, 0, 0}, stiffness_factor);
  scene.pins = pins(Pins::Kind::first_row);
  scene.gravity = {0, 0, 9.81};  // along the chain
  scene.damping = {.d0 = 1, .alpha = 0};
  scene.initial.velocity = {1, 0, 0};
  return {std::string("Hanging chain") + how_stiff(stiffness_factor), Subject(scene), 0.2, common};
}

Problem damped_net(double stiffness_factor, const CommonOptions& common) {
  SceneDescription scene = net(11, 11, {20, 10, 2}, stiffness_factor);
  const double damping = 0.005 * std::sqrt(stiffness_factor);
  std::get<SpringMaterial>(scene.material).damping = {damping, damping, damping};
  scene.pins = pins(Pins::Kind::corners);
  scene.initial.stretch = {1.1, 1, 1.1};
  return {std::string("Net with axial damping") + how_stiff(stiffness_factor), Subject(scene), 0.05, common};
}

Problem tense_cloth(double stiffness_factor, const CommonOptions& common) {
  SceneDescription scene =
      describe(Drape{.side = 12, .stiffness_factor = 0.03 * stiffness_factor, .pins = rim(12)});
  scene.damping = {.d0 = 1, .alpha = 1e-4 / std::sqrt(stiffness_factor)};
  scene.initial.stretch = {1.1, 1, 1.1};
  scene.initial.velocity = {0, 1, 0};
  return {std::string("Pinned cloth in tension") + how_stiff(stiffness_factor), Subject(scene), 0.05, common};
}

Problem spring_drape(const CommonOptions& common) {
  SceneDescription scene = net(24, 24, {200, 100, 20}, 1);
  scene.pins = pins(Pins::Kind::first_row);
  scene.damping = {.d0 = 1, .alpha = 1e-4};
  return {"Drape of springs, before it buckles", Subject(scene), 0.05, common};
}

Problem cloth_drape(const CommonOptions& common) {
  SceneDescription scene = describe(Drape{.side = 24});
  scene.damping.alpha = 1e-4;
  return {"The paper's drape", Subject(scene), 0.05, common};
}

Problem undamped_net(double duration, const CommonOptions& common) {
  SceneDescription scene = net(8, 8, {20, 10, 2}, 1);
  scene.pins = rim(8);
  scene.gravity = {0, 0, 0};
  scene.initial.stretch = {1.1, 1, 1.1};
  scene.initial.velocity = {0, 1, 0};
  return {"Undamped net in tension", Subject(scene), duration, common};
}

}  // namespace springstab
