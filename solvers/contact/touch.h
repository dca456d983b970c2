// Springs between two places of surfaces that are nearer to each other than the thickness t: the energy of
// one touch, its derivatives, and its linearization. It is a function of the six products of the directions
// u, w and d (closest_places.h), and so its derivatives are exact (jet.h):
//     E = c s ½ k_c (t - |Δ|)²,   Δ = Σ w_i x_i between the closest places, w their weights,
//     s = 1 of a vertex,   s = sin²θ · 16 a²(1-a)² · 16 b²(1-b)² of two edges at the angle θ that come
//     closest at the parts a and b of them: nothing where one of these is a vertex or they are parallel, so
//     that the force does not jump there; what is closest there is a vertex that meets an edge.
// With n = Δ/|Δ|, and w, n and s held, it has K = c s k_c (w wᵀ) ⊗ (n nᵀ) and the dampers C = c s d_c
// likewise.
#pragma once

#include <Eigen/Core>
#include <array>

#include "solvers/contact/closest_places.h"

namespace springstab {

/// What a vertex comes closest to, or that two edges do within both.
enum class TouchKind { vertex_vertex, vertex_edge, vertex_face, edge_edge };

/// Four particles v, p0, p1, p2 or a0, a1, b0, b1, of which a vertex and vertex take two, vertex and edge
/// three.
struct Touch {
  std::array<int, 4> particles;
  TouchKind kind;
  int count;  // c: how often it counts (surface_touches.h), never 0
};

struct TouchPlaces {
  std::array<double, 4> weights;  // w
  Eigen::Vector3d normal;         // n, zero where the places are one
  double distance;                // |Δ| [m]
  double share;                   // s
};
TouchPlaces touch_places(TouchKind kind, const FourPlaces& x);

using FourVectors = Eigen::Matrix<double, 3, 4>;  // a column for each of the four particles

/// Of E with c = 1. Nothing but the energy where the places are one to rounding: there E has a kink.
struct TouchSpring {
  double stiffness, thickness;  // k_c [N/m], t [m]

  double energy(TouchKind kind, const FourPlaces& x) const;
  FourVectors gradient(TouchKind kind, const FourPlaces& x) const;
  Eigen::Matrix<double, 12, 12> hessian(TouchKind kind, const FourPlaces& x) const;
};

}  // namespace springstab
