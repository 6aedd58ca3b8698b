#pragma once

#include <gtest/gtest.h>

#include <random>

#include "organ_collision/core/nearest_triangle.h"
#include "organs_and_tips.h"
#include "test_meshes.h"

// Tips that trackers follow, and what they must answer.
namespace organ_collision::test {

using core::CollisionMesh;
using core::NearestTriangle;

inline void expectSame(const NearestTriangle& tracked, const NearestTriangle& searched) {
  ASSERT_EQ(tracked.triangle, searched.triangle);
  ASSERT_EQ(tracked.distance, searched.distance);
  ASSERT_EQ(tracked.lower_bound, searched.lower_bound);
  ASSERT_EQ(tracked.upper_bound, searched.upper_bound);
  ASSERT_EQ(tracked.distance_signed, searched.distance_signed);
  ASSERT_EQ(tracked.closest.point, searched.closest.point);
  ASSERT_EQ(tracked.closest.barycentric, searched.closest.barycentric);
  ASSERT_EQ(tracked.closest.feature, searched.closest.feature);
  ASSERT_EQ(tracked.tip_point, searched.tip_point);
  ASSERT_EQ(tracked.normal, searched.normal);
}

inline double sizeOf(const CollisionMesh& organ) {
  return (organ.health().box.high - organ.health().box.low).maxCoeff();
}

/// The next place of a tip: it rests, creeps, moves or jumps.
inline Eigen::Vector3d moved(const Eigen::Vector3d& tip, std::mt19937& generator,
                             const CollisionMesh& organ) {
  switch (generator() % 8) {
    case 0:
      return tip;
    case 1:
      return tip + randomPoint(generator, 1e-15 * sizeOf(organ));
    case 2:
      return generator() % 8 == 0 ? randomTip(generator, organ) : tip;
    default:
      return tip + randomPoint(generator, 0.01 * sizeOf(organ));
  }
}

}  // namespace organ_collision::test
