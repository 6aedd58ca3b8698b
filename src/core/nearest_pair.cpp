#include "organ_collision/core/nearest_pair.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "organ_collision/core/sign.h"

namespace organ_collision::core {
namespace {

/// A triangle of the first surface, as the second sees it.
struct Candidate {
  double bound;  // [m^2] its box to the second's
  TriangleId id;
  Triangle triangle;
};

std::vector<Candidate> nearestFirst(const CollisionMesh& first, const Eigen::Isometry3d& pose,
                                    const Box& second) {
  std::vector<Candidate> candidates;
  candidates.reserve(first.mesh().triangleCount());
  for (std::size_t i = 0; i < first.mesh().triangleCount(); ++i) {
    const auto id = static_cast<TriangleId>(i);
    const auto [a, b, c] = first.mesh().triangle(id);
    const Triangle triangle = {pose * a, pose * b, pose * c};
    candidates.push_back({squaredDistance(boxOf(triangle), second), id, triangle});
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& left, const Candidate& right) { return left.bound < right.bound; });
  return candidates;
}

/// Of the answer without its sign.
NearestTriangle unsignedOf(NearestTriangle nearest) {
  if (nearest.distance >= 0.0) return nearest;
  nearest.upper_bound = -nearest.lower_bound;
  nearest.lower_bound = nearest.distance = -nearest.distance;
  return nearest;
}

bool holds(const CollisionMesh& solid, const Eigen::Vector3d& point) {
  return solid.health().isSolid() && windingNumber(solid, point) != 0;
}

/// For surfaces that do not meet: one is wholly inside the other's solid.
bool isOneInsideTheOther(const CollisionMesh& first, const Eigen::Isometry3d& second_from_first,
                         const CollisionMesh& second) {
  const Eigen::Vector3d of_first = first.mesh().triangle(TriangleId{0}).a;
  const Eigen::Vector3d of_second = second.mesh().triangle(TriangleId{0}).a;
  return holds(second, second_from_first * of_first) ||
         holds(first, second_from_first.inverse() * of_second);
}

NearestTriangle withSign(NearestTriangle nearest, bool inside) {
  nearest.distance_signed = true;
  if (!inside) return nearest;
  nearest.distance = -nearest.distance;
  nearest.upper_bound = -nearest.lower_bound;
  nearest.lower_bound = nearest.distance;
  return nearest;
}

}  // namespace

NearestPair nearestPair(const CollisionMesh& first, const Eigen::Isometry3d& second_from_first,
                        const CollisionMesh& second, const Accuracy& accuracy) {
  std::optional<NearestPair> best;
  double lower_bound = std::numeric_limits<double>::infinity();
  SearchWork work;
  for (const Candidate& candidate : nearestFirst(first, second_from_first, second.health().box)) {
    if (best && std::sqrt(candidate.bound) > best->nearest.distance) break;
    const NearestTriangle nearest =
        unsignedOf(nearestTriangle(second, candidate.triangle, accuracy));
    lower_bound = std::min(lower_bound, nearest.lower_bound);
    work.bounds += nearest.work.bounds + 1;
    work.triangles += nearest.work.triangles;
    if (!best || nearest.distance < best->nearest.distance) best = {candidate.id, nearest};
    if (best->nearest.distance == 0.0) break;
  }
  best->nearest.lower_bound = std::min(lower_bound, best->nearest.distance);
  best->nearest.work = work;
  best->nearest.distance_signed = false;
  const bool may_hold = first.health().isSolid() || second.health().isSolid();
  const bool apart_or_touching = best->nearest.lower_bound > 0.0 || best->nearest.isExact();
  if (may_hold && apart_or_touching) {
    best->nearest =
        withSign(best->nearest, best->nearest.lower_bound > 0.0 &&
                                    isOneInsideTheOther(first, second_from_first, second));
  }
  return *best;
}

}  // namespace organ_collision::core
