#include "organ_collision/core/triangles_within.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "organ_collision/core/closest_point.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organs_and_tips.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector3d;

TEST(TrianglesWithin, OfACubeAreTheFacesThatAreNearEnough) {
  const CollisionMesh cube(test::cube());
  const Vector3d above(0.5, 0.5, 1.5);
  EXPECT_TRUE(trianglesWithin(cube, above, 0.25).triangles.empty());
  EXPECT_TRUE(trianglesWithin(cube, above, 0.25).complete);
  EXPECT_EQ(trianglesWithin(cube, above, 0.5).triangles.size(), 2U);  // just touched
  EXPECT_EQ(trianglesWithin(cube, above, 10.0).triangles.size(), 12U);
}

TEST(TrianglesWithin, CutShortAreTheNearestAndNotComplete) {
  const CollisionMesh cube(test::cube());
  const Vector3d above(0.4, 0.5, 1.5);
  const TrianglesWithin all = trianglesWithin(cube, above, 10.0);
  const TrianglesWithin five = trianglesWithin(cube, above, 10.0, 5);
  EXPECT_FALSE(five.complete);
  ASSERT_EQ(five.triangles.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_EQ(five.triangles[i].triangle, all.triangles[i].triangle);
  EXPECT_TRUE(trianglesWithin(cube, above, 10.0, 12).complete);
}

TEST(TrianglesWithin, AreThoseThatBruteForceFindsNearestFirst) {
  std::mt19937 generator(78);
  for (const CollisionMesh& organ : test::organs()) {
    for (std::size_t i = 0; i < test::queryCount(50); ++i) {
      const Vector3d point = test::randomTip(generator, organ);
      const double nearest = std::abs(nearestTriangle(organ, point).distance);
      const double radius = nearest * (generator() % 3) + 1e-2 * (generator() % 2);
      std::vector<std::pair<double, std::uint32_t>> expected;
      for (std::uint32_t k = 0; k < organ.mesh().triangleCount(); ++k) {
        const Triangle triangle = organ.mesh().triangle(TriangleId{k});
        const double distance = std::sqrt(closestPointOnTriangle(point, triangle).squared_distance);
        if (distance <= radius) expected.emplace_back(distance, k);
      }
      std::sort(expected.begin(), expected.end());
      const TrianglesWithin within = trianglesWithin(organ, point, radius);
      ASSERT_TRUE(within.complete);
      ASSERT_EQ(within.triangles.size(), expected.size());
      for (std::size_t k = 0; k < expected.size(); ++k) {
        ASSERT_EQ(within.triangles[k].triangle, TriangleId{expected[k].second});
        ASSERT_EQ(within.triangles[k].distance, expected[k].first);
      }
    }
  }
}

TEST(TrianglesWithin, AsFarAsTheNearestAreThatOneAtLeast) {
  std::mt19937 generator(15);
  for (unsigned round = 0; round < 300; ++round) {
    const CollisionMesh organ(round % 2 == 0 ? test::blob(3) : test::soup(100, round));
    for (int i = 0; i < 50; ++i) {
      const int exponent = static_cast<int>(generator() % 60) - 3;
      const Eigen::Vector3d tip = std::ldexp(1.0, exponent) * test::randomPoint(generator, 1.0);
      const double distance = std::abs(nearestTriangle(organ, tip).distance);
      ASSERT_FALSE(trianglesWithin(organ, tip, distance).triangles.empty()) << tip.transpose();
    }
  }
}

TEST(TrianglesWithin, AreFoundFromSoFarAwayThatSquaresOfAMeshsSizesOverflow) {
  const CollisionMesh speck(test::cube(1e-80));
  EXPECT_EQ(trianglesWithin(speck, {1e85, 0, 0}, 2e85).triangles.size(), 12);
  EXPECT_EQ(trianglesWithin(speck, {1e85, 0, 0}, 0.5e85).triangles.size(), 0);
}

TEST(TrianglesWithin, RefusesWhatItCannotAnswer) {
  const CollisionMesh cube(test::cube());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(trianglesWithin(cube, {0, 0, nan}, 1), std::invalid_argument);
  for (const double radius : {-1e-9, nan, std::numeric_limits<double>::infinity()})
    EXPECT_THROW(trianglesWithin(cube, {0, 0, 0}, radius), std::invalid_argument);
  EXPECT_THAT(
      [&] {
        trianglesWithin(cube, {0, 0, 0}, -1e-9);
      },
      testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("is -1e-09:")));
}

}  // namespace
}  // namespace organ_collision::core
