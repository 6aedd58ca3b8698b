#include "convex/tool_proximity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

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

TEST(HullProximity, OfShapesThatJustTouchIsACollision) {
  const auto touching = hullProximity(box({1, 1, 1}), Sphere{{0, 0, 0.75}, 0.25});
  ASSERT_TRUE(touching);
  ASSERT_EQ(touching->distance, 0.0);
  EXPECT_TRUE(touching->colliding);
}

TEST(HullProximity, TakesTheRadiusOfTheSecondOffItsOwnPoint) {
  const auto below = hullProximity(box({1, 1, 1}), Sphere{{0, 0, 2}, 0.25});
  ASSERT_TRUE(below);
  EXPECT_NEAR(below->point_on_first.z(), 0.5, kGjk);
  EXPECT_NEAR(below->point_on_second.z(), 1.75, kGjk);
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

/// So near that rounding hides on which side of touching they are.
TEST(HullProximity, IsCertainThatNothingCollidesOnlyWhereTheGapIsProven) {
  std::mt19937 generator(95);
  std::size_t uncertain = 0;
  for (int i = 0; i < 500; ++i) {  // it takes so many to meet some
    const Shape first = randomConvex(generator);
    Shape second = randomConvex(generator);
    for (const double gap : {1e-8, 1e-16, 0.0}) {
      const auto found = hullProximity(first, second);
      if (!found || found->colliding) break;
      ASSERT_EQ(found->colliding_certain, found->lower_bound > 0.0);
      if (!found->colliding_certain) ++uncertain;
      const Vector3d closer = (gap - found->distance) * found->normal;
      second = core::transformed(second, Isometry3d(Eigen::Translation3d(closer)));
    }
  }
  EXPECT_GT(uncertain, 0U);
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

Isometry3d posed(const Eigen::Matrix<double, 3, 4>& rows) {
  Isometry3d pose = Isometry3d::Identity();
  pose.matrix().topRows<3>() = rows;
  return pose;
}

/// Of a hundred thousand random pairs those for which FCL's GJK and its EPA ended too early.
TEST(HullProximity, IsProvenWhereGjkAndEpaEndTooEarly) {
  Eigen::Matrix<double, 3, 4> first;
  first << -0.23914759348103798, 0.3166256288477603, 0.91790884062034661, -0.28621546931968611,
      0.9708923176991886, 0.065039990793976599, 0.23051660901162385, -0.49576562475062175,
      0.013286683744501926, 0.94631813400900244, -0.32296354791337306, 0.13764815501427308;
  Eigen::Matrix<double, 3, 4> second;
  second << -0.057851523840735664, 0.89233280931477543, 0.44765540163132778, -0.15895694156982604,
      0.51043224646793217, 0.41180297111786379, -0.75490213587206134, 0.025696316443356459,
      -0.85796976808918213, 0.1848255133873582, -0.47929886985689263, -0.16962131419822163;
  Eigen::Matrix<double, 3, 4> third;
  third << 0.97552888639128754, 0.020101838903566278, -0.21895046903094223, -0.055933007837591642,
      -0.027238084016208298, 0.99918995253680321, -0.029623057381487329, 0.47829317679353167,
      0.21817763083162423, 0.034861939449720554, 0.97528619726852672, -0.27827742789039811;
  const Capsule through{{-0.041658367850324896, 0.45287476391606052, -0.31066301461764434},
                        {0.13950724686418486, 0.31072036448364032, -0.2133431976885023},
                        0.0625};
  const std::vector<std::pair<Shape, Shape>> pairs = {
      {cylinder(0.125, 0.5, posed(first)), cylinder(0.125, 0.5, posed(second))},
      {through, box({0.25, 0.125, 0.0625}, posed(third))}};
  for (const auto& [one, other] : pairs) {
    for (const auto& found : {hullProximity(one, other), hullProximity(other, one)}) {
      ASSERT_TRUE(found.has_value());
      EXPECT_NEAR(found->lower_bound, found->upper_bound, kGjk);
    }
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
    EXPECT_NEAR(small_deep->distance, -1.5 * scale, kDepth * scale);
    EXPECT_EQ(small->distance, scale * usual->distance);
    EXPECT_EQ(small->lower_bound, scale * usual->lower_bound);
  }
}

TEST(ToolProximity, IsThatOfTheNearestPiecesInTheSecondsFrameWhereverTheyAreListed) {
  core::Shapes first = {Sphere{{0, 0, 9}, 1}, box({1, 1, 1})};
  core::Shapes second = {Sphere{{0, 0, -4}, 0.5}, Vector3d(0, 0, -1)};
  for (core::Shapes* const turned : {&first, &second, &first, &second}) {
    const Proximity nearest = toolProximity(first, at(0, 0, 2), second, {});
    EXPECT_NEAR(nearest.distance, 2.5, kGjk);
    EXPECT_NEAR(nearest.point_on_first.z(), 1.5, kGjk);
    EXPECT_EQ(nearest.point_on_second, Vector3d(0, 0, -1));
    std::reverse(turned->begin(), turned->end());
  }
}

TEST(ToolProximity, KeepsToTheAccuracyAskedFor) {
  const core::Shapes blob = {RigidMesh{std::make_shared<const CollisionMesh>(test::blob(4)),
                                       Isometry3d::Identity(), false}};
  const auto ask = [&](const core::Accuracy& accuracy) {
    return toolProximity(blob, Isometry3d::Identity(), {Vector3d(0.3, 0.2, 0.1)}, accuracy);
  };
  EXPECT_LT(ask(core::Accuracy::greedy()).lower_bound, ask(core::Accuracy::greedy()).upper_bound);
  EXPECT_EQ(ask({}).lower_bound, ask({}).upper_bound);
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

TEST(ToolProximity, AsksTheTrianglesIfOneIsNotConvex) {
  const RigidMesh open{std::make_shared<const CollisionMesh>(test::grid(2, 2)),
                       Isometry3d::Identity(), false};
  const RigidMesh above = box({1, 1, 1}, at(1, 1, 2));
  EXPECT_TRUE(toolProximity({open}, Isometry3d::Identity(), {above}, {}).triangle_of_first);
  EXPECT_TRUE(toolProximity({above}, Isometry3d::Identity(), {open}, {}).triangle_of_first);
}

TEST(ToolProximity, OfRoundShapesIsThatOfTheirCores) {
  std::mt19937 generator(94);
  for (std::size_t i = 0; i < queryCount(100); ++i) {
    const auto capsule = [&] {
      return Capsule{test::randomPoint(generator, 1.0), test::randomPoint(generator, 1.0), 0.125};
    };
    const Shape first = capsule();
    const Shape second = capsule();
    ASSERT_EQ(toolProximity({first}, Isometry3d::Identity(), {second}, {}).distance,
              core::proximity(first, second).distance);
  }
}

TEST(ToolProximity, OfAHullLeavesOutVerticesWithoutATriangle) {
  const core::TriangleMesh cube = test::cube();
  core::Points points = cube.positions();
  points.emplace_back(0, 0, 50);
  const RigidMesh mesh{
      std::make_shared<const CollisionMesh>(core::TriangleMesh(points, cube.triangles())),
      Isometry3d::Identity(), true};
  EXPECT_NEAR(
      toolProximity({mesh}, Isometry3d::Identity(), {Sphere{{0.5, 0.5, 10}, 1}}, {}).distance, 8.0,
      1e-9);
}

}  // namespace
}  // namespace organ_collision::convex
