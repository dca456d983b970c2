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
  std::vector<SurfaceContact> found{};
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
  Parts& p = *parts_;
  if (!(distance >= 0 && distance <= p.kept.distances().reach))
    throw std::invalid_argument("proximities at " + std::to_string(distance) +
                                " m, expected at most the reach, " +
                                std::to_string(p.kept.distances().reach) + " m");
  p.found.clear();
  p.kept.cover(x, x);
  p.kept.for_each(x, x, distance, [&](PairKind kind, const std::array<int, 4>& particles, KeptPair& kept) {
    const FourPlaces at = places_of(particles, x);
    const ClosestPlaces closest = closest_places(kind, at);
    const Eigen::Vector3d n = direction_between(kind, at, closest);
    kept.normal = n.cast<float>();
    if (closest.difference.squaredNorm() > distance * distance) return;
    const Eigen::Vector3d normal = n.isZero(0) ? normal_of_touch(kind, at) : n;
    p.found.push_back({particles, closest.weights, normal, normal.dot(closest.difference), 0, kind});
  });
  return p.found;
}

std::span<const SurfaceContact> SurfacePairs::collisions(PlaceList x0, PlaceList x1) {
  Parts& p = *parts_;
  p.found.clear();
  p.kept.cover(x0, x1);
  p.kept.for_each(x0, x1, 0, [&](PairKind kind, const std::array<int, 4>& particles, KeptPair&) {
    const auto impact = first_impact(kind, places_of(particles, x0), places_of(particles, x1));
    if (!impact) return;
    p.found.push_back({particles, impact->places.weights, impact->normal,
                       impact->normal.dot(impact->places.difference), impact->time, kind});
  });
  return p.found;
}

}  // namespace springstab
