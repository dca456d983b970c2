// Four numbers in one register: a row of a 3x3 block with what follows it, or a vector of three padded.
#pragma once

#include <Eigen/Core>
#include <cstring>

namespace springstab {

using Four = Eigen::Array4d;
using FourAt = Eigen::Map<Four>;
using ConstFourAt = Eigen::Map<const Four>;

/// (Σ a, Σ b, Σ c, 0) over the first three of each, without leaving the vector registers: the next row waits
/// for it.
inline Four sums_of_three(const Four& a, const Four& b, const Four& c) {
  using Register [[gnu::vector_size(32)]] = double;
  const auto load = [](Register& to, const Four& from) { std::memcpy(&to, from.data(), sizeof to); };
  Register ra, rb, rc, zero{};
  load(ra, a);
  load(rb, b);
  load(rc, c);
  const Register ab_even = __builtin_shufflevector(ra, rb, 0, 4, 2, 6);  // a0 b0 a2 b2
  const Register ab_odd = __builtin_shufflevector(ra, rb, 1, 5, 3, 7);   // a1 b1 a3 b3
  const Register c_even = __builtin_shufflevector(rc, zero, 0, 4, 2, 6);
  const Register c_odd = __builtin_shufflevector(rc, zero, 1, 5, 3, 7);
  const Register sum = __builtin_shufflevector(ab_even, c_even, 0, 1, 4, 5) +
                       __builtin_shufflevector(ab_odd, c_odd, 0, 1, 4, 5) +
                       __builtin_shufflevector(ab_even, c_even, 2, 3, 6, 7);
  Four out;
  std::memcpy(out.data(), &sum, sizeof sum);
  return out;
}

}  // namespace springstab
