#include "organ_collision/core/nearest_pair.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "core/nearest_pair_search.h"
#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::core {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

double stretchOf(const Matrix3d& linear) {
  return (linear.transpose() * linear - Matrix3d::Identity()).norm();
}

void requireRigid(const Isometry3d& pose) {
  constexpr double kMost = 0x1p-4;  // more than tf lets pass
  const double stretch = stretchOf(pose.linear());
  if (!(stretch <= kMost))
    throw std::invalid_argument("a pose stretches squared lengths by " + std::to_string(stretch) +
                                ": it must be rigid");
  requireUsable(pose.translation(), "translation", 0);
}

double poseRounding(const CollisionMesh& first, const Isometry3d& second_from_first,
                    const CollisionMesh& second) {
  constexpr double kRounding = 0x1p-47;  // of coordinates: 3 products and sums, there and back
  const UnitFrame& from = first.wideTree().frame();
  const UnitFrame& to = second.wideTree().frame();
  return kRounding *
         (from.centre.lpNorm<1>() + to.centre.lpNorm<1>() +
          second_from_first.translation().lpNorm<1>() + 8.0 / from.scale + 8.0 / to.scale);
}

AffineMap affineMap(const Matrix3d& linear, const Vector3d& offset) {
  AffineMap map = {};
  for (int row = 0; row < 3; ++row) {
    map.offset[row] = offset[row];
    for (int column = 0; column < 3; ++column) map.linear[row][column] = linear(row, column);
  }
  return map;
}

std::vector<WaitingPair>& pairScratch(std::size_t levels) {
  thread_local std::vector<WaitingPair> stack;
  // Opening a pair takes it from the stack and puts up to 64 there.
  const std::size_t room = 1 + (kLaneCount * kLaneCount - 1) * levels;
  if (stack.size() < room) stack.resize(room);
  return stack;
}

namespace {

/// Where a part of `other`, told by one of its vertices, is: its neighbour farthest from the
/// surface of the solid, as rounding may take what almost touches it to its other side.
Vector3d clearOfSurface(const CollisionMesh& solid, const CollisionMesh& other,
                        const Isometry3d& solid_from_other, VertexId vertex) {
  Vector3d clear = solid_from_other * other.mesh().position(vertex);
  double farthest = 0.0;
  for (const TriangleId triangle : other.topology().trianglesAt(other.topology().weld(vertex))) {
    for (const VertexId corner : other.mesh().triangles()[index(triangle)]) {
      const Vector3d place = solid_from_other * other.mesh().position(corner);
      const double distance = nearestTriangle(solid, place, {}, Sign::kNone).distance;
      if (!(distance > farthest)) continue;
      farthest = distance;
      clear = place;
    }
  }
  return clear;
}

/// For surfaces that do not meet, but may almost touch: a part of `other` that hangs together is
/// inside the solid.
bool holdsPartOf(const CollisionMesh& solid, const CollisionMesh& other,
                 const Isometry3d& solid_from_other, bool almost_touch) {
  if (!solid.health().isSolid()) return false;
  const std::vector<VertexId>& parts = other.topology().parts();
  return std::any_of(parts.begin(), parts.end(), [&](VertexId vertex) {
    return windingNumber(solid, almost_touch
                                    ? clearOfSurface(solid, other, solid_from_other, vertex)
                                    : solid_from_other * other.mesh().position(vertex)) != 0;
  });
}

/// The same: one, or a part of it, is inside the other's solid.
bool isOneInsideTheOther(const CollisionMesh& first, const Isometry3d& second_from_first,
                         const CollisionMesh& second, double distance) {
  const bool almost_touch = distance <= 2 * poseRounding(first, second_from_first, second);
  return holdsPartOf(second, first, second_from_first, almost_touch) ||
         holdsPartOf(first, second, Isometry3d(second_from_first.inverse(Eigen::Affine)),
                     almost_touch);
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

NearestPair withSign(const CollisionMesh& first, const Isometry3d& second_from_first,
                     const CollisionMesh& second, NearestPair pair) {
  const bool may_hold = first.health().isSolid() || second.health().isSolid();
  const bool apart = pair.nearest.lower_bound > 0.0;
  if (may_hold && (apart || pair.nearest.isExact())) {
    const bool inside =
        apart && isOneInsideTheOther(first, second_from_first, second, pair.nearest.lower_bound);
    pair.nearest = withSign(pair.nearest, inside);
  }
  return pair;
}

NearestPair nearestPair(const CollisionMesh& first, const Isometry3d& second_from_first,
                        const CollisionMesh& second, const Accuracy& accuracy) {
  requireUsable(accuracy);
  requireRigid(second_from_first);
  return withSign(first, second_from_first, second,
                  NearestPairSearch(first, second_from_first, second, accuracy).run());
}

}  // namespace organ_collision::core
