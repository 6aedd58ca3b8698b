#include "organ_collision/core/closest_point.h"

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <tuple>
#include <utility>

#include "organ_collision/core/box.h"
#include "organ_collision/core/predicates.h"
#include "plane_coordinates.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Squared sine of an angle, (16 u)^2: rounding makes angles of a few u where there is no area.
constexpr double kPerhapsFlat = 0x1p-98;

/// A corner of the triangle, as the query sees it.
struct Corner {
  Vector3d position;        ///< [m]
  Vector3d offset;          ///< [m] from the query
  double squared_distance;  ///< [m^2]
  int slot;                 ///< 0, 1, 2: it is a, b, c
};

using Corners3 = std::array<Corner, 3>;

/// A point of the triangle, reached by a step from one of its corners.
struct Candidate {
  const Corner* base;
  Vector3d step;            ///< [m]
  double squared_distance;  ///< [m^2]
  Vector3d barycentric;     ///< in the order of the triangle's corners
};

/// Ties are decided by coordinates, so that the order of the corners is forgotten.
bool isNearer(const Corner& left, const Corner& right) {
  if (left.squared_distance != right.squared_distance)
    return left.squared_distance < right.squared_distance;
  const Vector3d& p = left.position;
  const Vector3d& q = right.position;
  return std::tie(p.x(), p.y(), p.z()) < std::tie(q.x(), q.y(), q.z());
}

Corners3 nearestFirst(const Vector3d& query, const Triangle& triangle) {
  const auto corner = [&query](const Vector3d& position, int slot) {
    const Vector3d offset = position - query;
    return Corner{position, offset, squaredLength(offset), slot};
  };
  Corners3 corners{corner(triangle.a, 0), corner(triangle.b, 1), corner(triangle.c, 2)};
  if (isNearer(corners[1], corners[0])) std::swap(corners[0], corners[1]);
  if (isNearer(corners[2], corners[1])) std::swap(corners[1], corners[2]);
  if (isNearer(corners[1], corners[0])) std::swap(corners[0], corners[1]);
  return corners;
}

Candidate atCorner(const Corner& corner) {
  return {&corner, Vector3d::Zero(), corner.squared_distance, Vector3d::Unit(corner.slot)};
}

/// Steps to a point that is nearer than the best so far; false if it is not.
bool improve(Candidate& best, const Corner& base, const Vector3d& step) {
  const double squared_distance = squaredLength(base.offset + step);
  if (!(squared_distance < best.squared_distance)) return false;
  best = {&base, step, squared_distance, Vector3d::Zero()};
  return true;
}

/// The point nearest to the query between the corners, unless it is `nearer` itself.
void considerEdge(const Corner& nearer, const Corner& farther, Candidate& best) {
  const Vector3d edge = farther.position - nearer.position;
  const double t = -nearer.offset.dot(edge) / squaredLength(edge);
  if (!(t > 0 && t < 1) || !improve(best, nearer, t * edge)) return;
  best.barycentric[nearer.slot] = 1 - t;
  best.barycentric[farther.slot] = t;
}

/// False only where there is an area for sure.
bool isNarrow(const Vector3d& e1, const Vector3d& e2) {
  return squaredLength(e1.cross(e2)) <= kPerhapsFlat * squaredLength(e1) * squaredLength(e2);
}

/// The point nearest to the query, if that is inside the face.
void considerFace(const Corners3& corners, Candidate& best) {
  const auto& [base, left, right] = corners;  // the shortest way to go is the most accurate
  if (base.position == left.position || left.position == right.position) return;
  const Vector3d to_left = left.position - base.position;
  const Vector3d to_right = right.position - base.position;
  const std::optional<Vector2d> weights = planeCoordinates(-base.offset, to_left, to_right);
  if (!weights) return;
  const double s = weights->x();
  const double t = weights->y();
  const double rest = 1 - (s + t);
  if (!(s > 0 && t > 0 && rest > 0)) return;
  if (isNarrow(to_left, to_right) && collinear(base.position, left.position, right.position))
    return;
  if (!improve(best, base, s * to_left + t * to_right)) return;
  best.barycentric[base.slot] = rest;
  best.barycentric[left.slot] = s;
  best.barycentric[right.slot] = t;
}

Feature featureOf(const Vector3d& barycentric) {
  constexpr std::array<Feature, 8> kFeatures{Feature::kFace,   Feature::kVertexA, Feature::kVertexB,
                                             Feature::kEdgeAB, Feature::kVertexC, Feature::kEdgeCA,
                                             Feature::kEdgeBC, Feature::kFace};
  return kFeatures[(barycentric.x() > 0 ? 1U : 0U) | (barycentric.y() > 0 ? 2U : 0U) |
                   (barycentric.z() > 0 ? 4U : 0U)];
}

}  // namespace

ClosestPoint closestPointOnTriangle(const Vector3d& query, const Triangle& triangle) {
  const Corners3 corners = nearestFirst(query, triangle);
  Candidate best = atCorner(corners[0]);
  considerEdge(corners[0], corners[1], best);
  considerEdge(corners[0], corners[2], best);
  considerEdge(corners[1], corners[2], best);
  considerFace(corners, best);

  const Box seen = boxOf({corners[0].offset, corners[1].offset, corners[2].offset});
  const Box box = boxOf(triangle);
  ClosestPoint closest;
  closest.offset = (best.base->offset + best.step).cwiseMax(seen.low).cwiseMin(seen.high);
  closest.point = (best.base->position + best.step).cwiseMax(box.low).cwiseMin(box.high);
  closest.barycentric = best.barycentric;
  closest.feature = featureOf(best.barycentric);
  closest.squared_distance = squaredLength(closest.offset);
  return closest;
}

}  // namespace organ_collision::core
