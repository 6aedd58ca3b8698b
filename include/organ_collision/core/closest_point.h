#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "organ_collision/core/triangle.h"

namespace organ_collision::core {

/// The part of a triangle that a closest point lies on.
enum class Feature : std::uint8_t {
  kVertexA,
  kVertexB,
  kVertexC,
  kEdgeAB,
  kEdgeBC,
  kEdgeCA,
  kFace
};

/// The point of a triangle closest to a query.
struct ClosestPoint {
  Eigen::Vector3d point;        ///< [m] in the triangle's frame
  Eigen::Vector3d offset;       ///< [m] from the query, free of the cancellation in point - query
  Eigen::Vector3d barycentric;  ///< weights of a, b, c in [0, 1], 0 off the feature; sum about 1
  Feature feature;
  double squared_distance;  ///< [m^2] squaredLength(offset)
};

/// The point of the triangle a, b, c closest to `query` [m], the same for every order of the
/// corners. Zero-area triangles are the segment or the point that they are, decided exactly: they
/// have no face.
///
/// The computed root of squared_distance is within 4*u*extent of the distance, for needles, caps
/// and mixed scales alike (u = 2^-53, extent = longest vector from the query to a corner; measured:
/// docs/stability.md).
/// Input below kLargestCoordinate never gives NaN. Scaling it by a power of two scales the answer
/// and changes no other bit, unless a square underflows (distances below 1e-150 m). `offset` lies
/// within the box of the corners relative to the query, rounded: no box bound on a set of
/// triangles, computed in the same arithmetic, can exceed the distance returned here.
///
/// Cost: some 25 ns where a point inside is nearest, half as much at a corner, nearly twice as much
/// on an edge (benchmark/triangle_benchmark).
/// Source: three clamped segments and a face candidate; W. Kahan, "Mathematics written in sand"
/// (1983), for the difference of products.
ClosestPoint closestPointOnTriangle(const Eigen::Vector3d& query, const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b, const Eigen::Vector3d& c);
inline ClosestPoint closestPointOnTriangle(const Eigen::Vector3d& query, const Triangle& triangle) {
  return closestPointOnTriangle(query, triangle.a, triangle.b, triangle.c);
}

/// True only if closestPointOnTriangle() gives the corner that is `offset` [m] from the query,
/// where these edges [m] start. A quick test, which may be false though it does.
bool isClosestCorner(const Eigen::Vector3d& offset, const Eigen::Vector3d& edge,
                     const Eigen::Vector3d& other_edge);

/// True only if closestPointOnTriangle() gives `closest`, which it gave of a triangle that has the
/// edge from `start` to `end` [m] and is nearest inside that, also of one that has `corner` [m]
/// besides: bit for bit, but for the order of the weights. A quick test, which may be false though
/// it does.
bool isClosestOnEdge(const Eigen::Vector3d& query, const ClosestPoint& closest,
                     const Eigen::Vector3d& start, const Eigen::Vector3d& end,
                     const Eigen::Vector3d& corner);

/// How far [m] the query may move, wherever to, and isClosestCorner() still says so. REQUIRES: it
/// does.
double roomAtClosestCorner(const Eigen::Vector3d& offset, const Eigen::Vector3d& edge,
                           const Eigen::Vector3d& other_edge);

}  // namespace organ_collision::core
