#pragma once

#include <Eigen/Geometry>

#include "organ_collision/core/nearest_pair.h"

namespace organ_collision::core {

/// Adds what the solids tell: the sign where it is proven.
NearestPair withSign(const CollisionMesh& first, const Eigen::Isometry3d& second_from_first,
                     const CollisionMesh& second, NearestPair pair);

}  // namespace organ_collision::core
