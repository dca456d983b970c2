#include "solvers/scene/hinge_angles.h"

namespace springstab {
HingeAngles::HingeAngles(const std::vector<Hinge>& hinges, int free_count)
    : elements_(hinges, free_count), rest_angles_(elements_.batches()) {
  for (int slot = 0; slot < batch_size * elements_.batches(); ++slot) {
    const double angle = hinges[std::min(slot, elements_.size() - 1)].rest_angle;
    rest_angles_[slot / batch_size].cos[slot % batch_size] = std::cos(angle);
    rest_angles_[slot / batch_size].sin[slot % batch_size] = std::sin(angle);
  }
}

void HingeAngles::add_gradient_products(const ParticleField& x, double factor, const BlockPlaces<4>& places,
                                        BlockSparseMatrix& matrix) const {
  elements_.add_blocks(x, places, matrix, [&](int) {
    return [factor](const CornerVectors<4>& at, int i, CornerBlocks<4>& blocks) SPRINGSTAB_LANE {
      const HingeGradient g = gradient(hinge_shape(at, i));
      const Vec3 k0 = factor * g.x0, k1 = factor * g.x1;
      blocks.set(0, 0, i, outer(k0, g.x0));
      blocks.set(0, 1, i, outer(k0, g.x1));
      blocks.set(0, 2, i, outer(k0, g.x2));
      blocks.set(0, 3, i, outer(k0, g.x3));
      blocks.set(1, 1, i, outer(k1, g.x1));
      blocks.set(1, 2, i, outer(k1, g.x2));
      blocks.set(1, 3, i, outer(k1, g.x3));
      blocks.set(2, 2, i, outer(factor * g.x2, g.x2));
      blocks.set(2, 3, i, outer(factor * g.x2, g.x3));
      blocks.set(3, 3, i, outer(factor * g.x3, g.x3));
    };
  });
}

}  // namespace springstab
