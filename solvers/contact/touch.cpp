#include "solvers/contact/touch.h"

#include <cmath>

#include "solvers/contact/jet.h"

namespace springstab {
namespace {

constexpr double one_place = 1e-15;  // of |d|²: where |Δ|² is no more than rounding

PairDirections directions_of(TouchKind kind, const FourPlaces& x) {
  return pair_directions(kind == TouchKind::edge_edge ? PairKind::edge_edge : PairKind::vertex_face, x);
}

// u·u, w·w, d·d, u·w, u·d, w·d.
template <class Number>
using Products = std::array<Number, 6>;

Products<double> products_of(const PairDirections& p) {
  return {p.u.dot(p.u), p.w.dot(p.w), p.d.dot(p.d), p.u.dot(p.w), p.u.dot(p.d), p.w.dot(p.d)};
}

template <class Number>
struct Closest {
  Number a, b;    // parts along u and w
  Number square;  // |Δ|² [m²]
  Number share;
};

template <class Number>
Number bump(const Number& a) {
  const Number half = 4. * a * (1. - a);
  return half * half;
}

template <class Number>
Closest<Number> closest(TouchKind kind, const Products<Number>& p) {
  const auto& [uu, ww, dd, uw, ud, wd] = p;
  const Number zero{0}, one{1};
  if (kind == TouchKind::vertex_vertex) return {zero, zero, dd, one};
  if (kind == TouchKind::vertex_edge) {
    const Number a = ud / uu;
    return {a, zero, dd - a * ud, one};
  }
  const Number determinant = uu * ww - uw * uw;
  if (kind == TouchKind::vertex_face) {
    const Number a = (ud * ww - wd * uw) / determinant, b = (wd * uu - ud * uw) / determinant;
    return {a, b, dd - a * ud - b * wd, one};
  }
  const Number a = (wd * uw - ud * ww) / determinant, b = (wd * uu - ud * uw) / determinant;
  return {a, b, dd + a * ud - b * wd, determinant / (uu * ww) * bump(a) * bump(b)};
}

template <class Number>
Number energy_of_touch(const TouchSpring& spring, const Closest<Number>& at) {
  using std::sqrt;
  const Number overlap = spring.thickness - sqrt(at.square);
  return spring.stiffness / 2 * at.share * overlap * overlap;
}

// Of u, w and d in the four particles: row i of particle i.
Eigen::Matrix<double, 4, 3> incidence(TouchKind kind) {
  Eigen::Matrix<double, 4, 3> n;
  if (kind == TouchKind::edge_edge) {
    n << -1, 0, 1, 1, 0, 0, 0, -1, -1, 0, 1, 0;
  } else {
    n << 0, 0, 1, -1, -1, -1, 1, 0, 0, 0, 1, 0;
  }
  return n;
}

template <bool has_second>
Jet<6, has_second> energy_jet(const TouchSpring& spring, TouchKind kind, const PairDirections& p) {
  using Number = Jet<6, has_second>;
  const Products<double> of = products_of(p);
  Products<Number> variables;
  for (int i = 0; i < 6; ++i) variables[i] = Number::variable(of[i], i);
  const Closest<Number> at = closest(kind, variables);
  if (!(at.square.value > one_place * of[2])) return Number{0};
  return energy_of_touch(spring, at);
}

// Of E by u, w, d: their columns times this.
Eigen::Matrix3d slope(const Eigen::Vector<double, 6>& by_product) {
  const auto& f = by_product;
  Eigen::Matrix3d s;
  s << 2 * f[0], f[3], f[4], f[3], 2 * f[1], f[5], f[4], f[5], 2 * f[2];
  return s;
}

Eigen::Matrix3d columns(const PairDirections& p) {
  Eigen::Matrix3d z;
  z << p.u, p.w, p.d;
  return z;
}

// Of the six products by u, w, d, a column for each.
Eigen::Matrix<double, 9, 6> product_slopes(const PairDirections& p) {
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 9, 6> j;
  j << 2 * p.u, none, none, p.w, p.d, none,  //
      none, 2 * p.w, none, p.u, none, p.d,   //
      none, none, 2 * p.d, none, p.u, p.w;
  return j;
}

}  // namespace

TouchPlaces touch_places(TouchKind kind, const FourPlaces& x) {
  const PairDirections p = directions_of(kind, x);
  const auto [a, b, square, share] = closest(kind, products_of(p));
  const bool edges = kind == TouchKind::edge_edge;
  const Eigen::Vector3d apart = edges ? Eigen::Vector3d(p.d + a * p.u - b * p.w) : p.d - a * p.u - b * p.w;
  TouchPlaces at{{1, a + b - 1, -a, -b}, apart.stableNormalized(), apart.norm(), share};
  if (edges) at.weights = {1 - a, a, b - 1, -b};
  return at;
}

double TouchSpring::energy(TouchKind kind, const FourPlaces& x) const {
  Closest<double> at = closest(kind, products_of(directions_of(kind, x)));
  at.square = std::max(at.square, 0.);
  return energy_of_touch(*this, at);
}

FourVectors TouchSpring::gradient(TouchKind kind, const FourPlaces& x) const {
  const PairDirections p = directions_of(kind, x);
  return columns(p) * slope(energy_jet<false>(*this, kind, p).first) * incidence(kind).transpose();
}

Eigen::Matrix<double, 12, 12> TouchSpring::hessian(TouchKind kind, const FourPlaces& x) const {
  const PairDirections p = directions_of(kind, x);
  const Jet<6, true> e = energy_jet<true>(*this, kind, p);
  const Eigen::Matrix<double, 9, 6> j = product_slopes(p);
  Eigen::Matrix<double, 9, 9> by_direction = j * e.second * j.transpose();
  const Eigen::Matrix3d s = slope(e.first);
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) by_direction.block<3, 3>(3 * k, 3 * l).diagonal().array() += s(k, l);
  const Eigen::Matrix<double, 4, 3> n = incidence(kind);
  Eigen::Matrix<double, 12, 9> spread;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) spread.block<3, 3>(3 * i, 3 * k) = n(i, k) * Eigen::Matrix3d::Identity();
  return spread * by_direction * spread.transpose();
}

}  // namespace springstab
