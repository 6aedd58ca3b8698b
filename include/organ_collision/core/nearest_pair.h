#pragma once

#include <Eigen/Geometry>

#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::core {

/// The nearest triangles of two surfaces.
struct NearestPair {
  TriangleId triangle_of_first;
  NearestTriangle nearest;  ///< of the second, in its frame; tip_point is the first's point
};

/// The nearest triangles of two surfaces, with the proof of how wrong that may be. The distance is
/// 0 where the surfaces meet, and negative where they do not and one is inside the other's solid.
/// All limits of `accuracy` hold but max_leaves, which each triangle of the first has for itself.
/// Cost: a search for each triangle of `first` whose box is near enough: give the smaller mesh
/// first. Throws std::invalid_argument for an accuracy or a pose that is not usable.
NearestPair nearestPair(const CollisionMesh& first, const Eigen::Isometry3d& second_from_first,
                        const CollisionMesh& second, const Accuracy& accuracy = {});

}  // namespace organ_collision::core
