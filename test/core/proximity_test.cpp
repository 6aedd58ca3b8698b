#include "organ_collision/core/proximity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "organs_and_tips.h"
#include "reference/exact.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::queryCount;

constexpr double kTolerance = 1e-14;  // [m] rounding of coordinates of a few metres

Shape cubeAt(const Vector3d& corner, double size = 1.0) {
  return RigidMesh{std::make_shared<const CollisionMesh>(test::cube(size)),
                   Isometry3d(Eigen::Translation3d(corner))};
}

TEST(Proximity, OfTwoSpheresIsThatOfTheCentresLessTheRadii) {
  const Proximity apart = proximity(Sphere{{0, 0, 0}, 1}, Sphere{{0, 0, 5}, 2});
  EXPECT_EQ(apart.distance, 2);
  EXPECT_EQ(apart.point_on_first, Vector3d(0, 0, 1));
  EXPECT_EQ(apart.point_on_second, Vector3d(0, 0, 3));
  EXPECT_EQ(apart.normal, Vector3d(0, 0, 1));
  EXPECT_FALSE(apart.colliding);
  EXPECT_FALSE(apart.triangle_of_first || apart.triangle_of_second);
  const Proximity overlapping = proximity(Sphere{{0, 0, 0}, 3}, Sphere{{0, 0, 4}, 2});
  EXPECT_EQ(overlapping.distance, -1);
  EXPECT_EQ(overlapping.point_on_first, Vector3d(0, 0, 3));
  EXPECT_EQ(overlapping.point_on_second, Vector3d(0, 0, 2));
  EXPECT_TRUE(overlapping.colliding);
}

TEST(Proximity, OfCoresThatShareALineIsBothRadiiDeepSquareToIt) {
  const Capsule along_z{{0, 0, 0}, {0, 0, 1}, 0.25};
  for (const Shape& other :
       {Shape(Sphere{{0, 0, 0.5}, 0.5}), Shape(Capsule{{0, 0, 0.5}, {0, 0, 2}, 0.5})}) {
    const Proximity there = proximity(along_z, other);
    const Proximity back = proximity(other, along_z);
    for (const Proximity& found : {there, back}) {
      EXPECT_NEAR(found.distance, -0.75, 1e-15);
      EXPECT_NEAR(found.normal.norm(), 1.0, 1e-15);
      EXPECT_NEAR(found.normal.z(), 0.0, 1e-15);
      EXPECT_NEAR((found.point_on_second - found.point_on_first + 0.75 * found.normal).norm(), 0.0,
                  1e-15);
    }
  }
  const Proximity same = proximity(Sphere{{0, 0, 0}, 0.5}, Sphere{{0, 0, 0}, 0.5});
  EXPECT_TRUE(same.normal.isZero(0.0));  // there is none
}

TEST(Proximity, OfCrossingCapsulesIsBothRadiiDeepSquareToBothAxes) {
  const Capsule along_x{{-1, 0, 0}, {1, 0, 0}, 0.25};
  const Capsule along_y{{0, -1, 0}, {0, 1, 0}, 0.5};
  const Proximity crossing = proximity(along_x, along_y);
  EXPECT_EQ(crossing.distance, -0.75);
  EXPECT_EQ(std::abs(crossing.normal.z()), 1.0);
  EXPECT_EQ(proximity(along_y, along_x).normal, -crossing.normal);
}

TEST(Proximity, OfOneCentreInTheOtherHasNoNormal) {
  const Proximity same = proximity(Sphere{{1, 2, 3}, 1}, Sphere{{1, 2, 3}, 2});
  EXPECT_EQ(same.distance, -3);
  EXPECT_TRUE(same.normal.isZero(0.0));
  EXPECT_EQ(same.point_on_first, Vector3d(1, 2, 3));
}

TEST(Proximity, WithAMeshNamesItsTriangle) {
  const Proximity above = proximity(cubeAt({5, 5, 5}), Sphere{{5.5, 5.5, 8}, 0.5});
  EXPECT_EQ(above.distance, 1.5);
  EXPECT_EQ(above.normal, Vector3d(0, 0, 1));
  EXPECT_EQ(above.point_on_first, Vector3d(5.5, 5.5, 6));
  EXPECT_EQ(above.point_on_second, Vector3d(5.5, 5.5, 7.5));
  EXPECT_TRUE(above.triangle_of_first);
  EXPECT_FALSE(above.triangle_of_second);
  const Proximity inside = proximity(Vector3d(5.5, 5.5, 5.75), cubeAt({5, 5, 5}));
  EXPECT_EQ(inside.distance, -0.25);
  EXPECT_EQ(inside.normal, Vector3d(0, 0, -1));  // the way in
}

TEST(Proximity, OfAPointOnAMeshHasItsNormal) {
  const Proximity found = proximity(Vector3d(0.5, 0.25, 1.0), cubeAt({0, 0, 0}));
  EXPECT_EQ(found.distance, 0.0);
  EXPECT_EQ(found.normal, Vector3d(0, 0, -1));
}

TEST(Proximity, OfAnOpenMeshIsNotPerhapsDeeper) {
  const RigidMesh grid = {std::make_shared<const CollisionMesh>(test::grid(4, 4)),
                          Isometry3d::Identity()};
  const Proximity found = proximity(Sphere{{1.3, 2.2, 2.0}, 0.5}, grid);
  EXPECT_EQ(found.distance, 1.5);
  EXPECT_EQ(found.lower_bound, 1.5);
}

TEST(Proximity, OfTwoMeshesNamesBothTriangles) {
  const Proximity beside = proximity(cubeAt({0, 0, 0}), cubeAt({0.25, 0.25, 3}, 0.5));
  EXPECT_EQ(beside.distance, 2);
  EXPECT_EQ(beside.normal, Vector3d(0, 0, 1));
  EXPECT_TRUE(beside.triangle_of_first && beside.triangle_of_second);
  EXPECT_EQ(proximity(cubeAt({0, 0, 0}), cubeAt({0.5, 0.5, 0.5})).distance, 0);
  EXPECT_TRUE(proximity(cubeAt({0, 0, 0}), cubeAt({0.5, 0.5, 0.5})).colliding);
  EXPECT_TRUE(proximity(cubeAt({0, 0, 0}), cubeAt({0.5, 0.5, 0.5}, 0.25)).colliding);  // within
}

TEST(Proximity, UnitedIsTheNearerWithBoundsOfBoth) {
  const Proximity near = proximity(Sphere{{0, 0, 0}, 1}, Sphere{{0, 0, 3}, 1});
  Proximity far = proximity(Sphere{{0, 0, 0}, 1}, Sphere{{0, 0, 9}, 1});
  far.lower_bound = 0.5;
  far.colliding_certain = false;
  for (const Proximity& whole : {united(near, far), united(far, near)}) {
    EXPECT_EQ(whole.distance, 1);
    EXPECT_EQ(whole.lower_bound, 0.5);
    EXPECT_EQ(whole.upper_bound, 1);
    EXPECT_FALSE(whole.colliding_certain);
  }
}

TEST(Proximity, UnitedKnowsAsMuchAsBoth) {
  Proximity inside = proximity(Sphere{{0, 0, 0}, 1}, Sphere{{0, 0, 1}, 1});
  inside.upper_bound = -0.25;
  inside.work = {3, 5};
  Proximity other = proximity(Sphere{{0, 0, 0}, 1}, Sphere{{0, 0, 1.5}, 1});
  other.colliding_certain = false;
  other.work = {10, 20};
  for (const Proximity& whole : {united(inside, other), united(other, inside)}) {
    EXPECT_EQ(whole.distance, -1.0);
    EXPECT_EQ(whole.upper_bound, -0.5);
    EXPECT_EQ(whole.work.bounds, 13);
    EXPECT_EQ(whole.work.triangles, 25);
  }
  Proximity apart = proximity(Sphere{{0, 0, 0}, 1}, Sphere{{0, 0, 9}, 1});
  apart.colliding_certain = false;
  EXPECT_TRUE(united(inside, apart).colliding_certain);
}

TEST(Proximity, OfASphereThatReachesIntoAMeshHasTheNormalIntoIt) {
  for (const double z : {1.25, 1.0, 0.75}) {  // of the centre
    const Proximity crossing = proximity(Sphere{{0.5, 0.5, z}, 0.5}, cubeAt({0, 0, 0}));
    EXPECT_EQ(crossing.distance, z - 1.5);
    EXPECT_EQ(crossing.normal, Vector3d(0, 0, -1));
    EXPECT_EQ(crossing.point_on_first, Vector3d(0.5, 0.5, z - 0.5));
  }
}

TEST(Proximity, OfASphereWhoseCentreIsBarelyInsideHasTheNormalInto) {
  for (const double z : {1.0 + 0x1p-52, 1.0, 1.0 - 0x1p-53}) {  // lost beside the radius
    const Proximity crossing = proximity(Sphere{{0.5, 0.5, z}, 1.0}, cubeAt({0, 0, 0}));
    EXPECT_NEAR(crossing.distance, -1.0, 1e-15);
    EXPECT_EQ(crossing.normal, Vector3d(0, 0, -1));
  }
}

TEST(Proximity, OfMeshesIsUncertainWhereTheAccuracyDoesNotDecideIt) {
  const auto soup = std::make_shared<const CollisionMesh>(test::soup(500, 3));  // open
  std::size_t uncertain = 0;
  for (int i = 0; i < 20; ++i) {
    const RigidMesh first = {soup, Isometry3d(Eigen::Translation3d(1.0, 0.1 * i, 0))};
    const RigidMesh second = {soup, Isometry3d::Identity()};
    const Proximity greedy = proximity(first, second, Accuracy::greedy());
    if (greedy.colliding) continue;
    EXPECT_EQ(greedy.colliding_certain, greedy.lower_bound > 0.0);
    uncertain += greedy.colliding_certain ? 0 : 1;
  }
  EXPECT_GT(uncertain, 0U);
}

/// Solid and open meshes, one in the other or apart, and round shapes.
TEST(Proximity, OfFewLeavesHasBoundsThatHoldWithTheSign) {
  std::mt19937 generator(14);
  const auto mesh = [&](const TriangleMesh& surface) {
    return RigidMesh{std::make_shared<const CollisionMesh>(surface),
                     test::randomPose(generator, 0.5), false};
  };
  const auto scaled = [](const TriangleMesh& surface, double scale) {
    return test::placed(surface, scale, {0, 0, 0});
  };
  std::size_t inside = 0;
  for (std::size_t i = 0; i < queryCount(100); ++i) {
    const Vector3d place = test::randomPoint(generator, 1.0);
    const std::vector<Shape> shapes = {
        mesh(scaled(test::blob(4), 10.0)), mesh(scaled(test::blob(3), 2.0)),
        mesh(scaled(test::grid(4, 4), 0.05)), place, Sphere{0.5 * place, 0.1}};
    for (const Shape& first : shapes) {
      for (const Shape& second : shapes) {
        const Proximity exact = proximity(first, second);
        inside += exact.distance < 0.0 ? 1 : 0;
        for (const std::uint32_t leaves : {1U, 4U, 16U, 64U}) {
          const Proximity found = proximity(first, second, {0, 0, leaves});
          ASSERT_LE(found.lower_bound, exact.distance + kTolerance);
          ASSERT_GE(found.upper_bound, exact.distance - kTolerance);
          ASSERT_TRUE(found.distance == found.lower_bound || found.distance == found.upper_bound);
          ASSERT_TRUE(found.colliding == exact.colliding || !found.colliding_certain);
        }
      }
    }
  }
  EXPECT_GT(inside, 0U);
}

TEST(Proximity, RefusesWhatIsNotUsable) {
  const Shape point = Vector3d(0, 0, 0);
  const Shape unusable = Sphere{{0, 0, 0}, -1.0};
  EXPECT_THROW(proximity(unusable, point), std::invalid_argument);
  EXPECT_THROW(proximity(point, unusable), std::invalid_argument);
  EXPECT_THROW(proximity(point, point, {-1.0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(
      ProximityTracker().proximity(cubeAt({0, 0, 0}), 0.0, cubeAt({5, 0, 0}), 0.0, {-1.0, 0, 0}),
      std::invalid_argument);
}

// Random pairs.

Shape randomShape(std::mt19937& generator) {
  static const auto kBlob = std::make_shared<const CollisionMesh>(test::blob(2));
  const Vector3d start = test::randomPoint(generator, 0.3);
  const double radius = std::ldexp(0.2, -static_cast<int>(generator() % 6));
  switch (generator() % 5) {
    case 0:
      return start;
    case 1:
      return Sphere{start, radius};
    case 2:
      return Triangle{start, test::randomPoint(generator, 0.3), test::randomPoint(generator, 0.3)};
    case 3:
      return RigidMesh{kBlob, test::randomPose(generator, 0.3)};
    default:
      return Capsule{start, test::randomPoint(generator, 0.3), radius};
  }
}

TEST(Proximity, OfRoundShapesIsTheExactDistanceOfTheirCoresLessTheRadii) {
  std::mt19937 generator(81);
  for (std::size_t i = 0; i < queryCount(3000); ++i) {
    const Shape first = randomShape(generator);
    const Shape second = randomShape(generator);
    if (!roundShape(first) || !roundShape(second)) continue;
    const auto [core_1, radius_1] = *roundShape(first);
    const auto [core_2, radius_2] = *roundShape(second);
    const double expected =
        static_cast<double>(exact::distance(core_1, core_2)) - radius_1 - radius_2;
    const Proximity found = proximity(first, second);
    ASSERT_NEAR(found.distance, expected, kTolerance);
    ASSERT_EQ(found.colliding, found.distance <= 0);
    if (found.normal.isZero(0.0)) continue;
    ASSERT_NEAR((found.point_on_second - found.point_on_first).dot(found.normal), expected,
                kTolerance);
  }
}

TEST(Proximity, OfACoreThatCrossesAMeshHasTheNormalFromPointToPoint) {
  std::mt19937 generator(83);
  for (std::size_t crossing = 0; crossing < queryCount(100);) {
    const Shape first = randomShape(generator);
    const Shape second = randomShape(generator);
    if (!roundShape(first) || roundShape(second)) continue;
    const Proximity found = proximity(first, second);
    if (found.distance != -roundShape(first)->radius) continue;
    ++crossing;
    const Vector3d way = found.point_on_second - found.point_on_first;
    ASSERT_LE((way - found.distance * found.normal).norm(), kTolerance);
  }
}

TEST(Proximity, SwappedSwapsThePointsAndTurnsTheNormal) {
  std::mt19937 generator(82);
  for (std::size_t i = 0; i < queryCount(500); ++i) {
    const Shape first = randomShape(generator);
    const Shape second = randomShape(generator);
    const Proximity there = proximity(first, second);
    const Proximity back = swapped(proximity(second, first));
    ASSERT_NEAR(there.distance, back.distance, kTolerance);
    ASSERT_EQ(there.colliding, back.colliding);
    ASSERT_EQ(there.triangle_of_first.has_value(), back.triangle_of_first.has_value());
    if (there.distance < 0.0) continue;  // which of several crossings is told may differ
    ASSERT_NEAR((there.point_on_first - there.point_on_second).norm(),
                (back.point_on_first - back.point_on_second).norm(), kTolerance);
    if (there.distance < 1e-3) continue;  // [m] rounding turns shorter normals further
    constexpr double kTurn = 1e-9;        // of the normal; nearly parallel edges move the points
    ASSERT_NEAR((there.normal - back.normal).norm(), 0.0, kTurn);
  }
}

TEST(Proximity, MovingBothChangesNothingButRounding) {
  std::mt19937 generator(83);
  for (std::size_t i = 0; i < queryCount(500); ++i) {
    const Shape first = randomShape(generator);
    const Shape second = randomShape(generator);
    const Isometry3d pose = test::randomPose(generator, 1.0);
    const Proximity before = proximity(first, second);
    const Proximity after = proximity(transformed(first, pose), transformed(second, pose));
    ASSERT_NEAR(before.distance, after.distance, kTolerance);
    if (before.distance < 1e-3) continue;
    ASSERT_NEAR((pose.linear() * before.normal - after.normal).norm(), 0.0, 1e-9);
  }
}

TEST(ProximityTracker, FollowsAsIfItAskedAnew) {
  const auto mesh = std::make_shared<const CollisionMesh>(test::blob(3));
  const Capsule capsule{{0, 0, 0}, {0, 0, 0.1}, 0.01};
  ProximityTracker of_meshes;
  ProximityTracker of_a_mesh;
  std::mt19937 generator(93);
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = Vector3d(0.2, 0.1, 0.1);
  std::size_t apart = 0;
  for (std::size_t i = 0; i < queryCount(300); ++i) {
    pose.translation() += test::randomPoint(generator, 0.004);
    for (const Accuracy& accuracy : {Accuracy::exact(), Accuracy::greedy()}) {
      const RigidMesh first = {mesh, pose};
      const RigidMesh second = {mesh, Isometry3d::Identity()};
      const Proximity followed = of_meshes.proximity(first, 0.0, second, 0.0, accuracy);
      const Proximity asked = proximity(first, second, accuracy);
      ASSERT_EQ(followed.distance, asked.distance);
      ASSERT_EQ(followed.lower_bound, asked.lower_bound);
      ASSERT_EQ(followed.point_on_first, asked.point_on_first);
      ASSERT_EQ(followed.triangle_of_first, asked.triangle_of_first);
      ASSERT_EQ(followed.colliding_certain, asked.colliding_certain);
      apart += asked.distance > 0.0 ? 1 : 0;
      ASSERT_EQ(of_a_mesh.proximity(capsule, 0.0, first, 0.0, accuracy).distance,
                proximity(capsule, first, accuracy).distance);
    }
  }
  EXPECT_GT(apart, 0U);
}

}  // namespace
}  // namespace organ_collision::core
