#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "convex/tool_proximity.h"
#include "convex_shapes.h"
#include "core/organs_and_tips.h"
#include "test_meshes.h"

namespace organ_collision::convex {
namespace {

using core::Capsule;
using core::CollisionMesh;
using core::Points;
using core::Proximity;
using core::RigidMesh;
using core::Shape;
using core::Sphere;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::queryCount;

constexpr double kRounding = 1e-14;  // [m] of coordinates of that size

TEST(HullProximity, OfTwoBoxesIsTheGapBetweenThem) {
  const auto apart = hullProximity(box({1, 1, 1}), box({1, 1, 1}, at(0.25, 0, 2)));
  EXPECT_NEAR(apart.distance, 1.0, kGjk);
  EXPECT_NEAR(apart.normal.z(), 1.0, kGjk);
  EXPECT_NEAR(apart.point_on_first.z(), 0.5, kGjk);
  EXPECT_FALSE(apart.colliding);
  EXPECT_TRUE(apart.colliding_certain);
}

TEST(HullProximity, OfTwoBoxesThatOverlapIsTheirDepth) {
  const auto deep = hullProximity(box({1, 1, 1}), box({1, 1, 1}, at(0.0625, 0.03125, 0.75)));
  EXPECT_NEAR(deep.distance, -0.25, kTight);
  EXPECT_NEAR(deep.normal.z(), 1.0, kTight);
  EXPECT_NEAR(deep.point_on_first.z(), 0.5, kTight);
  EXPECT_NEAR(deep.point_on_second.z(), 0.25, kTight);
  EXPECT_TRUE(deep.colliding);
}

TEST(HullProximity, TakesTheRadiusOfARoundShapeOff) {
  const auto above = hullProximity(Capsule{{0, 0, 2}, {1, 0, 3}, 0.25}, box({1, 1, 1}));
  EXPECT_NEAR(above.distance, 1.25, kGjk);
  EXPECT_NEAR(above.point_on_first.z(), 1.75, kGjk);
  EXPECT_NEAR(above.normal.z(), -1.0, kGjk);
}

TEST(HullProximity, OfShapesThatJustTouchIsACollision) {
  const auto touching = hullProximity(box({1, 1, 1}), Sphere{{0, 0, 0.75}, 0.25});

  ASSERT_EQ(touching.distance, 0.0);
  EXPECT_TRUE(touching.colliding);
}

TEST(HullProximity, TakesTheRadiusOfTheSecondOffItsOwnPoint) {
  const auto below = hullProximity(box({1, 1, 1}), Sphere{{0, 0, 2}, 0.25});
  EXPECT_NEAR(below.point_on_first.z(), 0.5, kGjk);
  EXPECT_NEAR(below.point_on_second.z(), 1.75, kGjk);
}

TEST(HullProximity, FillsTheHollowOfAMeshThatIsNotConvex) {
  // A corner of walls: two squares at a right angle. The hull holds what is between them.
  const core::TriangleMesh walls({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
                                 {test::corners(0, 1, 4), test::corners(0, 4, 3),
                                  test::corners(0, 2, 5), test::corners(0, 5, 3)});
  const RigidMesh hollow{std::make_shared<const CollisionMesh>(walls), Isometry3d::Identity(),
                         true};
  const Sphere between{{0.25, 0.25, 0.5}, 0.0625};
  EXPECT_TRUE(hullProximity(hollow, between).colliding);
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
    ASSERT_LE(hulls.lower_bound, hulls.upper_bound);
    const bool meshes_overlap =
        exact.colliding && !(core::roundShape(first) && core::roundShape(second));
    if (meshes_overlap) {  // the triangles tell that, not how deep
      ASSERT_LE(hulls.lower_bound, kRounding);
      ASSERT_LE(hulls.distance, kGjk);
      continue;
    }
    ++apart;
    ASSERT_LE(hulls.lower_bound, exact.distance + kRounding);
    ASSERT_GE(hulls.upper_bound, exact.distance - kGjk);
    ASSERT_NEAR(hulls.distance, exact.distance, kGjk);
    ASSERT_GE(hulls.lower_bound, exact.distance - kGjk);
  }
  EXPECT_GT(apart, count / 10);
}

/// So near that rounding hides on which side of touching they are.
TEST(HullProximity, IsCertainThatNothingCollidesOnlyWhereTheGapIsProven) {
  std::mt19937 generator(95);
  std::size_t uncertain = 0;
  for (int i = 0; i < 500; ++i) {  // it takes so many to meet some
    const Shape first = randomConvex(generator);
    Shape second = randomConvex(generator);
    for (const double gap : {1e-8, 1e-16, 0.0}) {
      const auto found = hullProximity(first, second);
      if (found.colliding) break;
      ASSERT_EQ(found.colliding_certain, found.lower_bound > 0.0);
      ASSERT_LE(found.lower_bound, core::proximity(first, second).upper_bound + kRounding);
      if (!found.colliding_certain) ++uncertain;
      const Vector3d closer = (gap - found.distance) * found.normal;
      second = core::transformed(second, Isometry3d(Eigen::Translation3d(closer)));
    }
  }
  EXPECT_GT(uncertain, 0U);
}

/// Of boxes, the largest gap along any of the 15 normals that may separate them.
double gapOfBoxes(const Vector3d& size, const Isometry3d& first, const Isometry3d& second) {
  std::vector<Vector3d> normals;
  for (int i = 0; i < 3; ++i) {
    normals.insert(normals.end(), {first.linear().col(i), second.linear().col(i)});
    for (int k = 0; k < 3; ++k)
      normals.emplace_back(first.linear().col(i).cross(second.linear().col(k)).normalized());
  }
  double gap = -std::numeric_limits<double>::infinity();
  for (const Vector3d& normal : normals) {
    const double reach = 0.5 * ((first.linear().transpose() * normal).cwiseAbs().dot(size) +
                                (second.linear().transpose() * normal).cwiseAbs().dot(size));
    gap = std::max(gap, std::abs(normal.dot(second.translation() - first.translation())) - reach);
  }
  return gap;
}

/// Bounds, points and normal tell one distance.
void expectConsistent(const Proximity& found) {
  ASSERT_NEAR(found.lower_bound, found.distance, kTight);
  ASSERT_EQ(found.upper_bound, found.distance);
  ASSERT_NEAR(found.normal.dot(found.point_on_second - found.point_on_first), found.distance,
              kTight);
  ASSERT_NEAR((found.point_on_second - found.point_on_first).norm(), std::abs(found.distance),
              kTight);
}

/// Turned at random, along the axes, where corners of their difference are in one line and in one
/// plane, or about one centre, where two faces of that are as near.
TEST(HullProximity, OfBoxesThatOverlapIsTheLeastDepthOfAll) {
  std::mt19937 generator(96);
  const Vector3d size(1.0, 0.5, 0.25);
  std::size_t overlaps = 0;
  for (std::size_t i = 0; i < queryCount(1000); ++i) {
    Isometry3d first = test::randomPose(generator, 0.3);
    Isometry3d second = test::randomPose(generator, 0.3);
    if (i % 3 == 0) first.linear() = second.linear() = Eigen::Matrix3d::Identity();
    if (i % 3 == 1) second.translation() = first.translation();
    const double gap = gapOfBoxes(size, first, second);
    if (gap >= 0.0) continue;
    ++overlaps;
    const Proximity found = hullProximity(box(size, first), box(size, second));
    ASSERT_NEAR(found.distance, gap, kTight);
    ASSERT_NO_FATAL_FAILURE(expectConsistent(found));
  }
  EXPECT_GT(overlaps, queryCount(1000) / 10);
}

TEST(HullProximity, OfParallelCylindersTellsOneDistance) {
  std::mt19937 generator(95);
  std::size_t overlaps = 0;
  for (std::size_t i = 0; i < queryCount(1000); ++i) {
    Isometry3d pose(Eigen::Translation3d(0.5 * test::randomPoint(generator, 1.0)));
    if (i % 2 == 0)
      pose.rotate(Eigen::AngleAxisd(0.01 * static_cast<double>(i), Vector3d::UnitZ()));
    const Proximity found =
        hullProximity(cylinder(0.25, 1.0, Isometry3d::Identity()), cylinder(0.25, 1.0, pose));
    overlaps += found.colliding ? 1 : 0;
    ASSERT_NO_FATAL_FAILURE(expectConsistent(found));
  }
  EXPECT_GT(overlaps, queryCount(1000) / 4);
}

/// Where GJK and EPA know no normal any more.
TEST(HullProximity, IsAsGoodWhereHullsAllButTouch) {
  std::mt19937 generator(97);
  const Vector3d size(0.25, 0.5, 1.0);
  for (std::size_t i = 0; i < queryCount(1000); ++i) {
    const Isometry3d pose =
        generator() % 3 == 0 ? Isometry3d::Identity() : test::randomPose(generator, 0.5);
    const int axis = static_cast<int>(generator() % 3);
    Vector3d at = 0.4375 * test::randomPoint(generator, 1.0).cwiseProduct(size);
    const double aside =
        generator() % 5 == 0 ? 0.0 : std::ldexp(1.0, -20 - static_cast<int>(generator() % 35));
    const double gap = generator() % 2 == 0 ? aside : -aside;
    at[axis] = 0.5 * size[axis] + gap;
    const Vector3d out = pose.linear().col(axis);
    const Proximity round = hullProximity(box(size, pose), Sphere{pose * at, 0.0625});
    ASSERT_LE(round.lower_bound, gap - 0.0625 + kRounding);
    ASSERT_GE(round.lower_bound, gap - 0.0625 - kTight);
    ASSERT_NEAR(round.upper_bound, gap - 0.0625, kTight);
    ASSERT_NEAR((round.normal - out).norm(), 0.0, kGjk);
    at[axis] += 0.5 * size[axis];
    const Proximity stacked =
        hullProximity(box(size, pose), box(size, pose * Eigen::Translation3d(at)));
    ASSERT_LE(stacked.lower_bound, gap + kRounding);
    ASSERT_GE(stacked.lower_bound, gap - kTight);
    ASSERT_NEAR(stacked.upper_bound, gap, kTight);
    ASSERT_NEAR((stacked.normal - out).norm(), 0.0, kGjk);
  }
}

TEST(HullProximity, OfCrossingShaftsFollowsThemThroughTheTouch) {
  const Isometry3d turned = at(0, 0, 0) * Eigen::AngleAxisd(1.25, Vector3d(1, 0, 0));
  const RigidMesh shaft = cylinder(0.0078125, 1.0, Isometry3d::Identity());
  for (int i = -300; i < 300; ++i) {
    const double apart = 0.015625 + 1e-8 * i;
    const Proximity found =
        hullProximity(shaft, cylinder(0.0078125, 1.0, at(apart, 0, 0) * turned));
    ASSERT_NEAR(found.distance, 1e-8 * i, kTight);
    ASSERT_NEAR(found.lower_bound, 1e-8 * i, kTight);
  }
}

TEST(HullProximity, SwappedSwapsThePointsAndTurnsTheNormal) {
  std::mt19937 generator(92);
  for (std::size_t i = 0; i < queryCount(500); ++i) {
    const Shape first = randomConvex(generator);
    const Shape second = randomConvex(generator);
    const auto there = hullProximity(first, second);
    const auto back = hullProximity(second, first);
    ASSERT_NEAR(there.distance, back.distance, kTight);
    if (there.distance < 0.01 * kSize) continue;  // overlapping: there may be two ways out
    ASSERT_NEAR((there.normal + back.normal).norm(), 0.0,
                1e-2);  // kGjk over the distance, its root
    for (const Proximity& found : {there, back})
      ASSERT_NEAR((found.point_on_second - found.point_on_first).norm(), found.distance, kTight);
  }
}

TEST(HullProximity, RefusesWhatOtherPairsRefuse) {
  const RigidMesh mesh = box({1, 1, 1});
  RigidMesh scaled = mesh;
  scaled.pose.linear() *= 3.0;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Shape& bad : {Shape(Sphere{{0, 0, 3}, -1.0}), Shape(Sphere{{0, 0, 3}, nan}),
                           Shape(Vector3d(nan, 0, 0)), Shape(scaled)}) {
    EXPECT_THROW(hullProximity(mesh, bad), std::invalid_argument);
    EXPECT_THROW(hullProximity(bad, mesh), std::invalid_argument);
  }
}

TEST(HullProximity, DependsOnNoSize) {
  std::mt19937 generator(93);
  for (const double scale : {0x1p-20, 0x1p20}) {
    const auto small = hullProximity(
        box(scale * Vector3d(1, 2, 3)),
        Capsule{scale * Vector3d(4, 1, 0.5), scale * Vector3d(4, 2, 3), scale * 0.25});
    const auto usual = hullProximity(box({1, 2, 3}), Capsule{{4, 1, 0.5}, {4, 2, 3}, 0.25});
    const auto small_deep =
        hullProximity(box(scale * Vector3d(3, 3, 3)), Sphere{scale * Vector3d(0, 0.1, 1), scale});
    EXPECT_NEAR(small_deep.distance, -1.5 * scale, kTight * scale);
    EXPECT_EQ(small.distance, scale * usual.distance);
    EXPECT_EQ(small.lower_bound, scale * usual.lower_bound);
  }
}

}  // namespace
}  // namespace organ_collision::convex
