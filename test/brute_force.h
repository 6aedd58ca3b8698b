#pragma once

#include <limits>

#include "organ_collision/core/closest_point.h"
#include "organ_collision/core/triangle_distance.h"
#include "organ_collision/core/triangle_mesh.h"

// What every search must agree with: all triangles, one by one.
namespace organ_collision::test {

inline double squaredDistanceByBruteForce(const core::TriangleMesh& mesh,
                                          const Eigen::Vector3d& tip) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const core::Triangle triangle = mesh.triangle(static_cast<core::TriangleId>(i));
    least = std::min(least, core::closestPointOnTriangle(tip, triangle).squared_distance);
  }
  return least;
}

inline double squaredDistanceByBruteForce(const core::TriangleMesh& mesh,
                                          const core::Triangle& tip) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const core::Triangle triangle = mesh.triangle(static_cast<core::TriangleId>(i));
    least = std::min(least, core::closestPoints(tip, triangle).on_second.squared_distance);
  }
  return least;
}

}  // namespace organ_collision::test
