#include "solvers/contact/surface_pairs.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "solvers/contact/kept_pairs.h"

namespace springstab {
namespace {

using PlaceList = std::span<const Eigen::Vector3d>;

FourPlaces places_of(const std::array<int, 4>& p, PlaceList x) {
  return {x[p[0]], x[p[1]], x[p[2]], x[p[3]]};
}

}  // namespace

// Collisions, then proximities, each in the order of kinds and parts, in whatever order they are found.
class ContactList {
 public:
  void clear() {
    order_.clear();
    found_.clear();
    collisions_ = 0;
  }
  void add(bool collides, PairKind kind, const KeptPair& pair, const SurfaceContact& contact) {
    const std::uint64_t is_near = collides ? 0 : 1, is_of_edges = kind == PairKind::edge_edge ? 1 : 0,
                        i = pair.parts[0], j = pair.parts[1];
    order_.emplace_back(is_near << 63 | is_of_edges << 62 | i << 31 | j, found_.size());
    found_.push_back(contact);
    collisions_ += collides;
  }
  StepContacts sorted() {
    std::sort(order_.begin(), order_.end());
    sorted_.clear();
    for (const auto& [key, index] : order_) sorted_.push_back(found_[index]);
    const std::span<const SurfaceContact> all(sorted_);
    return {all.first(collisions_), all.subspan(collisions_)};
  }

 private:
  std::vector<std::pair<std::uint64_t, std::size_t>> order_;
  std::vector<SurfaceContact> found_, sorted_;
  std::size_t collisions_ = 0;
};

struct SurfacePairs::Parts {
  Parts(const Surface& first, const Surface& second, int free_count, PairDistances distances)
      : kept(first, second, free_count, distances) {}

  KeptPairs kept;
  ContactList found{};
};

SurfacePairs::SurfacePairs(Surface surface, int free_count, PairDistances distances)
    : SurfacePairs(std::move(surface), {}, free_count, distances) {}

SurfacePairs::SurfacePairs(Surface first, Surface second, int free_count, PairDistances distances) {
  if (first.triangles.empty()) throw std::invalid_argument("a surface has no triangles, expected some");
  parts_ = std::make_unique<Parts>(first, second, free_count, distances);
}

SurfacePairs::~SurfacePairs() = default;
SurfacePairs::SurfacePairs(SurfacePairs&&) noexcept = default;
SurfacePairs& SurfacePairs::operator=(SurfacePairs&&) noexcept = default;

const PairCounts& SurfacePairs::counts() const { return parts_->kept.counts(); }

std::span<const SurfaceContact> SurfacePairs::proximities(PlaceList x, double distance) {
  return step(x, x, distance).proximities;
}

std::span<const SurfaceContact> SurfacePairs::collisions(PlaceList x0, PlaceList x1) {
  return step(x0, x1, 0).collisions;
}

StepContacts SurfacePairs::step(PlaceList x0, PlaceList x1, double distance) {
  Parts& p = *parts_;
  if (!(distance >= 0 && distance <= p.kept.distances().reach))
    throw std::invalid_argument("proximities at " + std::to_string(distance) +
                                " m, expected at most the reach, " +
                                std::to_string(p.kept.distances().reach) + " m");
  p.found.clear();
  p.kept.cover(x0, x1);
  const bool moves = x0.data() != x1.data();
  p.kept.for_each(x0, x1, distance, [&](PairKind kind, const auto& particles, KeptPair& kept, bool may_meet) {
    const FourPlaces at = places_of(particles, x1);
    const ClosestPlaces closest = closest_places(kind, at);
    const Eigen::Vector3d n = direction_between(kind, at, closest);
    kept.normal = n.cast<float>();
    if (closest.difference.squaredNorm() <= distance * distance) {
      const Eigen::Vector3d normal = n.isZero(0) ? normal_of_touch(kind, at) : n;
      p.found.add(false, kind, kept, {particles, closest.weights, normal, normal.dot(closest.difference), 0});
    }
    if (!moves || !may_meet) return;
    if (const auto impact = first_impact(kind, places_of(particles, x0), at))
      p.found.add(true, kind, kept,
                  {particles, impact->places.weights, impact->normal,
                   impact->normal.dot(impact->places.difference), impact->time});
  });
  return p.found.sorted();
}

}  // namespace springstab
