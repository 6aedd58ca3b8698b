#include "convex/tool_proximity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/organs_and_tips.h"
#include "io/primitive_mesh.h"
#include "test_meshes.h"

namespace organ_collision::convex {
namespace {

using core::Capsule;
using core::CollisionMesh;
using core::Proximity;
using core::RigidMesh;
using core::Shape;
using core::Sphere;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::queryCount;

constexpr double kSize = 1.0;            // [m] of what is asked about below
constexpr double kGjk = 1e-6 * kSize;    // [m] how well GJK finds a distance of it
constexpr double kDepth = 1e-4 * kSize;  // [m] and EPA a depth
constexpr double kRounding = 1e-14;      // [m] of coordinates of that size

RigidMesh box(const Vector3d& size, const Isometry3d& pose = Isometry3d::Identity()) {
  return {std::make_shared<const CollisionMesh>(io::boxMesh(size)), pose, true};
}

RigidMesh cylinder(double radius, double length, const Isometry3d& pose) {
  return {std::make_shared<const CollisionMesh>(io::prismMesh(radius, length, 32)), pose, true};
}

Isometry3d at(double x, double y, double z) { return Isometry3d(Eigen::Translation3d(x, y, z)); }

TEST(HullProximity, OfTwoBoxesIsTheGapBetweenThem) {
  const auto apart = hullProximity(box({1, 1, 1}), box({1, 1, 1}, at(0.25, 0, 2)));
  ASSERT_TRUE(apart);
  EXPECT_NEAR(apart->distance, 1.0, kGjk);
  EXPECT_NEAR(apart->normal.z(), 1.0, kGjk);
  EXPECT_NEAR(apart->point_on_first.z(), 0.5, kGjk);
  EXPECT_FALSE(apart->colliding);
  EXPECT_TRUE(apart->colliding_certain);
}

TEST(HullProximity, OfTwoBoxesThatOverlapIsTheirDepth) {
  const auto deep = hullProximity(box({1, 1, 1}), box({1, 1, 1}, at(0.0625, 0.03125, 0.75)));
  ASSERT_TRUE(deep);
  EXPECT_NEAR(deep->distance, -0.25, kDepth);
  EXPECT_NEAR(deep->normal.z(), 1.0, kDepth);
  EXPECT_NEAR(deep->point_on_first.z(), 0.5, kDepth);
  EXPECT_NEAR(deep->point_on_second.z(), 0.25, kDepth);
  EXPECT_TRUE(deep->colliding);
}

TEST(HullProximity, TakesTheRadiusOfARoundShapeOff) {
  const auto above = hullProximity(Capsule{{0, 0, 2}, {1, 0, 3}, 0.25}, box({1, 1, 1}));
  ASSERT_TRUE(above);
  EXPECT_NEAR(above->distance, 1.25, kGjk);
  EXPECT_NEAR(above->point_on_first.z(), 1.75, kGjk);
  EXPECT_NEAR(above->normal.z(), -1.0, kGjk);
}

TEST(HullProximity, FillsTheHollowOfAMeshThatIsNotConvex) {
  // A corner of walls: two squares at a right angle. The hull holds what is between them.
  const core::TriangleMesh walls({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
                                 {test::corners(0, 1, 4), test::corners(0, 4, 3),
                                  test::corners(0, 2, 5), test::corners(0, 5, 3)});
  const RigidMesh hollow{std::make_shared<const CollisionMesh>(walls), Isometry3d::Identity(),
                         true};
  const Sphere between{{0.25, 0.25, 0.5}, 0.0625};
  EXPECT_TRUE(hullProximity(hollow, between)->colliding);
  EXPECT_FALSE(core::proximity(hollow, between).colliding);
}

Shape randomConvex(std::mt19937& generator) {
  const Isometry3d pose = test::randomPose(generator, 0.5);
  const double size = std::ldexp(0.5 * kSize, -static_cast<int>(generator() % 4));
  switch (generator() % 4) {
    case 0:
      return cylinder(0.25 * size, size, pose);
    case 1:
      return Sphere{pose.translation(), 0.5 * size};
    case 2:
      return Capsule{pose.translation(), pose * Vector3d(0, 0, size), 0.25 * size};
    default:
      return box({size, 0.5 * size, 0.25 * size}, pose);
  }
}

TEST(HullProximity, AgreesWithTheTrianglesAndTheAnalyticAnswer) {
  std::mt19937 generator(91);
  std::size_t apart = 0;
  const std::size_t count = queryCount(1500);
  for (std::size_t i = 0; i < count; ++i) {
    const Shape first = randomConvex(generator);
    const Shape second = randomConvex(generator);
    const auto hulls = hullProximity(first, second);
    const Proximity exact = core::proximity(first, second);
    if (!hulls) {
      ASSERT_LE(std::abs(exact.distance), kGjk);  // they just touch
      continue;
    }
    ASSERT_LE(hulls->lower_bound, hulls->upper_bound);
    const bool meshes_overlap =
        exact.colliding && !(core::roundShape(first) && core::roundShape(second));
    if (meshes_overlap) {  // the triangles tell that, not how deep
      ASSERT_LE(hulls->lower_bound, kRounding);
      ASSERT_LE(hulls->distance, kGjk);
      continue;
    }
    ++apart;
    ASSERT_LE(hulls->lower_bound, exact.distance + kRounding);
    ASSERT_GE(hulls->upper_bound, exact.distance - kGjk);
    ASSERT_NEAR(hulls->distance, exact.distance, kGjk);
    ASSERT_GE(hulls->lower_bound, exact.distance - kGjk);
  }
  EXPECT_GT(apart, count / 10);
}

TEST(HullProximity, SwappedSwapsThePointsAndTurnsTheNormal) {
  std::mt19937 generator(92);
  for (std::size_t i = 0; i < queryCount(500); ++i) {
    const Shape first = randomConvex(generator);
    const Shape second = randomConvex(generator);
    const auto there = hullProximity(first, second);
    const auto back = hullProximity(second, first);
    if (!there || !back) continue;
    ASSERT_NEAR(there->distance, back->distance, kDepth);
    if (there->distance < 0.01 * kSize) continue;  // overlapping: there may be two ways out
    ASSERT_NEAR((there->normal + back->normal).norm(), 0.0,
                1e-2);  // kGjk over the distance, its root
  }
}

TEST(HullProximity, DependsOnNoSize) {
  std::mt19937 generator(93);
  for (const double scale : {0x1p-20, 0x1p20}) {
    const auto small = hullProximity(
        box(scale * Vector3d(1, 2, 3)),
        Capsule{scale * Vector3d(4, 1, 0.5), scale * Vector3d(4, 2, 3), scale * 0.25});
    const auto usual = hullProximity(box({1, 2, 3}), Capsule{{4, 1, 0.5}, {4, 2, 3}, 0.25});
    EXPECT_EQ(small->distance, scale * usual->distance);
    EXPECT_EQ(small->lower_bound, scale * usual->lower_bound);
  }
}

TEST(ToolProximity, IsThatOfTheNearestPiecesInTheSecondsFrame) {
  const core::Shapes first = {Sphere{{0, 0, 9}, 1}, box({1, 1, 1})};
  const core::Shapes second = {Sphere{{0, 0, -4}, 0.5}, Vector3d(0, 0, -1)};
  const Proximity nearest = toolProximity(first, at(0, 0, 2), second, {});
  EXPECT_NEAR(nearest.distance, 2.5, kGjk);
  EXPECT_NEAR(nearest.point_on_first.z(), 1.5, kGjk);
  EXPECT_EQ(nearest.point_on_second, Vector3d(0, 0, -1));
}

TEST(ToolProximity, LeavesAMeshThatIsNotCalledConvexAsItIs) {
  RigidMesh blob{std::make_shared<const CollisionMesh>(test::blob(2)), Isometry3d::Identity(),
                 false};
  const auto ask = [&] {
    return toolProximity({blob}, Isometry3d::Identity(), {Vector3d(1, 1, 1)}, {});
  };
  EXPECT_TRUE(ask().triangle_of_first.has_value());
  blob.convex = true;
  EXPECT_FALSE(ask().triangle_of_first.has_value());
}

}  // namespace
}  // namespace organ_collision::convex
