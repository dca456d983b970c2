// What all terms made of elements share: elements of 2, 3 or 4 particles taken in batches, the coordinates of
// their particles gathered so that a loop over a batch is vectorized by the compiler, forces and blocks
// scattered back to the free particles. Knows no energy: a term brings what one element computes, for each
// batch a function of the lane.
//
//     elements.add_vectors(x, force, [&](int batch) {
//       return [&rest = rest_[batch], k = stiffness_](const auto& at, int lane, auto& vectors)
//       SPRINGSTAB_LANE {
//         const Vec3 pull = (k * (1 - rest[lane])) * (at.get(1, lane) - at.get(0, lane));
//         vectors.set(0, lane, pull), vectors.set(1, lane, -pull);
//       };
//     });
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "solvers/scene/lane_math.h"
#include "solvers/scene/particle_parts.h"
#include "solvers/scene/terms.h"

/// Stands behind the parameters of a lane's function: only where it is inlined into the loop over a batch is
/// that vectorized.
#define SPRINGSTAB_LANE __attribute__((always_inline))

namespace springstab {

/// Elements in a batch. A multiple of every vector width. More than one vector of them, lest a vector is read
/// back before the single numbers it was gathered from have left the store buffer; few enough that the blocks
/// of a batch stay in the first-level cache.
inline constexpr int batch_size = 16;

/// A vector for each corner of a batch of elements: a structure of arrays.
template <int corners>
struct alignas(64) CornerVectors {
  double component[3 * corners][batch_size];

  [[gnu::always_inline]] Vec3 get(int corner, int lane) const {
    return {component[3 * corner][lane], component[3 * corner + 1][lane], component[3 * corner + 2][lane]};
  }
  [[gnu::always_inline]] void set(int corner, int lane, const Vec3& value) {
    component[3 * corner][lane] = value.x;
    component[3 * corner + 1][lane] = value.y;
    component[3 * corner + 2][lane] = value.z;
  }
};

/// The place of the pair (c, d), c <= d, in the upper triangle of a matrix of corners, row by row.
template <int corners>
constexpr int upper(int c, int d) {
  return c * corners - c * (c - 1) / 2 + (d - c);
}

/// The upper triangle of each element's symmetric matrix of corners x corners blocks, for a batch of
/// elements.
template <int corners>
struct alignas(64) CornerBlocks {
  static constexpr int blocks = corners * (corners + 1) / 2;
  double entry[9 * blocks][batch_size];

  /// The block (c, d), c <= d.
  [[gnu::always_inline]] void set(int c, int d, int lane, const Mat3& block) {
    double(*e)[batch_size] = entry + 9 * upper<corners>(c, d);
    e[0][lane] = block.x.x, e[1][lane] = block.x.y, e[2][lane] = block.x.z;
    e[3][lane] = block.y.x, e[4][lane] = block.y.y, e[5][lane] = block.y.z;
    e[6][lane] = block.z.x, e[7][lane] = block.z.y, e[8][lane] = block.z.z;
  }
};

template <int corners>
class BlockPlaces;

/// Elements by their particles, in a scene's numbers: free ones first, `free_count` of them. Their order
/// stays. The last batch is filled up with copies of the last element, which are computed and thrown away.
template <int corners>
class Elements {
 public:
  using Particles = std::array<int, corners>;

  /// Of what has its `particles`.
  template <class Element>
  Elements(const std::vector<Element>& elements, int free_count)
      : Elements(particles_of(elements), free_count) {}

  Elements(std::vector<Particles> particles, int free_count)
      : particles_(std::move(particles)),
        size_(static_cast<int>(particles_.size())),
        free_count_(free_count) {
    while (size_ > 0 && particles_.size() % batch_size != 0) particles_.push_back(particles_.back());
  }

  int size() const { return size_; }
  int batches() const { return static_cast<int>(particles_.size()) / batch_size; }
  int free_count() const { return free_count_; }
  bool is_free(int particle) const { return particle < free_count_; }

  /// The elements of a batch, without the copies.
  std::span<const Particles> in_batch(int batch) const {
    const int first = batch * batch_size;
    return {&particles_[first], static_cast<std::size_t>(std::min(batch_size, size_ - first))};
  }

  void gather(const ParticleField& field, int batch, CornerVectors<corners>& out) const {
    const Particles* particles = &particles_[batch * batch_size];
    for (int lane = 0; lane < batch_size; ++lane)
      for (int c = 0; c < corners; ++c) {
        const double* from = field[particles[lane][c]];
        for (int r = 0; r < 3; ++r) out.component[3 * c + r][lane] = from[r];
      }
  }

  /// The same for a field of the free particles alone that is zero at the pinned ones.
  void gather_free(const double* field, int batch, CornerVectors<corners>& out) const {
    static constexpr double fixed[3] = {0, 0, 0};
    const Particles* particles = &particles_[batch * batch_size];
    for (int lane = 0; lane < batch_size; ++lane)
      for (int c = 0; c < corners; ++c) {
        const int p = particles[lane][c];
        const double* from = is_free(p) ? field + 3 * static_cast<long>(p) : fixed;
        for (int r = 0; r < 3; ++r) out.component[3 * c + r][lane] = from[r];
      }
  }

  /// out += the vectors, at those free particles that are `mine`.
  void scatter(const CornerVectors<corners>& vectors, int batch, const IndexRange& mine, double* out) const {
    const auto elements = in_batch(batch);
    for (int lane = 0; lane < static_cast<int>(elements.size()); ++lane)
      for (int c = 0; c < corners; ++c)
        if (const int p = elements[lane][c]; mine.holds(p))
          for (int r = 0; r < 3; ++r) out[3 * static_cast<long>(p) + r] += vectors.component[3 * c + r][lane];
  }

  // The loops over all elements. `lane_of` is called with each batch and returns what computes an element, a
  // function of its corners' places `at` and its lane. It keeps coefficients by value, lest they be read
  // again for each lane.

  /// Σ lane(at, i), in the order of the elements.
  template <class LaneOf>
  double sum(const ParticleField& x, const LaneOf& lane_of) const {
    CornerVectors<corners> at;
    double value[batch_size];
    double sum = 0;
    for (int b = 0; b < batches(); ++b) {
      gather(x, b, at);
      const auto lane = lane_of(b);
      for (int i = 0; i < batch_size; ++i) value[i] = lane(at, i);
      for (std::size_t i = 0; i < in_batch(b).size(); ++i) sum += value[i];
    }
    return sum;
  }

  /// out += the vectors that lane(at, i, vectors) sets at each corner.
  template <class LaneOf>
  void add_vectors(const ParticleField& x, double* out, const LaneOf& lane_of) const {
    share_batches([&](int b, const IndexRange& mine) {
      CornerVectors<corners> at, vectors;
      gather(x, b, at);
      const auto lane = lane_of(b);
      for (int i = 0; i < batch_size; ++i) lane(at, i, vectors);
      scatter(vectors, b, mine, out);
    });
  }

  /// The same by lane(at, u, i, vectors) with a second field: a ParticleField, or the free particles' alone
  /// that is zero at the pinned ones.
  template <class Field, class LaneOf>
  void add_vectors(const ParticleField& x, const Field& field, double* out, const LaneOf& lane_of) const {
    share_batches([&](int b, const IndexRange& mine) {
      CornerVectors<corners> at, u, vectors;
      gather(x, b, at);
      if constexpr (std::is_same_v<Field, ParticleField>) {
        gather(field, b, u);
      } else {
        gather_free(field, b, u);
      }
      const auto lane = lane_of(b);
      for (int i = 0; i < batch_size; ++i) lane(at, u, i, vectors);
      scatter(vectors, b, mine, out);
    });
  }

  /// matrix += the blocks that lane(at, i, blocks) sets between corners c <= d, at their places.
  template <class LaneOf>
  void add_blocks(const ParticleField& x, const BlockPlaces<corners>& places, BlockSparseMatrix& matrix,
                  const LaneOf& lane_of) const {
    share_batches([&](int b, const IndexRange& mine) {
      CornerVectors<corners> at;
      CornerBlocks<corners> blocks;
      gather(x, b, at);
      const auto lane = lane_of(b);
      for (int i = 0; i < batch_size; ++i) lane(at, i, blocks);
      places.add(*this, b, blocks, mine, matrix);
    });
  }

  /// The pairs of free particles within the elements, of those in a row that have the same ones but once.
  Couplings couplings() const {
    Couplings pairs;
    for (int k = 0; k < size_; ++k) {
      if (k > 0 && std::ranges::is_permutation(particles_[k], particles_[k - 1])) continue;
      for (int c = 0; c < corners; ++c)
        for (int d = c + 1; d < corners; ++d)
          if (is_free(particles_[k][c]) && is_free(particles_[k][d]))
            pairs.emplace_back(particles_[k][c], particles_[k][d]);
    }
    return pairs;
  }

 private:
  static constexpr double element_cost = 20;  // at least [ns]

  /// Calls work(batch, mine) for every batch, where it is worth it on several threads (particle_parts.h).
  template <class Work>
  void share_batches(const Work& work) const {
    const auto touches = [&](int batch, const IndexRange& particles) {
      for (const Particles& element : in_batch(batch))
        for (const int p : element)
          if (particles.holds(p)) return true;
      return false;
    };
    parts_.share(batches(), free_count_, element_cost * size(), touches, work);
  }

  template <class Element>
  static std::vector<Particles> particles_of(const std::vector<Element>& elements) {
    std::vector<Particles> particles;
    particles.reserve(elements.size());
    for (const Element& e : elements) particles.push_back(e.particles);
    return particles;
  }

  std::vector<Particles> particles_;
  int size_;
  int free_count_;
  mutable ParticleParts parts_;
};

/// Where the blocks of elements are in a matrix. Looking a block up costs more than filling it, so `bind`
/// does it once and for all for the matrices of one pattern; others are served all the same, slowly.
template <int corners>
class BlockPlaces {
 public:
  void bind(const Elements<corners>& elements, const SharedPattern& pattern) {
    if (pattern->blocks() > std::numeric_limits<int>::max())
      throw std::invalid_argument("a matrix of " + std::to_string(pattern->blocks()) +
                                  " blocks, expected at most 2^31 - 1");
    places_.clear();
    places_.reserve(static_cast<std::size_t>(elements.size()));
    for (int b = 0; b < elements.batches(); ++b)
      for (const auto& particles : elements.in_batch(b))
        places_.push_back(look_up(elements, particles, *pattern));
    pattern_ = pattern;
  }

  void unbind() { *this = {}; }

  /// matrix += the blocks of a batch of elements, between free particles, in those rows that are `mine`.
  void add(const Elements<corners>& elements, int batch, const CornerBlocks<corners>& blocks,
           const IndexRange& mine, BlockSparseMatrix& matrix) const {
    const auto in_batch = elements.in_batch(batch);
    const bool bound = pattern_ == matrix.pattern();
    for (int lane = 0; lane < static_cast<int>(in_batch.size()); ++lane) {
      const auto& particles = in_batch[lane];
      const Place place =
          bound ? places_[batch * batch_size + lane] : look_up(elements, particles, *matrix.pattern());
      for (int c = 0, pair = 0; c < corners; ++c) {
        if (mine.holds(particles[c]))
          add_on_diagonal(blocks.entry + 9 * upper<corners>(c, c), lane,
                          matrix.block(matrix.diagonal(particles[c])));
        for (int d = c + 1; d < corners; ++d, ++pair) {
          if (place[pair] < 0 || !mine.holds(std::max(particles[c], particles[d]))) continue;
          const Entries entry = blocks.entry + 9 * upper<corners>(c, d);
          if (particles[c] > particles[d]) {
            add(entry, lane, matrix.block(place[pair]));
          } else {
            add_transposed(entry, lane, matrix.block(place[pair]));
          }
        }
      }
    }
  }

 private:
  /// Of each pair of corners, where the block below the diagonal is that couples them; -1 if one is pinned.
  using Place = std::array<int, corners*(corners - 1) / 2>;

  static Place look_up(const Elements<corners>& elements, const std::array<int, corners>& particles,
                       const BlockPattern& pattern) {
    Place place;
    for (int c = 0, pair = 0; c < corners; ++c)
      for (int d = c + 1; d < corners; ++d, ++pair) {
        const auto [low, high] = std::minmax(particles[c], particles[d]);
        place[pair] = elements.is_free(high) ? static_cast<int>(pattern.find(high, low)) : -1;
      }
    return place;
  }

  using Entries = const double (*)[batch_size];

  /// Reads the upper triangle: a block on the diagonal is symmetric, but for its rounding.
  static void add_on_diagonal(Entries entry, int lane, double* to) {
    const double xx = entry[0][lane], xy = entry[1][lane], xz = entry[2][lane];
    const double yy = entry[4][lane], yz = entry[5][lane], zz = entry[8][lane];
    to[0] += xx, to[1] += xy, to[2] += xz;
    to[3] += xy, to[4] += yy, to[5] += yz;
    to[6] += xz, to[7] += yz, to[8] += zz;
  }

  static void add(Entries entry, int lane, double* to) {
    for (int r = 0; r < 9; ++r) to[r] += entry[r][lane];
  }

  static void add_transposed(Entries entry, int lane, double* to) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) to[3 * c + r] += entry[3 * r + c][lane];
  }

  SharedPattern pattern_;
  std::vector<Place> places_;
};

}  // namespace springstab
