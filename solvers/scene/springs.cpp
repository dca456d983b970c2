#include "solvers/scene/springs.h"

#include <cmath>
#include <numeric>
#include <tuple>

namespace springstab {
namespace {

constexpr int tile = 192;  // particles whose springs stand together

double dot(const ParticlePairs::Vectors& u, const ParticlePairs::Vectors& w, int k) {
  return u[3 * k] * w[3 * k] + u[3 * k + 1] * w[3 * k + 1] + u[3 * k + 2] * w[3 * k + 2];
}

// w = across w + along d, all of w read before any of it is written: the vectorized loop loads it once.
[[gnu::always_inline]] inline void combine(double across, ParticlePairs::Vectors& w, double along,
                                           const ParticlePairs::Vectors& d, int k) {
  const double x = across * w[3 * k] + along * d[3 * k];
  const double y = across * w[3 * k + 1] + along * d[3 * k + 1];
  const double z = across * w[3 * k + 2] + along * d[3 * k + 2];
  w[3 * k] = x;
  w[3 * k + 1] = y;
  w[3 * k + 2] = z;
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

std::vector<Spring> ParticlePairs::in_runs(std::vector<Spring> springs) {
  const auto key = [](const Spring& s) { return std::tuple(s.i / tile, s.j - s.i, s.i); };
  std::sort(springs.begin(), springs.end(),
            [&](const Spring& s, const Spring& t) { return key(s) < key(t); });
  return springs;
}

ParticlePairs::ParticlePairs(const std::vector<Spring>& springs, int free_count)
    : size_(static_cast<int>(springs.size())), free_count_(free_count) {
  for (int k = 0; k < size_; ++k) {
    const auto [i, j] = std::pair(springs[k].i, springs[k].j);
    const bool new_batch = k % batch_size == 0;
    if (new_batch) run_start_.push_back(static_cast<int>(runs_.size()));
    Run* const last = new_batch ? nullptr : &runs_.back();
    if (last && i == last->i + last->count && j == last->j + last->count && i != free_count &&
        j != free_count) {
      ++last->count;
    } else {
      runs_.push_back({i, j, 1});
    }
  }
  run_start_.push_back(static_cast<int>(runs_.size()));
}

template <class Visit>
void ParticlePairs::visit_pairs(const Visit& visit) const {
  int pair = 0;
  for (const Run& run : runs_)
    for (int k = 0; k < run.count; ++k) visit(pair++, run.i + k, run.j + k);
}

void ParticlePairs::prepare_blocks() const {
  if (!kept_.empty()) return;
  incident_start_.assign(free_count_ + 1, 0);
  visit_pairs([&](int, int i, int j) {
    for (const int end : {i, j})
      if (end < free_count_) ++incident_start_[end + 1];
  });
  std::partial_sum(incident_start_.begin(), incident_start_.end(), incident_start_.begin());
  incident_.resize(incident_start_.back());
  std::vector<long> next = incident_start_;
  visit_pairs([&](int pair, int i, int j) {
    if (i < free_count_) incident_[next[i]++] = {pair, j};
    if (j < free_count_) incident_[next[j]++] = {pair, i};
  });
  kept_.resize(static_cast<std::size_t>(size_));
}

Couplings ParticlePairs::couplings() const {
  Couplings pairs;
  pairs.reserve(static_cast<std::size_t>(size_));
  visit_pairs([&](int, int i, int j) {
    if (std::max(i, j) < free_count_) pairs.emplace_back(i, j);
  });
  return pairs;
}

void ParticlePairs::bind(const SharedPattern& pattern) {
  prepare_blocks();
  pattern_ = pattern;
  place_.clear(), place_.reserve(incident_.size());
  for (int i = 0; i < free_count_; ++i)
    for (long m = incident_start_[i]; m < incident_start_[i + 1]; ++m)
      place_.push_back(find_place(*pattern, i, incident_[m].other));
}

void ParticlePairs::unbind() {
  pattern_ = nullptr;
  std::vector<long>().swap(place_), std::vector<long>().swap(incident_start_);  // = {} keeps the memory
  std::vector<Incident>().swap(incident_), std::vector<Kept>().swap(kept_);
}

template <class At>
void ParticlePairs::gather_from(const At& at, int begin, Vectors& out) const {
  double* to = out;
  for (const Run& run : runs(begin)) {
    const double *const u = at(run.i), *const w = at(run.j);
    const int count = 3 * run.count;
    for (int r = 0; r < count; ++r) to[r] = u[r] - w[r];
    to += count;
  }
}

void ParticlePairs::gather(const ParticleField& u, int begin, Vectors& out) const {
  gather_from([&](int particle) { return u[particle]; }, begin, out);
}

void ParticlePairs::gather(const double* u, int begin, Vectors& out) const {
  static constexpr double fixed[3 * batch_size] = {};
  gather_from(
      [&](int particle) { return particle < free_count_ ? u + 3 * static_cast<long>(particle) : fixed; },
      begin, out);
}

void ParticlePairs::scatter(const Vectors& u, int begin, const IndexRange& mine, double* out) const {
  const double* from = u;
  for (const Run& run : runs(begin)) {
    const auto add = [&](int first_particle, double sign) {
      const long first = std::max<long>(first_particle, mine.first);
      const long last = std::min<long>(first_particle + static_cast<long>(run.count), mine.last);
      const double* const some = from + 3 * (first - first_particle);
      double* const to = out + 3 * first;
      for (long r = 0; r < 3 * (last - first); ++r) to[r] += sign * some[r];
    };
    add(run.i, 1);
    add(run.j, -1);
    from += 3 * run.count;
  }
}

bool ParticlePairs::touches(int batch, const IndexRange& particles) const {
  for (const Run& run : runs(batch * batch_size))
    for (const int first : {run.i, run.j})
      if (first < particles.last && first + run.count > particles.first) return true;
  return false;
}

void ParticlePairs::keep(const Numbers& a, const Numbers& b, const Vectors& u, int begin, int count) const {
  for (int k = 0; k < count; ++k) kept_[begin + k] = {{u[3 * k], u[3 * k + 1], u[3 * k + 2], 0}, a[k], b[k]};
}

void ParticlePairs::add_kept_blocks(BlockSparseMatrix& matrix) const {
  constexpr double row_cost = 50;  // [ns]
  const bool known = pattern_ == matrix.pattern();
  share_range(free_count_, row_cost, [&](long begin, long end) {
    for (int i = static_cast<int>(begin); i < end; ++i) {
      SpringBlock sum;
      for (long m = incident_start_[i]; m < incident_start_[i + 1]; ++m) {
        const SpringBlock block(kept_[incident_[m].pair]);
        sum += block;
        const long place = known ? place_[m] : find_place(*matrix.pattern(), i, incident_[m].other);
        if (place >= 0) add(block, -1, matrix.block(place));
      }
      add(sum, 1, matrix.block(matrix.diagonal(i)));
    }
  });
}

Springs::Springs(const std::vector<Spring>& springs, int free_count) : pairs_(springs, free_count) {
  stiffness_.reserve(springs.size()), rest_length_.reserve(springs.size());
  for (const Spring& s : springs) {
    stiffness_.push_back(s.stiffness);
    rest_length_.push_back(s.rest_length);
  }
}

double Springs::energy(const ParticleField& x) const {
  double sum = 0;
  pairs_.for_each_batch([&](int begin, int count) {
    alignas(64) ParticlePairs::Vectors d;
    pairs_.gather(x, begin, d);
    for (int k = 0; k < count; ++k) {
      const double stretch = std::sqrt(dot(d, d, k)) - rest_length_[begin + k];
      sum += stiffness_[begin + k] * stretch * stretch;
    }
  });
  return sum / 2;
}

void Springs::add_force(const ParticleField& x, double* force) const {
  pairs_.share_batches([&](int begin, int count, const IndexRange& mine) {
    alignas(64) ParticlePairs::Vectors d;
    pairs_.gather(x, begin, d);
    for (int k = 0; k < count; ++k) {
      const double c = -stiffness_[begin + k] * (1 - rest_length_[begin + k] / std::sqrt(dot(d, d, k)));
      for (int r = 0; r < 3; ++r) d[3 * k + r] *= c;
    }
    pairs_.scatter(d, begin, mine, force);
  });
}

void Springs::add_stiffness_times(const ParticleField& x, const double* u, double scale, double* out) const {
  pairs_.share_batches([&](int begin, int count, const IndexRange& mine) {
    alignas(64) ParticlePairs::Vectors d, w;
    pairs_.gather(x, begin, d);
    pairs_.gather(u, begin, w);
    for (int k = 0; k < count; ++k) {
      const Stiffness s = stiffness_of(stiffness_[begin + k], rest_length_[begin + k], dot(d, d, k));
      const double across = scale * s.a, along = scale * s.b * dot(d, w, k);
      combine(across, w, along, d, k);
    }
    pairs_.scatter(w, begin, mine, out);
  });
}

void Springs::add_damped_force(const ParticleField& x, const double* v, double alpha, double* force) const {
  pairs_.share_batches([&](int begin, int count, const IndexRange& mine) {
    alignas(64) ParticlePairs::Vectors d, w;
    pairs_.gather(x, begin, d);
    pairs_.gather(v, begin, w);
    for (int k = 0; k < count; ++k) {
      const Stiffness s = stiffness_of(stiffness_[begin + k], rest_length_[begin + k], dot(d, d, k));
      const double across = -alpha * s.a, along = -s.a - alpha * s.b * dot(d, w, k);
      combine(across, w, along, d, k);
    }
    pairs_.scatter(w, begin, mine, force);
  });
}

template <class StiffnessOf>
void Springs::add_blocks(const ParticleField& x, BlockSparseMatrix& matrix,
                         const StiffnessOf& block_of) const {
  pairs_.prepare_blocks();
  pairs_.for_each_batch_at_once([&](int begin, int count) {
    alignas(64) ParticlePairs::Vectors d;
    alignas(64) ParticlePairs::Numbers a, b;
    pairs_.gather(x, begin, d);
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
  pairs_.share_batches([&](int begin, int count, const IndexRange& mine) {
    alignas(64) ParticlePairs::Vectors d, w;
    pairs_.gather(x, begin, d);
    pairs_.gather(v, begin, w);
    for (int k = 0; k < count; ++k) {
      const double c = -damping_[begin + k] * dot(d, w, k) / dot(d, d, k);
      for (int r = 0; r < 3; ++r) d[3 * k + r] *= c;
    }
    pairs_.scatter(d, begin, mine, force);
  });
}

void AxialDamping::add_damping(const ParticleField& x, BlockSparseMatrix& damping) const {
  pairs_.prepare_blocks();
  pairs_.for_each_batch_at_once([&](int begin, int count) {
    alignas(64) ParticlePairs::Vectors d;
    alignas(64) ParticlePairs::Numbers a, b;
    pairs_.gather(x, begin, d);
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
  elastic.reserve(net.springs.size());
  for (Spring s : net.springs) {
    s.i = number[s.i];
    s.j = number[s.j];
    if (std::min(s.i, s.j) >= free_count) continue;
    if (s.stiffness > 0) elastic.push_back(s);
    if (s.damping > 0) damped.push_back(s);
  }
  SceneTerms terms;
  if (!elastic.empty())
    terms.elastic.push_back(
        std::make_unique<Springs>(ParticlePairs::in_runs(std::move(elastic)), free_count));
  if (!damped.empty())
    terms.damping.push_back(
        std::make_unique<AxialDamping>(ParticlePairs::in_runs(std::move(damped)), free_count));
  return terms;
}

}  // namespace springstab
