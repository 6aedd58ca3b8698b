#include "organ_collision/core/nearest_triangle.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "core/nearest_search.h"
#include "organ_collision/core/sign.h"

namespace organ_collision::core {

WaitingSets scratch(std::size_t depth) {
  thread_local std::vector<float> squares;
  thread_local std::vector<std::uint32_t> sets;
  // Opening a node takes one set from the stack, and writes eight there.
  const std::size_t room = 2 + kLaneCount + (kLaneCount - 1) * depth;
  if (squares.size() < room) {
    squares.resize(room);
    sets.resize(room);
  }
  return {squares.data(), sets.data()};
}

NearestTriangle withSign(const CollisionMesh& organ, const NearestTriangle& nearest) {
  return withSign(organ, nearest, surfaceNormal(organ, nearest.triangle, nearest.closest.feature));
}

NearestTriangle withSign(const CollisionMesh& organ, NearestTriangle nearest,
                         const SurfaceNormal& normal) {
  nearest.normal = normal.direction;
  if (nearest.upper_bound == 0.0) {  // of 0 both signs are right
    nearest.distance_signed = organ.health().isSolid();
    return nearest;
  }
  if (!nearest.isExact() && organ.health().box.contains(nearest.tip_point)) return nearest;
  const std::optional<Side> side = sideOf(organ, nearest.tip_point, nearest.closest, normal);
  nearest.distance_signed = side.has_value();
  if (side == Side::kInside) {
    nearest.distance = -nearest.distance;
    nearest.upper_bound = -nearest.lower_bound;
    nearest.lower_bound = nearest.distance;
  }
  return nearest;
}

void requireUsable(const Accuracy& accuracy) {
  const auto require = [](double value, const char* name) {
    if (std::isfinite(value) && value >= 0.0) return;
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) +
                                ": it must be finite and >= 0");
  };
  require(accuracy.max_relative_error, "max_relative_error");
  require(accuracy.max_absolute_error, "max_absolute_error");
}

NearestTriangle nearestTriangle(const CollisionMesh& organ, const Eigen::Vector3d& tip,
                                const Accuracy& accuracy) {
  requireUsable(tip, "tip", 0);
  requireUsable(accuracy);
  return withSign(organ, NearestSearch<PointTip>(organ, PointTip(tip), accuracy).run());
}

NearestTriangle nearestTriangle(const CollisionMesh& organ, const Triangle& tip,
                                const Accuracy& accuracy) {
  for (const Eigen::Vector3d* corner : {&tip.a, &tip.b, &tip.c}) requireUsable(*corner, "tip", 0);
  requireUsable(accuracy);
  return withSign(organ, NearestSearch<TriangleTip>(organ, TriangleTip(tip), accuracy).run());
}

}  // namespace organ_collision::core
