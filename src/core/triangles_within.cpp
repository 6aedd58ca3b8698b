#include "organ_collision/core/triangles_within.h"

#include <algorithm>
#include <cmath>

#include "core/for_each_leaf.h"
#include "organ_collision/core/box.h"
#include "organ_collision/core/closest_point.h"
#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::core {
namespace {

bool isBefore(const TriangleAtDistance& left, const TriangleAtDistance& right) {
  if (left.distance != right.distance) return left.distance < right.distance;
  return left.triangle < right.triangle;
}

/// Of the coordinates: more than the 4*u*extent of exact distances and u to move to the unit frame.
constexpr double kRounding = 0x1p-48;

/// Calls `look_at(leaf)` for all triangles but those of boxes that are farther than `radius` [m].
template <class LookAt>
void forEachNear(const WideTree& tree, const Eigen::Vector3d& point, double radius,
                 const LookAt& look_at) {
  const Eigen::Vector3d unit_point = tree.frame()(point);
  constexpr double kLargestOfTree = 8.0;  // the sum of three, each below 2
  const double coordinates = unit_point.lpNorm<1>() + kLargestOfTree;
  const double reach = radius * tree.frame().scale + kRounding * coordinates;
  const auto is_near = [&, all = !(coordinates < kBeyond)](const Box& box) {
    return all || std::sqrt(squaredDistance(box, unit_point)) <= reach;
  };
  forEachLeaf(tree, is_near, look_at);
}

}  // namespace

TrianglesWithin trianglesWithin(const CollisionMesh& organ, const Eigen::Vector3d& point,
                                double radius, std::size_t max_results) {
  requireUsable(point, "point", 0);
  if (!std::isfinite(radius) || radius < 0.0) refuseNegative("radius", radius);
  TrianglesWithin within{{}, true};
  forEachNear(organ.wideTree(), point, radius, [&](FarthestPairTree::Leaf leaf) {
    const TriangleId id = organ.tree().triangle(leaf);
    const Triangle triangle = organ.mesh().triangle(id);
    if (std::sqrt(squaredDistance(boxOf(triangle), point)) > radius) return;
    const double distance = std::sqrt(closestPointOnTriangle(point, triangle).squared_distance);
    if (distance <= radius) within.triangles.push_back({id, distance});
  });
  std::sort(within.triangles.begin(), within.triangles.end(), isBefore);
  if (max_results != 0 && within.triangles.size() > max_results) {
    within.triangles.resize(max_results);
    within.complete = false;
  }
  return within;
}

}  // namespace organ_collision::core
