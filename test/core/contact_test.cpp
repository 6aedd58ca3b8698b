#include "organ_collision/core/contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <vector>

#include "brute_force.h"
#include "organ_collision/core/sign.h"
#include "organ_collision/core/triangle_distance.h"
#include "organs_and_tips.h"
#include "test_meshes.h"

namespace {
thread_local std::size_t allocations = 0;
}  // namespace

// Not inlined, or gcc finds free() where it expects delete.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  void* const memory = std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  ++allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}

namespace organ_collision::core {
namespace {

using Eigen::Vector3d;

Triangle tipAt(const Eigen::Vector3d& corner) {
  return {corner, corner + Eigen::Vector3d(0.1, 0, 0), corner + Eigen::Vector3d(0, 0.1, 0)};
}

TEST(Contact, OfAPointCollidesInsideAndOnTheSurfaceOfASolid) {
  const CollisionMesh cube(test::cube());
  for (const double z : {0.5, 0.0, 1.0}) {
    const Contact touching = contact(cube, Eigen::Vector3d(0.5, 0.5, z));
    EXPECT_TRUE(touching.colliding);
    EXPECT_TRUE(touching.colliding_certain);
  }
  const Contact apart = contact(cube, Eigen::Vector3d(0.5, 0.5, 1.0 + 1e-9));
  EXPECT_FALSE(apart.colliding);
  EXPECT_TRUE(apart.colliding_certain);
}

TEST(Contact, OfATriangleCollidesWhenItCrossesTouchesOrIsInside) {
  const CollisionMesh cube(test::cube());
  EXPECT_TRUE(contact(cube, tipAt({0.5, 0.5, 0.5})).colliding);  // wholly inside
  EXPECT_LT(contact(cube, tipAt({0.5, 0.5, 0.5})).nearest.distance, 0.0);
  EXPECT_TRUE(contact(cube, tipAt({0.95, 0.5, 0.5})).colliding);  // through a face
  EXPECT_TRUE(contact(cube, tipAt({0.5, 0.5, 1.0})).colliding);   // flat on a face
  EXPECT_TRUE(contact(cube, tipAt({1.0, 1.0, 1.0})).colliding);   // by a vertex
  const Contact apart = contact(cube, tipAt({0.5, 0.5, 1.5}));
  EXPECT_FALSE(apart.colliding);
  EXPECT_EQ(apart.nearest.distance, 0.5);
}

TEST(Contact, WithAnOpenSurfaceIsTouchingIt) {
  const CollisionMesh grid(test::grid(4, 4));
  EXPECT_TRUE(contact(grid, Eigen::Vector3d(1.3, 2.2, 0.0)).colliding);
  const Contact below = contact(grid, Eigen::Vector3d(1.3, 2.2, -0.5));
  EXPECT_FALSE(below.colliding);
  EXPECT_TRUE(below.colliding_certain);
}

TEST(Contact, IsUncertainWhereTheAccuracyDoesNotDecideIt) {
  const CollisionMesh organ(test::blob(4));
  const Contact greedy = contact(organ, Eigen::Vector3d(0, 0, 0), Accuracy::greedy());
  EXPECT_FALSE(greedy.colliding);
  EXPECT_FALSE(greedy.colliding_certain);
  EXPECT_TRUE(contact(organ, Eigen::Vector3d(1, 1, 1), Accuracy::greedy()).colliding_certain);
  EXPECT_TRUE(contact(organ, Eigen::Vector3d(0, 0, 0)).colliding_certain);
}

TEST(Contact, AllocatesNothingOnceTheThreadHasSeenItsWidestSearch) {
  const CollisionMesh organ(test::blob(4));
  std::mt19937 generator(1);
  Points tips(500);
  for (Eigen::Vector3d& tip : tips) tip = test::randomPoint(generator, 0.15);
  const auto askAll = [&] {
    const std::size_t before = allocations;
    for (const Eigen::Vector3d& tip : tips) {
      contact(organ, tip);
      contact(organ, tip, Accuracy::greedy());
      contact(organ, tipAt(tip));
    }
    return allocations - before;
  };
  askAll();
  EXPECT_EQ(askAll(), 0);
}

// What follows is said of the cube [0, 1]^3 and can be checked by hand.

TEST(Contact, OfASphereIsThatOfItsCentreLessTheRadius) {
  const CollisionMesh cube(test::cube());
  const Contact apart = contact(cube, Sphere{{0.5, 0.5, 3.0}, 0.5});
  EXPECT_EQ(apart.nearest.distance, 1.5);
  EXPECT_EQ(apart.nearest.tip_point, Vector3d(0.5, 0.5, 2.5));
  EXPECT_FALSE(apart.colliding);
  const Contact touching = contact(cube, Sphere{{0.5, 0.5, 1.5}, 0.5});
  EXPECT_EQ(touching.nearest.distance, 0.0);
  EXPECT_TRUE(touching.colliding);
  const Contact crossing = contact(cube, Sphere{{0.5, 0.5, 1.25}, 0.5});
  EXPECT_EQ(crossing.nearest.distance, -0.25);
  EXPECT_EQ(crossing.nearest.tip_point, Vector3d(0.5, 0.5, 0.75));
  const Contact deep = contact(cube, Sphere{{0.5, 0.5, 0.75}, 0.5});
  EXPECT_EQ(deep.nearest.distance, -0.75);
  EXPECT_EQ(deep.nearest.tip_point, Vector3d(0.5, 0.5, 0.25));
  EXPECT_TRUE(deep.colliding_certain);
}

TEST(Contact, OfACapsuleIsThatOfItsAxisLessTheRadius) {
  const CollisionMesh cube(test::cube());
  const Contact beside = contact(cube, Capsule{{2.0, 0.5, -5.0}, {2.0, 0.5, 5.0}, 0.25});
  EXPECT_EQ(beside.nearest.distance, 0.75);
  EXPECT_EQ(beside.nearest.tip_point.x(), 1.75);
  const Contact above = contact(cube, Capsule{{0.5, 0.5, 1.5}, {0.5, 0.5, 9.0}, 0.25});
  EXPECT_EQ(above.nearest.distance, 0.25);
  EXPECT_EQ(above.nearest.tip_point, Vector3d(0.5, 0.5, 1.25));
  const Contact inside = contact(cube, Capsule{{0.5, 0.5, 0.25}, {0.5, 0.5, 0.875}, 0.125});
  EXPECT_EQ(inside.nearest.distance, -0.25);
  EXPECT_EQ(inside.nearest.tip_point.z(), 0.875);  // the end towards the surface; beside it
  EXPECT_NEAR((inside.nearest.tip_point - Vector3d(0.5, 0.5, 0.875)).norm(), 0.125, 1e-15);
}

TEST(Contact, OfACapsuleWhoseAxisCrossesTheSurfaceIsMinusItsRadius) {
  const CollisionMesh cube(test::cube());
  const Capsule through{{0.5, 0.5, 0.5}, {0.5, 0.5, 1.5}, 0.25};  // square to the face
  const Contact crossing = contact(cube, through);
  EXPECT_EQ(crossing.nearest.distance, -0.25);
  EXPECT_TRUE(crossing.colliding_certain);
  EXPECT_EQ(crossing.nearest.tip_point.z(), 1.0);
  EXPECT_NEAR((crossing.nearest.tip_point - Vector3d(0.5, 0.5, 1.0)).norm(), 0.25, 1e-15);
}

TEST(Contact, OfARoundShapeWithAnOpenSurfaceIsTouchingIt) {
  const CollisionMesh grid(test::grid(4, 4));
  const Contact below = contact(grid, Sphere{{1.3, 2.2, -0.5}, 0.25});
  EXPECT_FALSE(below.colliding);
  EXPECT_TRUE(below.colliding_certain);
  EXPECT_TRUE(contact(grid, Sphere{{1.3, 2.2, -0.5}, 0.5}).colliding);
  const Contact pierced = contact(grid, Sphere{{1.3, 2.2, -0.25}, 1.0});
  EXPECT_EQ(pierced.nearest.distance, -0.75);
  EXPECT_EQ(pierced.nearest.tip_point.z(), 0.75);
}

TEST(Contact, OfABallAroundTheWholeOrganIsACollision) {
  const CollisionMesh cube(test::cube());
  const Contact around = contact(cube, Sphere{{0.5, 0.5, 1.5}, 10.0});
  EXPECT_EQ(around.nearest.distance, 0.5 - 10.0);
  EXPECT_TRUE(around.colliding_certain);
}

TEST(Contact, OfATriangleThatPiercesElsewhereIsUncertainWhereTheSearchStoppedEarly) {
  const CollisionMesh organ(test::blob(4));
  // One corner far outside, so that the greedy answer's point is outside the organ's box.
  const Triangle spear{{0.0, 0.0, 0.01}, {0.001, 0.0, 0.01}, {0.9, 0.9, 0.9}};
  const Contact greedy = contact(organ, spear, Accuracy::greedy());
  EXPECT_TRUE(greedy.colliding || !greedy.colliding_certain);
  EXPECT_TRUE(contact(organ, spear).colliding);
}

TEST(Contact, RefusesShapesThatAreNotUsable) {
  const CollisionMesh cube(test::cube());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(contact(cube, Sphere{{0, 0, 0}, -1e-9}), std::invalid_argument);
  EXPECT_THROW(contact(cube, Sphere{{0, 0, 0}, nan}), std::invalid_argument);
  EXPECT_THROW(contact(cube, Sphere{{0, nan, 0}, 1}), std::invalid_argument);
  EXPECT_THROW(contact(cube, Capsule{{0, 0, 0}, {0, 0, nan}, 1}), std::invalid_argument);
  EXPECT_THROW(contact(cube, Capsule{{0, 0, 0}, {0, 0, 1}, 1e200}), std::invalid_argument);
  EXPECT_THROW(contact(cube, RigidMesh{nullptr, Eigen::Isometry3d::Identity()}),
               std::invalid_argument);
}

TEST(ContactTracker, FollowsAllPiecesAsIfItAskedAnew) {
  const CollisionMesh organ(test::blob(4));
  const Shapes shapes = {Vector3d(0, 0, 0.02), Sphere{{0, 0, 0.01}, 0.01},
                         Capsule{{0, 0, 0}, {0, 0, 0.2}, 0.004}, tipAt({0, 0.01, 0}),
                         RigidMesh{std::make_shared<const CollisionMesh>(test::cube(0.01)),
                                   Eigen::Isometry3d(Eigen::Translation3d(0, 0.02, 0))}};
  ContactTracker tracker;
  std::mt19937 generator(35);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 300; ++i) {
    pose = pose * test::randomPose(generator, 0.0);
    pose.translation() += test::randomPoint(generator, i % 50 == 0 ? 0.1 : 0.001);
    for (const Accuracy& accuracy : {Accuracy::exact(), Accuracy::greedy()}) {
      const Contact tracked = tracker.contact(organ, {}, shapes, pose, accuracy);
      const Contact asked = contact(organ, shapes, pose, accuracy);
      ASSERT_EQ(tracked.nearest.distance, asked.nearest.distance);
      ASSERT_EQ(tracked.nearest.lower_bound, asked.nearest.lower_bound);
      ASSERT_EQ(tracked.nearest.triangle, asked.nearest.triangle);
      ASSERT_EQ(tracked.colliding, asked.colliding);
      ASSERT_EQ(tracked.colliding_certain, asked.colliding_certain);
    }
  }
}

TEST(Contact, OfSeveralPiecesIsThatOfTheNearest) {
  const CollisionMesh cube(test::cube());
  const Eigen::Isometry3d up(Eigen::Translation3d(0, 0, 2));
  const Shapes shapes = {Sphere{{0.5, 0.5, 3.0}, 0.5}, Vector3d(0.5, 0.5, 0.25),
                         Capsule{{5, 0, 0}, {5, 0, 1}, 1.0}};
  const Contact whole = contact(cube, shapes, up);
  EXPECT_EQ(whole.nearest.distance, 1.25);
  EXPECT_EQ(whole.nearest.tip_point, Vector3d(0.5, 0.5, 2.25));
  EXPECT_TRUE(whole.nearest.isExact());
  EXPECT_TRUE(whole.colliding_certain);
  EXPECT_GT(whole.nearest.work.triangles, contact(cube, shapes[1]).nearest.work.triangles);
  EXPECT_TRUE(contact(cube, shapes, Eigen::Isometry3d::Identity()).colliding);
}

TEST(Contact, OfSeveralPiecesIsCertainIfOneCollidesOrAllAreCertain) {
  const CollisionMesh organ(test::blob(4));
  const Shape unsure = Vector3d(0, 0, 0);
  const Shape away = Vector3d(1, 1, 1);
  const Shape on = organ.mesh().position(VertexId{7});
  const auto greedy = [&](const Shapes& shapes) {
    return contact(organ, shapes, Eigen::Isometry3d::Identity(), Accuracy::greedy());
  };
  EXPECT_FALSE(greedy({away, unsure}).colliding_certain);
  const Shape just_outside = Vector3d(0, 0, 0.07);
  EXPECT_TRUE(greedy({just_outside}).nearest.distance_signed);
  EXPECT_FALSE(greedy({just_outside, unsure}).nearest.distance_signed);
  EXPECT_EQ(greedy({just_outside, unsure}).nearest.distance,
            greedy({just_outside}).nearest.distance);
  EXPECT_TRUE(greedy({away, away}).colliding_certain);
  EXPECT_TRUE(greedy({unsure, Sphere{{0, 0, 0}, 1.0}}).colliding_certain);
  EXPECT_TRUE(contact(organ, {away, on}, Eigen::Isometry3d::Identity()).colliding_certain);
}

// Against brute force.

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
      const double expected = truth(organ, *roundShape(shape));
      ASSERT_EQ(found.nearest.distance, expected);
      ASSERT_EQ(found.nearest.lower_bound, expected);
      ASSERT_EQ(found.nearest.upper_bound, expected);
      ASSERT_EQ(found.colliding, expected <= 0.0);
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
      ASSERT_NEAR((nearest.tip_point - nearest.closest.point).norm(), std::abs(nearest.distance),
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
        const bool known = found.nearest.distance_signed || !organ.health().isSolid();
        const double expected = known ? exact : std::abs(exact + round.radius) - round.radius;
        ASSERT_LE(found.nearest.lower_bound, expected + slack);
        ASSERT_GE(found.nearest.upper_bound, expected - slack);
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
