#include "solvers/contact/surface_pairs.h"

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

struct SurfacePairs::Parts {
  Parts(const Surface& first, const Surface& second, int free_count, PairDistances distances)
      : kept(first, second, free_count, distances) {}

  KeptPairs kept;
  std::vector<SurfaceContact> collisions{}, proximities{};
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
  p.collisions.clear();
  p.proximities.clear();
  p.kept.cover(x0, x1);
  const bool moves = x0.data() != x1.data();
  p.kept.for_each(x0, x1, distance, [&](PairKind kind, const auto& particles, KeptPair& kept, bool may_meet) {
    const FourPlaces at = places_of(particles, x1);
    const ClosestPlaces closest = closest_places(kind, at);
    const Eigen::Vector3d n = direction_between(kind, at, closest);
    kept.normal = n.cast<float>();
    if (closest.difference.squaredNorm() <= distance * distance) {
      const Eigen::Vector3d normal = n.isZero(0) ? normal_of_touch(kind, at) : n;
      p.proximities.push_back({particles, closest.weights, normal, normal.dot(closest.difference), 0, kind});
    }
    if (!moves || !may_meet) return;
    if (const auto impact = first_impact(kind, places_of(particles, x0), at))
      p.collisions.push_back({particles, impact->places.weights, impact->normal,
                              impact->normal.dot(impact->places.difference), impact->time, kind});
  });
  p.collisions.reserve(p.proximities.capacity());  // once for all
  return {p.collisions, p.proximities};
}

}  // namespace springstab
