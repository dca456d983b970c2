#include "experiments/studies/complexity/drape.h"

namespace springstab {
namespace {

void multiply(ClothMaterial& material, double factor) {
  PerCondition& k = material.stiffness;
  for (double* stiffness : {&k.stretch_u, &k.stretch_v, &k.shear, &k.bending}) *stiffness *= factor;
}

void multiply(SolidMaterial& material, double factor) {
  material.stiffness.edge *= factor;
  material.stiffness.altitude *= factor;
}

void multiply(SpringMaterial& material, double factor) {
  PerKind& k = material.stiffness;
  for (double* stiffness : {&k.structural, &k.shear, &k.bending}) *stiffness *= factor;
}

}  // namespace

SceneDescription describe(const Drape& drape) {
  SceneDescription scene;
  scene.geometry = Grid{drape.side, drape.side};
  scene.material = drape.material;
  std::visit([&](auto& material) { multiply(material, drape.stiffness_factor); }, scene.material);
  scene.pins = drape.pins;
  scene.damping = drape.damping;
  return scene;
}

}  // namespace springstab
