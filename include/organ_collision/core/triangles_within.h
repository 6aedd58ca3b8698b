#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "organ_collision/core/collision_mesh.h"

namespace organ_collision::core {

/// A triangle and how far it is.
struct TriangleAtDistance {
  TriangleId triangle;
  double distance;  ///< [m] >= 0, inside too
};

struct TrianglesWithin {
  std::vector<TriangleAtDistance> triangles;  ///< nearest first; of equal distance by their numbers
  bool complete;                              ///< there are no others within the radius
};

/// The triangles with a point within `radius` [m] of `point`, at most `max_results` (0: all): the
/// nearest ones. Distances are those of closestPointOnTriangle(). Throws std::invalid_argument for
/// a point that is not usable, or a radius that is not finite or negative. Cost: about log n and
/// what is found, sorted.
TrianglesWithin trianglesWithin(const CollisionMesh& organ, const Eigen::Vector3d& point,
                                double radius, std::size_t max_results = 0);

}  // namespace organ_collision::core
