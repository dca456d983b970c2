// Compiled instead of box_pairs_embree.cpp where there is no Embree.
#include <stdexcept>

#include "solvers/contact/box_pairs.h"

namespace springstab {

struct BoxPairs::Trees {};

bool has_embree() { return false; }

BoxPairs::BoxPairs(int, int) { throw std::runtime_error(embree_is_missing); }
BoxPairs::~BoxPairs() = default;
const std::vector<std::array<int, 2>>& BoxPairs::find(std::span<const Box>) {
  throw std::runtime_error(embree_is_missing);
}

}  // namespace springstab
