#include "organ_collision/core/triangles_within.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "organ_collision/core/box.h"
#include "organ_collision/core/closest_point.h"

namespace organ_collision::core {
namespace {

bool isBefore(const TriangleAtDistance& left, const TriangleAtDistance& right) {
  if (left.distance != right.distance) return left.distance < right.distance;
  return left.triangle < right.triangle;
}

}  // namespace

TrianglesWithin trianglesWithin(const CollisionMesh& organ, const Eigen::Vector3d& point,
                                double radius, std::size_t max_results) {
  requireUsable(point, "point", 0);
  if (!std::isfinite(radius) || radius < 0.0) {
    throw std::invalid_argument("radius is " + std::to_string(radius) +
                                ": it must be finite and >= 0");
  }
  TrianglesWithin within{{}, true};
  for (std::size_t i = 0; i < organ.mesh().triangleCount(); ++i) {
    const auto id = static_cast<TriangleId>(i);
    const Triangle triangle = organ.mesh().triangle(id);
    if (std::sqrt(squaredDistance(boxOf(triangle), point)) > radius) continue;
    const double distance = std::sqrt(closestPointOnTriangle(point, triangle).squared_distance);
    if (distance <= radius) within.triangles.push_back({id, distance});
  }
  std::sort(within.triangles.begin(), within.triangles.end(), isBefore);
  if (max_results != 0 && within.triangles.size() > max_results) {
    within.triangles.resize(max_results);
    within.complete = false;
  }
  return within;
}

}  // namespace organ_collision::core
