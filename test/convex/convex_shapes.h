#pragma once

#include <memory>

#include "io/primitive_mesh.h"
#include "organ_collision/core/collision_mesh.h"
#include "organ_collision/core/instrument.h"

// Convex shapes, and how well their proximity is found.
namespace organ_collision::convex {

constexpr double kSize = 1.0;          // [m] of what is asked about
constexpr double kGjk = 1e-6 * kSize;  // [m] how well GJK finds a distance of it
constexpr double kTight = 1e-8;        // [m] and how near the bounds are to each other

inline core::RigidMesh box(const Eigen::Vector3d& size,
                           const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) {
  return {std::make_shared<const core::CollisionMesh>(io::boxMesh(size)), pose, true};
}

inline core::RigidMesh cylinder(double radius, double length, const Eigen::Isometry3d& pose) {
  return {std::make_shared<const core::CollisionMesh>(io::prismMesh(radius, length, 32)), pose,
          true};
}

inline Eigen::Isometry3d at(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

}  // namespace organ_collision::convex
