#include "organ_collision/core/contact.h"

namespace organ_collision::core {
namespace {

Eigen::Vector3d moved(const Eigen::Vector3d& point, const Eigen::Isometry3d& pose) {
  return pose * point;
}

Triangle moved(const Triangle& triangle, const Eigen::Isometry3d& pose) {
  return {pose * triangle.a, pose * triangle.b, pose * triangle.c};
}

}  // namespace

Tip transformed(const Tip& tip, const Eigen::Isometry3d& target_from_tip) {
  return std::visit([&](const auto& shape) -> Tip { return moved(shape, target_from_tip); }, tip);
}

Contact contact(const CollisionMesh& organ, const Tip& tip, const Accuracy& accuracy) {
  const NearestTriangle nearest =
      std::visit([&](const auto& shape) { return nearestTriangle(organ, shape, accuracy); }, tip);
  const bool colliding = nearest.distance <= 0.0;
  // Off the surface for certain, an open organ is off; of a solid one the sign decides.
  const bool clear = !organ.health().isSolid() && nearest.lower_bound > 0.0;
  return {nearest, colliding, colliding || nearest.distance_signed || clear};
}

}  // namespace organ_collision::core
