// The nearest triangles of two surfaces whose answers are known.
// Against brute force: nearest_pair_truth_test.
#include "organ_collision/core/nearest_pair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>
#include <vector>

#include "organ_collision/core/contact.h"
#include "organ_collision/core/triangle_distance.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d at(double x, double y, double z) { return Isometry3d(Eigen::Translation3d(x, y, z)); }

TEST(NearestPair, OfTwoCubesIsBetweenTheFacesThatFaceEachOther) {
  const CollisionMesh first(test::cube(0.5));
  const CollisionMesh second(test::cube());
  const NearestPair apart = nearestPair(first, at(0.25, 0.25, 1.75), second);
  EXPECT_EQ(apart.nearest.distance, 0.75);
  EXPECT_TRUE(apart.nearest.isExact());
  EXPECT_TRUE(apart.nearest.distance_signed);
  EXPECT_EQ(apart.nearest.tip_point.z(), 1.75);
  EXPECT_EQ(nearestPair(first, at(0.25, 0.25, 1.0), second).nearest.distance, 0.0);
  EXPECT_EQ(nearestPair(first, at(0.25, 0.25, 0.75), second).nearest.distance, 0.0);
}

TEST(NearestPair, IsNegativeWhereOneIsInsideTheOther) {
  const CollisionMesh small(test::cube(0.25));
  const CollisionMesh large(test::cube());
  EXPECT_EQ(nearestPair(small, at(0.125, 0.375, 0.375), large).nearest.distance, -0.125);
  EXPECT_EQ(nearestPair(large, at(-0.125, -0.375, -0.375), small).nearest.distance, -0.125);
}

/// Rounding alone decides whether they meet, and on which side the vertices are that would: a flat
/// foot, told by its middle.
TEST(NearestPair, KnowsTheSideOfWhatStandsOnASurface) {
  std::mt19937 generator(98);
  const CollisionMesh organ(test::placed(test::cube(), 2.0, {-1, -1, -1}));
  std::size_t apart = 0;
  for (int i = 0; i < 2000; ++i) {
    const Isometry3d pose = test::randomPose(generator, 1.0);
    const double inwards = i % 2 == 0 ? -0.3 : 0.3;
    const Vector3d middle(0.1, 0.1, 1.0);
    Points points = {middle};
    std::vector<Corners> triangles;
    for (int k = 0; k < 6; ++k) {
      points.push_back(middle + 0.1 * Vector3d(std::cos(k * M_PI / 3), std::sin(k * M_PI / 3), 0));
      triangles.push_back(test::corners(0, 1 + k, 1 + (k + 1) % 6));
      triangles.push_back(test::corners(7, 1 + (k + 1) % 6, 1 + k));
    }
    points.push_back(middle + Vector3d(0, 0, inwards));
    for (Vector3d& point : points) point = pose * point;
    const CollisionMesh tool(TriangleMesh(points, triangles));
    const double distance = nearestPair(organ, pose, tool).nearest.distance;
    ASSERT_NEAR(distance, 0.0, 1e-15);
    apart += distance == 0.0 ? 0 : 1;
    ASSERT_TRUE(inwards < 0 ? distance <= 0.0 : distance >= 0.0) << i << ": " << distance;
  }
  EXPECT_GT(apart, 100);
}

TEST(NearestPair, HasASignWhereOneSurfaceIsOpen) {
  const CollisionMesh cube(test::cube(20.0));
  const CollisionMesh grid(test::grid(2, 2));
  for (const double x : {5.0, 25.0}) {
    const NearestTriangle of_cube = nearestPair(grid, at(x, 5, 5), cube).nearest;
    const NearestTriangle of_grid = nearestPair(cube, at(-x, -5, -5), grid).nearest;
    for (const NearestTriangle& nearest : {of_cube, of_grid}) {
      EXPECT_TRUE(nearest.distance_signed);
      EXPECT_EQ(nearest.distance, x < 20.0 ? -5.0 : 5.0);
    }
  }
}

TEST(NearestPair, HasASignWhereSurfacesMeet) {
  const CollisionMesh cube(test::cube());
  EXPECT_TRUE(nearestPair(cube, at(0.5, 0.5, 0.5), cube).nearest.distance_signed);
}

TEST(NearestPair, OfOpenSurfacesHasNoSign) {
  const CollisionMesh grid(test::grid(2, 2));
  const NearestPair pair = nearestPair(grid, at(0, 0, 0.5), grid);
  EXPECT_EQ(pair.nearest.distance, 0.5);
  EXPECT_FALSE(pair.nearest.distance_signed);
}

TEST(NearestPair, LooksAtNoMorePairsThanAllowed) {
  const CollisionMesh organ(test::blob(4));
  double last = std::numeric_limits<double>::infinity();
  for (const std::uint32_t pairs : {1U, 2U, 8U, 64U}) {
    const NearestPair pair = nearestPair(organ, at(0.2, 0.1, 0.3), organ, {0.0, 0.0, pairs});
    EXPECT_LE(pair.nearest.work.triangles, pairs);
    EXPECT_LE(pair.nearest.distance, last);
    last = pair.nearest.distance;
  }
  EXPECT_GT(nearestPair(organ, at(0.2, 0.1, 0.3), organ).nearest.work.triangles, 64U);
}

TEST(NearestPair, OfSurfacesInOtherGalaxiesIsRightButForRounding) {
  const CollisionMesh cube(test::cube());
  for (const double far : {1e20, 1e99}) {
    const NearestTriangle nearest = nearestPair(cube, at(far, -far, 0.0), cube).nearest;
    EXPECT_NEAR(nearest.distance, std::sqrt(2.0) * far, 4 * 0x1p-53 * std::sqrt(2.0) * far);
    EXPECT_TRUE(nearest.isExact());
  }
}

/// All pairs of triangles are about as near: to look at each would take seconds.
TEST(NearestPair, OfWhatIsTooFarOrTooLargeToTellTrianglesApartAsksNotAllPairs) {
  const CollisionMesh tool(test::blob(4));
  CollisionMesh astray = tool;
  astray.refit({VertexId{5}}, {{0x1p30, 0x1p29, 0.0}});
  const auto check = [&](const Isometry3d& pose, const CollisionMesh& organ, double least) {
    const NearestTriangle nearest = nearestPair(tool, pose, organ).nearest;
    EXPECT_LE(nearest.work.triangles, 100'000U);
    EXPECT_FALSE(nearest.isExact());
    EXPECT_LE(nearest.lower_bound, least * (1 + 1e-15));
    EXPECT_GE(nearest.upper_bound, least * (1 - 1e-15));
    PairTracker tracker;
    for (int i = 0; i < 2; ++i) {
      const NearestTriangle tracked = tracker.nearestPair(tool, 0.0, pose, organ, 0.0).nearest;
      EXPECT_EQ(tracked.distance, nearest.distance);
      EXPECT_EQ(tracked.lower_bound, nearest.lower_bound);
      EXPECT_EQ(tracked.upper_bound, nearest.upper_bound);
    }
  };
  const Box& box = tool.health().box;
  check(at(0x1p46, 0.0, 0.0), tool, 0x1p46 - (box.high - box.low).x());
  check(at(0.0, 0.0, 3.0), astray, nearestPair(tool, at(0.0, 0.0, 3.0), tool).nearest.distance);
}

/// Of all pairs of their triangles.
double leastDistance(const CollisionMesh& first, const Isometry3d& pose,
                     const CollisionMesh& second) {
  double least = std::numeric_limits<double>::infinity();
  for (const Corners& corners : first.mesh().triangles()) {
    const auto [a, b, c] = first.mesh().triangle(corners);
    for (const Corners& others : second.mesh().triangles())
      least = std::min(least,
                       closestPoints({pose * a, pose * b, pose * c}, second.mesh().triangle(others))
                           .on_second.squared_distance);
  }
  return std::sqrt(least);
}

/// Beside the large one, what is small has sizes of which no square is a double.
TEST(NearestPair, ProvesNothingOfWhatIsInTheMiddleOfAnOrganOf2To500OfItsSizes) {
  std::mt19937 generator(3);
  for (const auto& [large, small] : {std::pair(1e150, 1e-5), std::pair(1e6, 1e-149)}) {
    const CollisionMesh tool(test::placed(test::blob(1), small, {0, 0, 0}));
    for (int i = 0; i < 50; ++i) {
      Points positions = test::blob(2).positions();
      const Eigen::Matrix3d turn = large * test::randomPose(generator, 0.0).linear();
      for (Eigen::Vector3d& position : positions) position = turn * position;
      const CollisionMesh organ({positions, test::blob(2).triangles()});
      const Box& box = organ.health().box;
      const Isometry3d pose(Eigen::Translation3d(0.5 * box.low + 0.5 * box.high));
      const double least = leastDistance(tool, pose, organ);
      for (const Accuracy& accuracy : {Accuracy{}, Accuracy{0.0, 0.0, 2}, Accuracy{0.0, 0.0, 1000}})
        for (const NearestTriangle& nearest :
             {nearestPair(tool, pose, organ, accuracy).nearest,
              nearestPair(organ, pose.inverse(), tool, accuracy).nearest}) {
          ASSERT_EQ(std::max(nearest.lower_bound, -nearest.upper_bound), 0.0);
          ASSERT_GE(std::abs(nearest.distance), least * (1 - 1e-12));
        }
    }
  }
}

/// Where it is as good as a point, the nearest triangle to it is looked for before the pose.
TEST(NearestPair, BoundsWhatAPoseThatStretchesMakesOfATinySurfaceFarAway) {
  std::mt19937 generator(2);
  const CollisionMesh organ(test::blob(2));
  const CollisionMesh tiny(test::placed(test::cube(), 1e-19, {0, 0, 0}));
  for (int i = 0; i < 300; ++i) {
    const Eigen::Matrix3d turn = test::randomPose(generator, 0.0).linear();
    Isometry3d pose = test::randomPose(generator, 1.0);
    pose.translation() *= 0.3 / pose.translation().norm();
    const bool stretches = i % 2 == 0;
    if (stretches) pose.linear() *= turn * Vector3d(1.03, 1, 1).asDiagonal() * turn.transpose();
    const NearestTriangle nearest = nearestPair(organ, pose, tiny).nearest;
    const double least = leastDistance(organ, pose, tiny) * (1 + 1e-14);
    ASSERT_LE(std::max(nearest.lower_bound, -nearest.upper_bound), least);
    ASSERT_EQ(nearest.isExact(), !stretches);
  }
}

/// As of a simulation that blew up: beside it the other surface is no more than a point.
TEST(NearestPair, ProvesNothingOfASurfaceWithAVertexInAnotherGalaxy) {
  std::mt19937 generator(12);
  const CollisionMesh tool(test::placed(test::blob(1), 0.5, {0, 0, 0}));
  for (int i = 0; i < 100; ++i) {
    CollisionMesh organ(test::blob(2));
    organ.refit({static_cast<VertexId>(generator() % 66)}, {{1e18, 3e17, -2e17}});
    const Isometry3d pose = test::randomPose(generator, 1.0);
    const double least = leastDistance(tool, pose, organ);
    for (const NearestTriangle& nearest : {nearestPair(tool, pose, organ).nearest,
                                           nearestPair(organ, pose.inverse(), tool).nearest}) {
      ASSERT_EQ(nearest.lower_bound, 0.0);
      ASSERT_GE(nearest.upper_bound, least - 1e-15);
    }
    const RigidMesh shape{std::make_shared<const CollisionMesh>(tool), pose};
    const Contact touching = contact(organ, Shape(shape));
    ASSERT_TRUE(least > 0.0 || touching.colliding || !touching.colliding_certain);
  }
}

TEST(NearestPair, RefusesAnAccuracyBelowZero) {
  const CollisionMesh cube(test::cube());
  EXPECT_THROW(nearestPair(cube, at(3, 0, 0), cube, {-0.1, 0, 0}), std::invalid_argument);
}

TEST(NearestPair, RefusesAPoseThatIsNotRigid) {
  const CollisionMesh cube(test::cube());
  Isometry3d pose = at(0, 0, 3);
  pose.linear() *= 1.001;  // a quaternion of single precision may be that wrong
  EXPECT_NEAR(nearestPair(cube, pose, cube).nearest.distance, 2.0, 1e-12);
  pose.linear() *= 2.0;
  EXPECT_THROW(nearestPair(cube, pose, cube), std::invalid_argument);
  pose = at(0, 0, std::numeric_limits<double>::infinity());
  EXPECT_THROW(nearestPair(cube, pose, cube), std::invalid_argument);
  pose = at(0, 0, 1e155);  // its square overflows
  EXPECT_THROW(nearestPair(cube, pose, cube), std::invalid_argument);
  pose = at(0, 0, 3);
  pose.linear()(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(nearestPair(cube, pose, cube), std::invalid_argument);
}

TEST(Contact, OfAMeshCollidesWhereSolidsMeet) {
  const auto jaw = std::make_shared<const CollisionMesh>(test::cube(0.25));
  const CollisionMesh organ(test::cube());
  const auto touches = [&](const Isometry3d& pose) {
    const Contact found = contact(organ, RigidMesh{jaw, pose});
    EXPECT_TRUE(found.colliding_certain);
    return found.colliding;
  };
  EXPECT_FALSE(touches(at(0.5, 0.5, 1.125)));
  EXPECT_TRUE(touches(at(0.5, 0.5, 1.0)));
  EXPECT_TRUE(touches(at(0.5, 0.5, 0.875)));
  EXPECT_TRUE(touches(at(0.5, 0.5, 0.5)));
}

TEST(NearestPair, OfASpeckAndAnOrganIsExact) {
  std::mt19937 generator(91);
  const CollisionMesh organ(test::blob(3));
  for (const int exponent : {-50, -59, -61, -70, -300, -1000}) {
    const CollisionMesh speck(test::cube(std::ldexp(1.0, exponent)));
    for (int i = 0; i < 50; ++i) {
      Isometry3d pose = Isometry3d::Identity();
      pose.translation() =
          i == 0 ? organ.wideTree().frame().centre : test::randomPoint(generator, 2.0);
      const double expected = std::abs(nearestTriangle(organ, pose.translation()).distance);
      const double slack = 1e-14 + 2 * std::ldexp(1.0, exponent);
      ASSERT_NEAR(std::abs(nearestPair(speck, pose, organ).nearest.distance), expected, slack);
      ASSERT_NEAR(std::abs(nearestPair(organ, pose.inverse(), speck).nearest.distance), expected,
                  slack);
      for (const std::uint32_t pairs : {1U, 3U, 64U}) {
        ASSERT_LE(nearestPair(speck, pose, organ, {0, 0, pairs}).nearest.lower_bound,
                  expected + slack);
        ASSERT_LE(nearestPair(organ, pose.inverse(), speck, {0, 0, pairs}).nearest.lower_bound,
                  expected + slack);
      }
    }
  }
}

TEST(NearestPair, KnowsTheInsideThroughAPoseThatIsNotQuiteRigid) {
  Isometry3d stretched = Isometry3d::Identity();
  stretched.linear() *= 1.01;
  const CollisionMesh first(test::placed(test::cube(), 1.0, {100, 0, 0}));
  const CollisionMesh second(test::placed(test::cube(), 0.1, {101.4, 0.45, 0.45}));
  EXPECT_LT(nearestPair(first, stretched, second).nearest.distance, 0.0);
}

/// Say, of a simulator that has set no vertex yet.
TEST(NearestPair, OfSurfacesThatAreNoMoreThanPointsAsksOnePair) {
  const auto shrunk = [](std::size_t levels) {
    CollisionMesh organ(test::blob(levels));
    organ.refit(Points(organ.mesh().positions().size(), Vector3d(0, 0, 0)));
    return organ;
  };
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = Vector3d(3, 4, 0);
  const CollisionMesh first = shrunk(5);
  const CollisionMesh second = shrunk(4);
  const NearestPair pair = nearestPair(first, pose, second);
  EXPECT_EQ(pair.nearest.distance, 5.0);
  EXPECT_EQ(pair.triangle_of_first, first.tree().triangle(0));
  EXPECT_EQ(pair.nearest.triangle, second.tree().triangle(0));
  EXPECT_LE(pair.nearest.work.triangles, 2U);
  PairTracker tracker;
  EXPECT_EQ(tracker.nearestPair(first, {}, pose, second, {}).nearest.distance, 5.0);
}

}  // namespace
}  // namespace organ_collision::core
