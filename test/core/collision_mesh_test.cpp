#include "organ_collision/core/collision_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "brute_force.h"
#include "organ_collision/core/nearest_triangle.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

Points twisted(const Points& points, double turns_per_metre) {
  Points result = points;
  for (Eigen::Vector3d& point : result) {
    point = Eigen::AngleAxisd(turns_per_metre * point.x(), Eigen::Vector3d::UnitX()) * point;
  }
  return result;
}

Points flattened(const Points& points) {
  Points result = points;
  for (Eigen::Vector3d& point : result) point.z() = 0.0;
  return result;
}

void expectBruteForce(const CollisionMesh& organ, std::mt19937& generator) {
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d tip = test::randomPoint(generator, 0.2);
    const NearestTriangle nearest = nearestTriangle(organ, tip);
    ASSERT_EQ(std::abs(nearest.distance),
              std::sqrt(test::squaredDistanceByBruteForce(organ.mesh(), tip)));
  }
}

TEST(CollisionMesh, RefitAndRebuildFollowTheDeformation) {
  std::mt19937 generator(31);
  const Points original = test::blob(4).positions();
  CollisionMesh organ(test::blob(4));
  for (const Points& deformed : {twisted(original, 20.0), flattened(original), original}) {
    organ.refit(deformed);
    expectBruteForce(organ, generator);
    organ.rebuild();
    expectBruteForce(organ, generator);
  }
}

TEST(CollisionMesh, RebuildEqualsANewOne) {
  const Points deformed = twisted(test::blob(4).positions(), 20.0);
  CollisionMesh organ(test::blob(4));
  organ.refit(deformed);
  organ.rebuild();
  const CollisionMesh fresh(TriangleMesh(deformed, test::blob(4).triangles()));
  for (std::size_t i = 0; i < fresh.tree().nodeCount(); ++i)
    EXPECT_EQ(organ.tree().node(i).poles, fresh.tree().node(i).poles);
}

TEST(CollisionMesh, ACopyKeepsAnsweringForItsOwnPositions) {
  const CollisionMesh before(test::cube());
  CollisionMesh after = before;
  Points moved = test::cube().positions();
  for (Eigen::Vector3d& point : moved) point.z() += 1.0;
  after.refit(moved);
  const Eigen::Vector3d tip(0.5, 0.5, 3.0);
  EXPECT_EQ(nearestTriangle(before, tip).distance, 2.0);
  EXPECT_EQ(nearestTriangle(after, tip).distance, 1.0);
}

TEST(CollisionMesh, StaysAsItWasWhenPositionsDoNotFit) {
  CollisionMesh organ(test::cube());
  EXPECT_THROW(organ.refit({{0, 0, 0}}), std::invalid_argument);
  EXPECT_EQ(nearestTriangle(organ, Eigen::Vector3d(0.5, 0.5, 3.0)).distance, 2.0);
}

}  // namespace
}  // namespace organ_collision::core
