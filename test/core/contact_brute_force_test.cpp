// Contacts against brute force.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "brute_force.h"
#include "organ_collision/core/closest_point.h"
#include "organ_collision/core/contact.h"
#include "organ_collision/core/sign.h"
#include "organ_collision/core/triangle_distance.h"
#include "organs_and_tips.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector3d;

/// Separated, touching, crossing and deep: from a point to larger than the organ.
Shape randomRound(std::mt19937& generator, const CollisionMesh& organ) {
  const double size = (organ.health().box.high - organ.health().box.low).maxCoeff();
  const Vector3d start = test::randomTip(generator, organ);
  const double radius =
      size * std::ldexp(1.0, -static_cast<int>(generator() % 12)) * (generator() % 5 == 0 ? 0 : 1);
  switch (generator() % 4) {
    case 0:
      return Sphere{start, radius};
    case 1:
      return Capsule{start, start, radius};
    case 2:
      return Capsule{start, test::randomTip(generator, organ), radius};
    default:
      return Capsule{start, start + test::randomPoint(generator, 0.2 * size), radius};
  }
}

double truth(const CollisionMesh& organ, const RoundShape& shape) {
  const auto& [core, radius] = shape;
  const double squared = core.a == core.b ? test::squaredDistanceByBruteForce(organ.mesh(), core.a)
                                          : test::squaredDistanceByBruteForce(organ.mesh(), core);
  const bool inside =
      squared > 0.0 && organ.health().isSolid() && windingNumber(organ, core.a) != 0;
  return (inside ? -std::sqrt(squared) : std::sqrt(squared)) - radius;
}

/// As it is told: without a sign, what overlaps is as near as can be.
double told(double distance, const CollisionMesh& organ) {
  return organ.health().isSolid() ? distance : std::max(distance, 0.0);
}

/// 4*u*extent [m] of the shape seen from the organ, and its radius.
double roundingOf(const CollisionMesh& organ, const RoundShape& shape) {
  return test::rounding(organ, shape.core.a) + test::rounding(organ, shape.core.b) +
         4 * 0x1p-53 * shape.radius;
}

TEST(Contact, OfRoundShapesEqualsBruteForceBitForBit) {
  std::mt19937 generator(71);
  for (const CollisionMesh& organ : test::organs()) {
    for (std::size_t i = 0; i < test::queryCount(150); ++i) {
      const Shape shape = randomRound(generator, organ);
      const Contact found = contact(organ, shape);
      const double exact = truth(organ, *roundShape(shape));
      const double expected = told(exact, organ);
      ASSERT_EQ(found.nearest.distance, expected);
      ASSERT_EQ(found.nearest.lower_bound, expected);
      ASSERT_EQ(found.nearest.upper_bound, expected);
      ASSERT_EQ(found.colliding, exact <= 0.0);
      ASSERT_TRUE(found.colliding_certain);
    }
  }
}

/// Of many parts that are as good as equally far none may be left out for a rounded one.
TEST(Contact, OfPointsFarFromTheSmallestPartsEqualsBruteForceBitForBit) {
  std::mt19937 generator(86);
  for (std::size_t i = 0; i < test::queryCount(300); ++i) {
    const Eigen::Isometry3d pose = test::randomPose(generator, 1.0);
    Points positions = test::halvings(30).positions();  // from 1 m on towards the origin
    for (Vector3d& position : positions) position = pose * position;
    const CollisionMesh organ({positions, test::halvings(30).triangles()});
    const double far = std::ldexp(1.0, static_cast<int>(generator() % 20));
    const Vector3d tip = pose * (far * (Vector3d(-2, 0, 0) + test::randomPoint(generator, 1.0)));
    ASSERT_EQ(std::abs(contact(organ, tip).nearest.distance),
              std::sqrt(test::squaredDistanceByBruteForce(organ.mesh(), tip)));
  }
}

TEST(Contact, OfAnAxisThatMeetsSeveralTrianglesNamesTheFirstInTheHierarchysOrder) {
  std::mt19937 generator(83);
  std::size_t meeting = 0;
  for (const CollisionMesh& organ : test::organs()) {
    for (std::size_t i = 0; i < test::queryCount(60); ++i) {
      const auto through = [&] {
        return centroid(
            organ.mesh().triangle(TriangleId(generator() % organ.mesh().triangleCount())));
      };
      const Vector3d a = through();
      const Vector3d b = generator() % 2 == 0 ? test::randomTip(generator, organ) : through();
      const Vector3d beyond = generator() % 4 == 0 ? b : Vector3d(b + (b - a));
      const Triangle axis = {a, beyond, beyond};
      double least = std::numeric_limits<double>::infinity();
      TriangleId expected{0};
      for (std::size_t leaf = 0; leaf < organ.mesh().triangleCount(); ++leaf) {
        const TriangleId triangle = organ.tree().triangle(FarthestPairTree::Leaf(leaf));
        const double squared =
            closestPoints(axis, organ.mesh().triangle(triangle)).on_second.squared_distance;
        if (squared >= least) continue;
        least = squared;
        expected = triangle;
      }
      ASSERT_EQ(contact(organ, Capsule{a, beyond, 0.5}).nearest.triangle, expected);
      meeting += least == 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(meeting, test::queryCount(60));
}

/// From grazing to where squares of distances underflow in single precision.
TEST(Contact, OfTipsThatAlmostTouchEqualsBruteForceBitForBit) {
  std::mt19937 generator(79);
  for (const CollisionMesh& organ : test::organs()) {
    const double size = (organ.health().box.high - organ.health().box.low).maxCoeff();
    for (std::size_t i = 0; i < test::queryCount(150); ++i) {
      const double step = std::ldexp(size, -static_cast<int>(generator() % 160));
      const Vector3d a =
          organ.mesh().position(VertexId(generator() % 3)) + test::randomPoint(generator, step);
      const Vector3d b = a + test::randomPoint(generator, generator() % 2 == 0 ? step : size);
      const Vector3d c = a + test::randomPoint(generator, generator() % 2 == 0 ? step : size);
      for (const Triangle& tip : {Triangle{a, b, b}, Triangle{a, b, c}}) {
        const double squared = test::squaredDistanceByBruteForce(organ.mesh(), tip);
        ASSERT_EQ(std::abs(contact(organ, tip).nearest.distance), std::sqrt(squared));
      }
    }
  }
}

TEST(Contact, HasItsPointOnTheSurfaceOfTheShapeAtTheDistanceToldFromTheOrgans) {
  std::mt19937 generator(72);
  for (const CollisionMesh& organ : test::organs()) {
    for (std::size_t i = 0; i < test::queryCount(150); ++i) {
      const Shape shape = randomRound(generator, organ);
      const RoundShape round = *roundShape(shape);
      const NearestTriangle nearest = contact(organ, shape).nearest;
      const double coordinates = nearest.tip_point.norm() + round.radius + round.core.b.norm();
      const double slack = 2 * roundingOf(organ, round) + 8 * 0x1p-53 * coordinates;
      const double to_core =
          std::sqrt(closestPointOnTriangle(nearest.tip_point, round.core).squared_distance);
      ASSERT_NEAR(to_core, round.radius, slack);
      const bool may_be_beside_an_end =
          nearest.distance < -round.radius && round.core.a != round.core.b;
      if (may_be_beside_an_end) continue;
      const double depth_or_gap =
          nearest.distance_signed ? nearest.distance : nearest.closest.offset.norm() - round.radius;
      ASSERT_NEAR((nearest.tip_point - nearest.closest.point).norm(), std::abs(depth_or_gap),
                  slack);
    }
  }
}

TEST(Contact, BoundsOfRoundShapesHoldTheTruthAtEverySetting) {
  const std::vector<Accuracy> settings = {{0, 0, 1},    {0, 0, 8},    {0.5, 0, 0},     {0.1, 0, 0},
                                          {0.01, 0, 0}, {0, 1e-2, 0}, {0.05, 1e-3, 16}};
  std::mt19937 generator(73);
  for (const CollisionMesh& organ : test::organs()) {
    for (std::size_t i = 0; i < test::queryCount(100); ++i) {
      const Shape shape = randomRound(generator, organ);
      const RoundShape round = *roundShape(shape);
      const double exact = truth(organ, round);
      const double slack = roundingOf(organ, round);
      for (const Accuracy& accuracy : settings) {
        const Contact found = contact(organ, shape, accuracy);
        const double expected = found.nearest.distance_signed
                                    ? exact
                                    : std::max(std::abs(exact + round.radius) - round.radius, 0.0);
        ASSERT_LE(found.nearest.lower_bound, expected + slack);
        ASSERT_GE(found.nearest.upper_bound, expected - slack);
        if (found.nearest.distance_signed) {
          ASSERT_TRUE((found.nearest.distance < 0.0) == (exact < 0.0) || std::abs(exact) <= slack);
        }
        if (found.colliding_certain) {
          ASSERT_TRUE(found.colliding == (exact <= 0.0) || std::abs(exact) <= slack);
        }
        if (accuracy.max_leaves != 0 || exact < slack) continue;
        ASSERT_LE(found.nearest.distance,
                  exact + slack +
                      std::max(accuracy.max_relative_error * exact, accuracy.max_absolute_error));
      }
    }
  }
}

TEST(Contact, MovingBothChangesNothingButRounding) {
  std::mt19937 generator(74);
  for (const CollisionMesh& organ : test::organs()) {
    const Eigen::Isometry3d pose = test::randomPose(generator, 1.0);
    Points positions = organ.mesh().positions();
    for (Vector3d& position : positions) position = pose * position;
    const CollisionMesh moved({positions, organ.mesh().triangles()});
    for (std::size_t i = 0; i < test::queryCount(150); ++i) {
      const Shape shape = randomRound(generator, organ);
      const Contact before = contact(organ, shape);
      const Contact after = contact(moved, transformed(shape, pose));
      const RoundShape round = *roundShape(shape);
      constexpr double kRoundings = 8;  // of each of some products and sums in a moved coordinate
      const double slack =
          kRoundings * roundingOf(organ, round) +
          kRoundings * 4 * 0x1p-53 * (round.core.b.norm() + pose.translation().norm());
      ASSERT_NEAR(before.nearest.distance, after.nearest.distance, slack);
      ASSERT_TRUE(before.colliding == after.colliding ||
                  std::abs(before.nearest.distance) <= slack);
    }
  }
}

}  // namespace
}  // namespace organ_collision::core
