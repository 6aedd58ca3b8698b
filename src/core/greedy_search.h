#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/descent.h"
#include "organ_collision/core/collision_mesh.h"

namespace organ_collision::core {

/// Where the paper's search leads: go to the child whose pole is nearer to `tip` [m], of equally
/// near ones to the second, until one triangle is left. Only where the rounding of single precision
/// could decide wrongly, the poles of the mesh are measured. O(depth). Source: Muñoz, Diaz León,
/// Trefftz, Quid 19 (2012), algorithm 2.
struct GreedyPath {
  FarthestPairTree::Leaf end;
  std::uint32_t splits;  ///< on the way
};
GreedyPath greedySearch(const CollisionMesh& organ, const Eigen::Vector3d& tip);

/// How the search sets out in single precision.
Descent descentTo(const CollisionMesh& organ, const Eigen::Vector3d& tip);

}  // namespace organ_collision::core
