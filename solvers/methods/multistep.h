// Linear multistep methods as data, coefficients from the oldest state to the new one, j = 0 ... k.
//     First-order form, u = (x, v):   Σ α_j u_j = h Σ β_j u'_j.
//     Second-order form:              Σ α_j x_j = h² Σ β_j a_j, and v is formed by
//                                     v_k = (1/h) Σ γ_j x_j + h Σ δ_j a_j.
#pragma once

#include <vector>

namespace springstab {

struct Multistep {
  std::vector<double> alpha, beta;                             // k + 1 each, α_k != 0
  bool second_order = false;                                   // form
  std::vector<double> velocity_of_x = {}, velocity_of_a = {};  // γ, δ of the second-order form

  std::size_t steps() const { return alpha.size() - 1; }  // k
};

/// Whether the new acceleration takes part.
bool is_implicit(const Multistep& formula);

/// Throws std::invalid_argument, with the sums, where ρ(1) = 0, ρ'(1) = σ(1) != 0 does not hold; for the
/// second-order form ρ(1) = ρ'(1) = 0, ρ''(1) = 2σ(1) != 0 and Σγ = 0, Σjγ = 1.
void check_consistent(const Multistep& formula);

/// The order of accuracy for x'' = a(x, v), 8 at most: that of the lower of x and v.
int order_of(const Multistep& formula);

}  // namespace springstab
