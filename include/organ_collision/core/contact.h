#pragma once

#include <Eigen/Geometry>
#include <variant>

#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::core {

/// An instrument's tip: a point, or a triangle as in the paper [m].
using Tip = std::variant<Eigen::Vector3d, Triangle>;

/// The tip in another frame.
Tip transformed(const Tip& tip, const Eigen::Isometry3d& target_from_tip);

/// How a tip stands to an organ.
struct Contact {
  NearestTriangle nearest;
  bool colliding;  ///< tip and organ (its solid, or its surface where it is open) have a point in
                   ///< common
  bool colliding_certain;  ///< false where the accuracy asked for does not decide it
};

/// `tip` is in the organ's frame. Throws as nearestTriangle() does.
Contact contact(const CollisionMesh& organ, const Tip& tip, const Accuracy& accuracy = {});

}  // namespace organ_collision::core
