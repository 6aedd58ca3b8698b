#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/kernels/descent.h"
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
inline Descent descentTo(const CollisionMesh& organ, const Eigen::Vector3d& tip) {
  /// What rounding makes of differences of squared distances from the poles of the mesh, of r and
  /// the reach of both.
  constexpr double kPoleRounding = 0x1p-46;
  const UnitFrame& frame = organ.wideTree().frame();
  const GreedyGuide& guide = organ.wideTree().guide();
  const Eigen::Vector3d unit_tip = frame(tip);
  const double reach = 1.0 + largestCoordinate(unit_tip);
  const double offset_of_mesh = largestCoordinate(frame.centre) * frame.scale;
  const Eigen::Vector3f place = unit_tip.cast<float>();
  [[gnu::tls_model("initial-exec")]] static thread_local LastWay last_way = {};
  return {guide.nodes.data(),
          organ.wideTree().packets().data(),
          guide.packets.data(),
          organ.wideTree().corners().data(),
          &last_way,
          {place.x(), place.y(), place.z()},
          static_cast<float>(reach),
          static_cast<float>(kPoleRounding * reach * (reach + offset_of_mesh))};
}

}  // namespace organ_collision::core
