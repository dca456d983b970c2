#include "solvers/scene/springs.h"

#include <cmath>
#include <numeric>

namespace springstab {
namespace {

double dot(const ParticlePairs::Vectors& u, const ParticlePairs::Vectors& w, int k) {
  return u[0][k] * w[0][k] + u[1][k] * w[1][k] + u[2][k] * w[2][k];
}

// The stiffness block of a spring is a I + b ddᵀ, d not normalized.
struct Stiffness {
  double a, b;
};

Stiffness stiffness_of(double stiffness, double rest_length, double squared_length) {
  const double inverse = 1 / std::sqrt(squared_length);
  const double transverse = stiffness * (1 - rest_length * inverse);
  return {transverse, (stiffness - transverse) * inverse * inverse};
}

Stiffness projected_stiffness_of(double stiffness, double rest_length, double squared_length) {
  const Stiffness s = stiffness_of(stiffness, rest_length, squared_length);
  return s.a < 0 ? Stiffness{0, stiffness / squared_length} : s;  // what is not a number stays so
}

// a I + b uuᵀ, symmetric to the last bit, in rows of four numbers of which the last is zero.
struct SpringBlock {
  Four r0 = Four::Zero(), r1 = r0, r2 = r0;

  SpringBlock() = default;
  explicit SpringBlock(const ParticlePairs::Kept& s) {
    const Eigen::Map<const Four> u(s.u);
    r0 = s.b * (s.u[0] * u) + s.a * Four(1, 0, 0, 0);
    r1 = s.b * (s.u[1] * u) + s.a * Four(0, 1, 0, 0);
    r2 = s.b * (s.u[2] * u) + s.a * Four(0, 0, 1, 0);
  }
  void operator+=(const SpringBlock& other) {
    r0 += other.r0;
    r1 += other.r1;
    r2 += other.r2;
  }
};

// block += factor · rows. What a row of four writes beyond its three, the next one overwrites.
void add(const SpringBlock& rows, double factor, double* block) {
  const Four r0 = FourAt(block) + factor * rows.r0, r1 = FourAt(block + 3) + factor * rows.r1;
  const double r2[3] = {block[6] + factor * rows.r2[0], block[7] + factor * rows.r2[1],
                        block[8] + factor * rows.r2[2]};
  FourAt{block} = r0;
  FourAt{block + 3} = r1;
  std::copy(r2, r2 + 3, block + 6);
}

}  // namespace

ParticlePairs::ParticlePairs(const std::vector<Spring>& springs, int free_count) : free_count_(free_count) {
  for (const Spring& s : springs) {
    i_.push_back(s.i);
    j_.push_back(s.j);
  }
  incident_start_.assign(free_count + 1, 0);
  for (const std::vector<int>* ends : {&i_, &j_})
    for (const int end : *ends)
      if (end < free_count) ++incident_start_[end + 1];
  std::partial_sum(incident_start_.begin(), incident_start_.end(), incident_start_.begin());
  incident_.resize(incident_start_.back());
  std::vector<long> next = incident_start_;
  for (int k = 0; k < size(); ++k)
    for (const int end : {i_[k], j_[k]})
      if (end < free_count) incident_[next[end]++] = k;
  kept_.resize(i_.size());
}

Couplings ParticlePairs::couplings() const {
  Couplings pairs;
  for (int k = 0; k < size(); ++k)
    if (i_[k] < free_count_ && j_[k] < free_count_) pairs.emplace_back(i_[k], j_[k]);
  return pairs;
}

long ParticlePairs::find_place(const BlockSparseMatrix& matrix, int i, int pair) const {
  const int other = i_[pair] == i ? j_[pair] : i_[pair];
  return other < i ? matrix.find(i, other) : -1;
}

void ParticlePairs::bind(const BlockSparseMatrix& matrix) {
  bound_ = &matrix;
  place_.clear();
  for (int i = 0; i < free_count_; ++i)
    for (long m = incident_start_[i]; m < incident_start_[i + 1]; ++m)
      place_.push_back(find_place(matrix, i, incident_[m]));
}

template <class At>
void ParticlePairs::gather_from(const At& at, int begin, int count, Vectors& out) const {
  const int* const first = &i_[begin];
  const int* const second = &j_[begin];
  for (int k = 0; k < count;) {
    const int i = first[k];
    const double* const u = at(i);
    const double u0 = u[0], u1 = u[1], u2 = u[2];
    do {
      const double* const w = at(second[k]);
      out[0][k] = u0 - w[0];
      out[1][k] = u1 - w[1];
      out[2][k] = u2 - w[2];
    } while (++k < count && first[k] == i);
  }
}

void ParticlePairs::gather(const ParticleField& u, int begin, int count, Vectors& out) const {
  gather_from([&](int particle) { return u[particle]; }, begin, count, out);
}

void ParticlePairs::gather(const double* u, int begin, int count, Vectors& out) const {
  static constexpr double fixed[3] = {0, 0, 0};
  gather_from(
      [&](int particle) { return particle < free_count_ ? u + 3 * static_cast<long>(particle) : fixed; },
      begin, count, out);
}

void ParticlePairs::scatter(const Vectors& u, int begin, int count, double* out) const {
  const int* const first = &i_[begin];
  const int* const second = &j_[begin];
  for (int k = 0; k < count;) {
    const int i = first[k];
    double sum0 = 0, sum1 = 0, sum2 = 0;
    do {
      sum0 += u[0][k];
      sum1 += u[1][k];
      sum2 += u[2][k];
      if (second[k] < free_count_) {
        double* const w = out + 3 * static_cast<long>(second[k]);
        w[0] -= u[0][k];
        w[1] -= u[1][k];
        w[2] -= u[2][k];
      }
    } while (++k < count && first[k] == i);
    if (i < free_count_) {
      double* const w = out + 3 * static_cast<long>(i);
      w[0] += sum0;
      w[1] += sum1;
      w[2] += sum2;
    }
  }
}

void ParticlePairs::keep(const Numbers& a, const Numbers& b, const Vectors& u, int begin, int count) const {
  for (int k = 0; k < count; ++k) kept_[begin + k] = {{u[0][k], u[1][k], u[2][k], 0}, a[k], b[k]};
}

void ParticlePairs::add_kept_blocks(BlockSparseMatrix& matrix) const {
  const bool known = bound_ == &matrix;
  for (int i = 0; i < free_count_; ++i) {
    SpringBlock sum;
    for (long m = incident_start_[i]; m < incident_start_[i + 1]; ++m) {
      const SpringBlock block(kept_[incident_[m]]);
      sum += block;
      const long place = known ? place_[m] : find_place(matrix, i, incident_[m]);
      if (place >= 0) add(block, -1, matrix.block(place));
    }
    add(sum, 1, matrix.block(matrix.diagonal(i)));
  }
}

Springs::Springs(const std::vector<Spring>& springs, int free_count) : pairs_(springs, free_count) {
  for (const Spring& s : springs) {
    stiffness_.push_back(s.stiffness);
    rest_length_.push_back(s.rest_length);
  }
}

double Springs::energy(const ParticleField& x) const {
  double sum = 0;
  pairs_.for_each_batch([&](int begin, int count) {
    ParticlePairs::Vectors d;
    pairs_.gather(x, begin, count, d);
    for (int k = 0; k < count; ++k) {
      const double stretch = std::sqrt(dot(d, d, k)) - rest_length_[begin + k];
      sum += stiffness_[begin + k] * stretch * stretch;
    }
  });
  return sum / 2;
}

void Springs::add_force(const ParticleField& x, double* force) const {
  pairs_.for_each_batch([&](int begin, int count) {
    ParticlePairs::Vectors d;
    pairs_.gather(x, begin, count, d);
    for (int k = 0; k < count; ++k) {
      const double c = -stiffness_[begin + k] * (1 - rest_length_[begin + k] / std::sqrt(dot(d, d, k)));
      for (int r = 0; r < 3; ++r) d[r][k] *= c;
    }
    pairs_.scatter(d, begin, count, force);
  });
}

void Springs::add_stiffness_times(const ParticleField& x, const double* u, double scale, double* out) const {
  pairs_.for_each_batch([&](int begin, int count) {
    ParticlePairs::Vectors d, w;
    pairs_.gather(x, begin, count, d);
    pairs_.gather(u, begin, count, w);
    for (int k = 0; k < count; ++k) {
      const Stiffness s = stiffness_of(stiffness_[begin + k], rest_length_[begin + k], dot(d, d, k));
      const double across = scale * s.a, along = scale * s.b * dot(d, w, k);
      for (int r = 0; r < 3; ++r) w[r][k] = across * w[r][k] + along * d[r][k];
    }
    pairs_.scatter(w, begin, count, out);
  });
}

void Springs::add_damped_force(const ParticleField& x, const double* v, double alpha, double* force) const {
  pairs_.for_each_batch([&](int begin, int count) {
    ParticlePairs::Vectors d, w;
    pairs_.gather(x, begin, count, d);
    pairs_.gather(v, begin, count, w);
    for (int k = 0; k < count; ++k) {
      const Stiffness s = stiffness_of(stiffness_[begin + k], rest_length_[begin + k], dot(d, d, k));
      const double across = -alpha * s.a, along = -s.a - alpha * s.b * dot(d, w, k);
      for (int r = 0; r < 3; ++r) w[r][k] = across * w[r][k] + along * d[r][k];
    }
    pairs_.scatter(w, begin, count, force);
  });
}

template <class StiffnessOf>
void Springs::add_blocks(const ParticleField& x, BlockSparseMatrix& matrix,
                         const StiffnessOf& block_of) const {
  pairs_.for_each_batch([&](int begin, int count) {
    ParticlePairs::Vectors d;
    ParticlePairs::Numbers a, b;
    pairs_.gather(x, begin, count, d);
    for (int k = 0; k < count; ++k) {
      const Stiffness s = block_of(stiffness_[begin + k], rest_length_[begin + k], dot(d, d, k));
      a[k] = s.a;
      b[k] = s.b;
    }
    pairs_.keep(a, b, d, begin, count);
  });
  pairs_.add_kept_blocks(matrix);
}

void Springs::add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const {
  add_blocks(x, stiffness, [](auto... of) { return stiffness_of(of...); });
}

void Springs::add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const {
  add_blocks(x, stiffness, [](auto... of) { return projected_stiffness_of(of...); });
}

AxialDamping::AxialDamping(const std::vector<Spring>& springs, int free_count) : pairs_(springs, free_count) {
  for (const Spring& s : springs) damping_.push_back(s.damping);
}

void AxialDamping::add_force(const ParticleField& x, const ParticleField& v, double* force) const {
  pairs_.for_each_batch([&](int begin, int count) {
    ParticlePairs::Vectors d, w;
    pairs_.gather(x, begin, count, d);
    pairs_.gather(v, begin, count, w);
    for (int k = 0; k < count; ++k) {
      const double c = -damping_[begin + k] * dot(d, w, k) / dot(d, d, k);
      for (int r = 0; r < 3; ++r) d[r][k] *= c;
    }
    pairs_.scatter(d, begin, count, force);
  });
}

void AxialDamping::add_damping(const ParticleField& x, BlockSparseMatrix& damping) const {
  pairs_.for_each_batch([&](int begin, int count) {
    ParticlePairs::Vectors d;
    ParticlePairs::Numbers a, b;
    pairs_.gather(x, begin, count, d);
    for (int k = 0; k < count; ++k) {
      a[k] = 0;
      b[k] = damping_[begin + k] / dot(d, d, k);
    }
    pairs_.keep(a, b, d, begin, count);
  });
  pairs_.add_kept_blocks(damping);
}

SceneTerms make_terms(const SpringNet& net, const std::vector<int>& number, int free_count) {
  std::vector<Spring> elastic, damped;
  for (Spring s : net.springs) {
    s.i = number[s.i];
    s.j = number[s.j];
    if (std::min(s.i, s.j) >= free_count) continue;
    if (s.stiffness > 0) elastic.push_back(s);
    if (s.damping > 0) damped.push_back(s);
  }
  SceneTerms terms;
  if (!elastic.empty()) terms.elastic.push_back(std::make_unique<Springs>(elastic, free_count));
  if (!damped.empty()) terms.damping.push_back(std::make_unique<AxialDamping>(damped, free_count));
  return terms;
}

}  // namespace springstab
