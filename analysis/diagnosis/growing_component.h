// What grows in a few frames of any run. Near a blow-up x_n = trend + Re(c λⁿ φ); the differences Δᵖx_n,
// which free fall leaves at a constant or nothing, are then carried on by one matrix, y_{n+τ} = A y_n, whose
// eigenvalue λ^τ with |λ| > 1 is sought in the space that the frames span (dynamic mode decomposition), over
// pairs z_n = (y_n, y_{n+τ}): a real pattern with a complex λ needs two.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>

namespace springstab::diagnosis {

/// Positions of a run, a column for each frame.
using Frames = Eigen::Ref<const Eigen::MatrixXd>;

/// Where to look: differences of order p, numbers begin to end - 1 of them.
struct GrowthWindow {
  int order;
  Eigen::Index begin, end, lag;
};

/// Δᵖ x_n, from the frames n to n + p.
Eigen::VectorXd difference(const Frames& frames, int order, Eigen::Index n);

struct GrowingComponent {
  Eigen::VectorXcd pattern;    // φ, of unit norm
  Eigen::VectorXcd now, late;  // its amplitude in y_n is b_n = now·y_n + late·y_{n+lag}, without conjugation
  double share;                // of it in the window's last pair, 1 where that is nothing else
  double residual;             // of the window's pairs, relative, each counted alike: what A does not explain
};

/// The component with the largest share of those that grow; nothing where none does.
std::optional<GrowingComponent> growing_component(const Frames& frames, const GrowthWindow& window);

}  // namespace springstab::diagnosis
