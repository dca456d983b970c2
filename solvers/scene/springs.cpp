#include "solvers/scene/springs.h"

#include <cmath>

namespace springstab {
namespace {

struct Axis {
  double n[3];    // unit vector from j to i
  double length;  // [m]
};

Axis axis(const ParticleField& x, const Spring& s) {
  const double* xi = x[s.i];
  const double* xj = x[s.j];
  const double d[3] = {xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]};
  const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  return {{d[0] / length, d[1] / length, d[2] / length}, length};
}

// The stiffness block is a I + b nnᵀ.
struct Stiffness {
  double a, b;
};

Stiffness stiffness_of(const Spring& s, double length) {
  const double transverse = s.stiffness * (1 - s.rest_length / length);
  return {transverse, s.stiffness - transverse};
}

// out_i += c u, out_j -= c u, where the particles are free.
void add_pair(const Spring& s, int free_count, double c, const double* u, double* out) {
  if (s.i < free_count)
    for (int r = 0; r < 3; ++r) out[3 * static_cast<long>(s.i) + r] += c * u[r];
  if (s.j < free_count)
    for (int r = 0; r < 3; ++r) out[3 * static_cast<long>(s.j) + r] -= c * u[r];
}

// matrix += [[B, -B], [-B, B]] with B = a I + b nnᵀ, on the free particles.
void add_blocks(const Spring& s, int free_count, double a, double b, const double* n,
                BlockSparseMatrix& matrix) {
  const bool i = s.i < free_count, j = s.j < free_count;
  if (i) add_isotropic_and_axial(matrix.block(matrix.diagonal(s.i)), a, b, n);
  if (j) add_isotropic_and_axial(matrix.block(matrix.diagonal(s.j)), a, b, n);
  if (i && j) {
    add_isotropic_and_axial(matrix.block(matrix.find(s.i, s.j)), -a, -b, n);
    add_isotropic_and_axial(matrix.block(matrix.find(s.j, s.i)), -a, -b, n);
  }
}

Couplings couplings_of(const std::vector<Spring>& springs, int free_count) {
  Couplings pairs;
  for (const Spring& s : springs)
    if (s.i < free_count && s.j < free_count) pairs.emplace_back(s.i, s.j);
  return pairs;
}

}  // namespace

Springs::Springs(std::vector<Spring> springs, int free_count)
    : springs_(std::move(springs)), free_count_(free_count) {}

double Springs::energy(const ParticleField& x) const {
  double sum = 0;
  for (const Spring& s : springs_) {
    const double stretch = axis(x, s).length - s.rest_length;
    sum += s.stiffness * stretch * stretch;
  }
  return sum / 2;
}

void Springs::add_force(const ParticleField& x, double* force) const {
  for (const Spring& s : springs_) {
    const Axis d = axis(x, s);
    add_pair(s, free_count_, -s.stiffness * (d.length - s.rest_length), d.n, force);
  }
}

void Springs::add_stiffness_times(const ParticleField& x, const double* u, double scale, double* out) const {
  constexpr double fixed[3] = {0, 0, 0};
  for (const Spring& s : springs_) {
    const Axis d = axis(x, s);
    const Stiffness k = stiffness_of(s, d.length);
    const double* ui = s.i < free_count_ ? u + 3 * static_cast<long>(s.i) : fixed;
    const double* uj = s.j < free_count_ ? u + 3 * static_cast<long>(s.j) : fixed;
    const double w[3] = {ui[0] - uj[0], ui[1] - uj[1], ui[2] - uj[2]};
    const double along = d.n[0] * w[0] + d.n[1] * w[1] + d.n[2] * w[2];
    double product[3];
    for (int r = 0; r < 3; ++r) product[r] = k.a * w[r] + k.b * along * d.n[r];
    add_pair(s, free_count_, scale, product, out);
  }
}

Couplings Springs::couplings() const { return couplings_of(springs_, free_count_); }

void Springs::add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const {
  for (const Spring& s : springs_) {
    const Axis d = axis(x, s);
    const Stiffness k = stiffness_of(s, d.length);
    add_blocks(s, free_count_, k.a, k.b, d.n, stiffness);
  }
}

AxialDamping::AxialDamping(std::vector<Spring> springs, int free_count)
    : springs_(std::move(springs)), free_count_(free_count) {}

void AxialDamping::add_force(const ParticleField& x, const ParticleField& v, double* force) const {
  for (const Spring& s : springs_) {
    const Axis d = axis(x, s);
    const double* vi = v[s.i];
    const double* vj = v[s.j];
    const double rate = (vi[0] - vj[0]) * d.n[0] + (vi[1] - vj[1]) * d.n[1] + (vi[2] - vj[2]) * d.n[2];
    add_pair(s, free_count_, -s.damping * rate, d.n, force);
  }
}

Couplings AxialDamping::couplings() const { return couplings_of(springs_, free_count_); }

void AxialDamping::add_damping(const ParticleField& x, BlockSparseMatrix& damping) const {
  for (const Spring& s : springs_) add_blocks(s, free_count_, 0, s.damping, axis(x, s).n, damping);
}

}  // namespace springstab
