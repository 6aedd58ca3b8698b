#include "organ_collision/core/proximity.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/perhaps_inside.h"
#include "core/unit_vector.h"
#include "organ_collision/core/contact.h"
#include "organ_collision/core/nearest_pair.h"
#include "organ_collision/core/triangle_distance.h"

namespace organ_collision::core {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Unit, from the first core to the second; where they cross, perpendicular to both axes; zero
/// where two points are one.
Vector3d direction(const ClosestPair& pair, const Triangle& first, const Triangle& second) {
  const Vector3d& offset = pair.on_second.offset;
  if (!offset.isZero(0.0)) return unit(offset);
  const Vector3d along_first = unit(first.b - first.a);
  const Vector3d along_second = unit(second.b - second.a);
  Vector3d across = unit(accurateCross(along_first, along_second));
  if (!across.isZero(0.0)) return across;
  const Vector3d& along = along_first.isZero(0.0) ? along_second : along_first;
  return along.isZero(0.0) ? along : along.unitOrthogonal();
}

Proximity betweenRounds(const RoundShape& first, const RoundShape& second) {
  const ClosestPair pair = closestPoints(first.core, second.core);
  const Vector3d normal = direction(pair, first.core, second.core);
  const double distance =
      std::sqrt(pair.on_second.squared_distance) - (first.radius + second.radius);
  return {pair.point_on_first + first.radius * normal,
          pair.on_second.point - second.radius * normal,
          normal,
          distance,
          distance,
          distance,
          distance <= 0.0,
          true,
          std::nullopt,
          std::nullopt,
          {}};
}

/// With a lower bound that holds wherever one is, if one of the two is solid.
NearestTriangle perhapsInside(NearestTriangle nearest, double radius, bool is_any_solid) {
  if (is_any_solid) nearest.lower_bound = lowerBoundIfInside(nearest, radius);
  return nearest;
}

/// `nearest` is of the second, a mesh; `radius` has been taken off it.
Proximity toMesh(const NearestTriangle& nearest, double radius, bool colliding_certain,
                 const Isometry3d& frame_from_mesh) {
  const Vector3d& offset = nearest.closest.offset;
  const double of_core = nearest.distance + radius;  // 0 where it is lost beside the radius
  const bool inside =
      of_core < 0.0 ||
      (of_core == 0.0 && offset.dot(nearest.closest.point - nearest.tip_point) > 0.0);
  Vector3d normal = (inside ? -1.0 : 1.0) * unit(offset);
  // Where the core crosses the surface, both points are as far apart as the radius reaches.
  if (normal.isZero(0.0)) normal = unit(nearest.tip_point - nearest.closest.point);
  if (normal.isZero(0.0)) normal = -nearest.normal;
  return transformed({nearest.tip_point, nearest.closest.point, normal, nearest.distance,
                      nearest.lower_bound, nearest.upper_bound, nearest.distance <= 0.0,
                      colliding_certain, std::nullopt, nearest.triangle, nearest.work},
                     frame_from_mesh);
}

Proximity roundToMesh(const Shape& round, const RigidMesh& mesh, const Accuracy& accuracy) {
  const Contact found = contact(
      *mesh.surface, transformed(round, Isometry3d(mesh.pose.inverse(Eigen::Affine))), accuracy);
  const double radius = roundShape(round)->radius;
  return toMesh(perhapsInside(found.nearest, radius, mesh.surface->health().isSolid()), radius,
                found.colliding_certain, mesh.pose);
}

Proximity betweenMeshes(const RigidMesh& first, const RigidMesh& second, const NearestPair& pair) {
  const NearestTriangle nearest = perhapsInside(
      pair.nearest, 0.0, first.surface->health().isSolid() || second.surface->health().isSolid());
  const bool certain = nearest.distance <= 0.0 || nearest.lower_bound > 0.0;
  Proximity proximity = toMesh(nearest, 0.0, certain, second.pose);
  proximity.triangle_of_first = pair.triangle_of_first;
  return proximity;
}

/// `nearest_pair(second_from_first)` finds those of two meshes.
template <class FindPair>
Proximity between(const Shape& first, const Shape& second, const Accuracy& accuracy,
                  const FindPair& nearest_pair) {
  requireUsable(first);
  requireUsable(second);
  const auto* first_mesh = std::get_if<RigidMesh>(&first);
  const auto* second_mesh = std::get_if<RigidMesh>(&second);
  if (first_mesh != nullptr && second_mesh != nullptr) {
    return betweenMeshes(
        *first_mesh, *second_mesh,
        nearest_pair(*first_mesh, second_mesh->pose.inverse(Eigen::Affine) * first_mesh->pose,
                     *second_mesh));
  }
  if (second_mesh != nullptr) return roundToMesh(first, *second_mesh, accuracy);
  if (first_mesh != nullptr) return swapped(roundToMesh(second, *first_mesh, accuracy));
  return betweenRounds(*roundShape(first), *roundShape(second));
}

}  // namespace

Proximity proximity(const Shape& first, const Shape& second, const Accuracy& accuracy) {
  requireUsable(accuracy);
  return between(
      first, second, accuracy,
      [&](const RigidMesh& one, const Isometry3d& other_from_one, const RigidMesh& other) {
        return nearestPair(*one.surface, other_from_one, *other.surface, accuracy);
      });
}

Proximity ProximityTracker::proximity(const Shape& first, double travel_of_first,
                                      const Shape& second, double travel_of_second,
                                      const Accuracy& accuracy) {
  // Who asks for a number of leaves is to get what they find, not more.
  if (accuracy.max_leaves != 0) return core::proximity(first, second, accuracy);
  requireUsable(accuracy);
  return between(
      first, second, accuracy,
      [&](const RigidMesh& one, const Isometry3d& other_from_one, const RigidMesh& other) {
        return pair_.nearestPair(*one.surface, travel_of_first, other_from_one, *other.surface,
                                 travel_of_second);
      });
}

Proximity swapped(const Proximity& proximity) {
  Proximity result = proximity;
  std::swap(result.point_on_first, result.point_on_second);
  std::swap(result.triangle_of_first, result.triangle_of_second);
  result.normal = -result.normal;
  return result;
}

Proximity transformed(Proximity proximity, const Isometry3d& target_from_source) {
  proximity.point_on_first = target_from_source * proximity.point_on_first;
  proximity.point_on_second = target_from_source * proximity.point_on_second;
  proximity.normal = target_from_source.linear() * proximity.normal;
  return proximity;
}

Proximity united(const Proximity& one, const Proximity& other) {
  Proximity nearer = other.distance < one.distance ? other : one;
  nearer.lower_bound = std::min(one.lower_bound, other.lower_bound);
  nearer.upper_bound = std::min(one.upper_bound, other.upper_bound);
  nearer.colliding = one.colliding || other.colliding;
  nearer.colliding_certain = nearer.colliding || (one.colliding_certain && other.colliding_certain);
  nearer.work = one.work;
  nearer.work += other.work;
  return nearer;
}

}  // namespace organ_collision::core
