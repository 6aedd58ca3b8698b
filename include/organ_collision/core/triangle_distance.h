#pragma once

#include "organ_collision/core/closest_point.h"

namespace organ_collision::core {

/// A nearest pair of points of two triangles.
struct ClosestPair {
  Eigen::Vector3d point_on_first;  ///< [m]
  ClosestPoint on_second;          ///< its query is point_on_first; squared_distance is 0 where the
                                   ///< triangles intersect
};

/// The nearest points of two triangles [m]: distance 0 and a common point where they intersect
/// (decided exactly), else the least of 6 vertex-face and 9 edge-edge distances. Zero-area
/// triangles are the segment or the point that they are.
///
/// The computed root of squared_distance is within 4*u*extent of the distance (u = 2^-53, extent =
/// longest vector between two of the six corners; measured: docs/stability.md), a common point
/// within 4*u*(extent + largest coordinate) of both triangles.
/// Never NaN, scales by powers of two like closestPointOnTriangle().
/// `on_second.offset` lies within the difference of the two triangles' boxes, rounded: no
/// box-to-box bound computed in the same arithmetic can exceed the distance returned here.
/// Cost: some 0.2 microseconds where they are apart, 0.8 where they meet
/// (benchmark/triangle_benchmark); more than 0.2 where it is not clear which parts are nearest.
/// Source: C. Ericson, "Real-Time Collision Detection" (2005), 5.1.9 and 5.1.11, but for what it
/// proves.
ClosestPair closestPoints(const Triangle& first, const Triangle& second);

}  // namespace organ_collision::core
