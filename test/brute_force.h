#pragma once

#include <cstdint>
#include <limits>
#include <utility>

#include "organ_collision/core/closest_point.h"
#include "organ_collision/core/farthest_pair_tree.h"
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

/// Where the greedy search ends that measures the poles themselves, and after how many splits.
inline std::pair<core::FarthestPairTree::Leaf, std::uint32_t> greedyPath(
    const core::FarthestPairTree& tree, const core::TriangleMesh& mesh,
    const Eigen::Vector3d& tip) {
  core::FarthestPairTree::Set set = tree.root();
  std::uint32_t splits = 0;
  for (; !set.isLeaf(); ++splits) {
    const auto squared_distance = [&](std::size_t pole) {
      const core::TriangleId triangle = tree.triangle(tree.poles(set)[pole]);
      return core::squaredLength(tip - core::centroid(mesh.triangle(triangle)));
    };
    set = tree.children(set)[squared_distance(0) < squared_distance(1) ? 0 : 1];
  }
  return {set.begin, splits};
}

}  // namespace organ_collision::test
