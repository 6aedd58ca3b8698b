#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "organ_collision/core/closest_point.h"
#include "organ_collision/core/collision_mesh.h"

namespace organ_collision::core {

enum class Side : std::uint8_t { kOutside, kInside };

/// The unit outward pseudonormal at a feature of a triangle: of a face its normal, of an edge or
/// vertex the mean of the normals around it, weighted by their angles. Zero where only zero-area
/// triangles meet or the normals cancel. Source: J. Bærentzen and H. Aanæs, "Signed distance
/// computation using the angle weighted pseudonormal" (2005).
Eigen::Vector3d pseudonormal(const CollisionMesh& organ, TriangleId triangle, Feature feature);

/// How often the surface winds around a point that is not on it: exact, by counting the crossings
/// of the ray from the point along +x, degenerate ones included. Not 0: inside. REQUIRES:
/// organ.health().isSolid().
int windingNumber(const CollisionMesh& organ, const Eigen::Vector3d& point);

/// A pseudonormal, and what it is worth.
struct SurfaceNormal {
  Eigen::Vector3d direction;  ///< as pseudonormal() gives it
  bool is_clear;              ///< rounding could not turn it, and it tells inside from outside
};
SurfaceNormal surfaceNormal(const CollisionMesh& organ, TriangleId triangle, Feature feature);

/// Whether a feature of each of two triangles is one and the same edge or vertex, but for welds.
bool isSameFeature(const MeshTopology& topology, const Corners& one, Feature of_one,
                   const Corners& other, Feature of_other);

/// The side of the organ on which a point is; none where the organ is no solid. `closest` must be
/// the point of the organ exactly nearest to `point`, `normal` the surface's there; not clear where
/// another feature, of other triangles, is as near but for rounding: it may be the one that is
/// nearest. The side is told by the normal where it is clear and the point is not too near, else by
/// the winding number.
std::optional<Side> sideOf(const CollisionMesh& organ, const Eigen::Vector3d& point,
                           const ClosestPoint& closest, const SurfaceNormal& normal);

/// The normal, turned if it clearly leads inwards: a part of the surface may be inside out by
/// itself. REQUIRES: as for sideOf(); `side` is that of the point.
Eigen::Vector3d outwardNormal(const CollisionMesh& organ, const ClosestPoint& closest,
                              const SurfaceNormal& normal, Side side);

}  // namespace organ_collision::core
