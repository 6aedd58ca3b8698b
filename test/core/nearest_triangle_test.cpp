#include "organ_collision/core/nearest_triangle.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "brute_force.h"
#include "paper_hierarchy.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using test::randomPoint;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kUnitRoundoff = 0x1p-53;

/// All kinds of surfaces: closed, open, flat with ties everywhere, broken.
const std::vector<CollisionMesh>& organs() {
  static const std::vector<CollisionMesh> all = {
      CollisionMesh(test::cube()),
      CollisionMesh(test::grid(8, 8)),
      CollisionMesh(test::grid(38, 39)),
      CollisionMesh(test::row(101)),
      CollisionMesh(test::blob(4)),
      CollisionMesh(test::soup(500, 3)),
      CollisionMesh(TriangleMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {test::corners(0, 1, 2)}))};
  return all;
}

/// Near, on and far from the organ, some on its vertices and centroids, where ties are.
Eigen::Vector3d randomTip(std::mt19937& generator, const CollisionMesh& organ) {
  const Box& box = organ.health().box;
  const double size = (box.high - box.low).maxCoeff();
  const Points& positions = organ.mesh().positions();
  const Eigen::Vector3d vertex = positions[generator() % positions.size()];
  const auto triangle = static_cast<TriangleId>(generator() % organ.mesh().triangleCount());
  switch (generator() % 6) {
    case 0:
      return vertex;
    case 1:
      return centroid(organ.mesh().triangle(triangle));
    case 2:
      return vertex + randomPoint(generator, 0.01 * size);
    case 3:
      return 0.5 * (box.low + box.high) + randomPoint(generator, size);
    case 4:
      return Eigen::Vector3d(std::round(vertex.x()), std::round(vertex.y()), 0.5 * size);
    default:
      return randomPoint(generator, 100.0 * size);
  }
}

Triangle randomTriangle(std::mt19937& generator, const CollisionMesh& organ) {
  const Eigen::Vector3d a = randomTip(generator, organ);
  const double size = 0.1 * (organ.health().box.high - organ.health().box.low).maxCoeff();
  return {a, a + randomPoint(generator, size), a + randomPoint(generator, size)};
}

double rounding(const CollisionMesh& organ, const Eigen::Vector3d& tip) {
  const Box& box = organ.health().box;
  const double extent =
      std::max((box.low - tip).norm(), (box.high - tip).norm()) + (box.high - box.low).norm();
  return 4.0 * kUnitRoundoff * extent;
}

TEST(NearestTriangle, OfACubeIsOnTheFaceInFront) {
  const CollisionMesh cube(test::cube());
  const NearestTriangle nearest = nearestTriangle(cube, Eigen::Vector3d(0.25, 0.5, 3.0));
  EXPECT_EQ(nearest.distance, 2.0);
  EXPECT_EQ(nearest.closest.point, Eigen::Vector3d(0.25, 0.5, 1.0));
  EXPECT_EQ(nearest.normal, Eigen::Vector3d(0, 0, 1));
  EXPECT_TRUE(nearest.isExact());
  EXPECT_TRUE(nearest.distance_signed);
  EXPECT_EQ(nearestTriangle(cube, Eigen::Vector3d(0.5, 0.5, 0.9)).distance,
            -std::sqrt((1.0 - 0.9) * (1.0 - 0.9)));
}

TEST(NearestTriangle, EqualsBruteForceBitForBit) {
  std::mt19937 generator(11);
  for (const CollisionMesh& organ : organs()) {
    for (int i = 0; i < 3000; ++i) {
      const Eigen::Vector3d tip = randomTip(generator, organ);
      const NearestTriangle nearest = nearestTriangle(organ, tip);
      ASSERT_EQ(std::abs(nearest.distance),
                std::sqrt(test::squaredDistanceByBruteForce(organ.mesh(), tip)));
      ASSERT_TRUE(nearest.isExact());
      ASSERT_EQ(
          nearest.closest.squared_distance,
          closestPointOnTriangle(tip, organ.mesh().triangle(nearest.triangle)).squared_distance);
    }
  }
}

TEST(NearestTriangle, EqualsBruteForceBitForBitForTriangleTips) {
  std::mt19937 generator(12);
  for (const CollisionMesh& organ : organs()) {
    for (int i = 0; i < 200; ++i) {
      const Triangle tip = randomTriangle(generator, organ);
      const NearestTriangle nearest = nearestTriangle(organ, tip);
      ASSERT_EQ(std::abs(nearest.distance),
                std::sqrt(test::squaredDistanceByBruteForce(organ.mesh(), tip)));
      ASSERT_TRUE(nearest.isExact());
    }
  }
}

TEST(NearestTriangle, GreedyEqualsALiteralTranscriptionOfThePaper) {
  std::mt19937 generator(13);
  for (const CollisionMesh& organ : organs()) {
    const test::PaperHierarchy paper(organ.mesh());
    for (int i = 0; i < 3000; ++i) {
      const Eigen::Vector3d tip = randomTip(generator, organ);
      const NearestTriangle nearest = nearestTriangle(organ, tip, Accuracy::greedy());
      ASSERT_EQ(nearest.triangle, paper.search(tip));
      ASSERT_EQ(nearest.work.triangles, 1U);
    }
    const Triangle tip = randomTriangle(generator, organ);
    ASSERT_EQ(nearestTriangle(organ, tip, Accuracy::greedy()).triangle,
              paper.search(centroid(tip)));
  }
}

TEST(NearestTriangle, BoundsHoldTheTruthAtEveryAccuracy) {
  std::mt19937 generator(14);
  const std::vector<Accuracy> dial = {{0, 0, 1},    {0, 0, 2},    {0, 0, 8},    {0.1, 0, 0},
                                      {0.01, 0, 0}, {0, 1e-2, 0}, {0, 1e-4, 0}, {0.05, 1e-3, 16}};
  for (const CollisionMesh& organ : organs()) {
    for (int i = 0; i < 500; ++i) {
      const Eigen::Vector3d tip = randomTip(generator, organ);
      const NearestTriangle truth = nearestTriangle(organ, tip);
      const double slack = rounding(organ, tip);
      for (const Accuracy& accuracy : dial) {
        const NearestTriangle nearest = nearestTriangle(organ, tip, accuracy);
        const double exact = nearest.distance_signed ? truth.distance : std::abs(truth.distance);
        ASSERT_LE(nearest.lower_bound, exact + slack);
        ASSERT_GE(nearest.upper_bound, exact - slack);
        ASSERT_TRUE(nearest.distance == nearest.lower_bound ||
                    nearest.distance == nearest.upper_bound);
        ASSERT_TRUE(nearest.distance_signed || nearest.lower_bound >= 0.0);
        if (accuracy.max_leaves != 0) {
          ASSERT_LE(nearest.work.triangles, accuracy.max_leaves);
          continue;
        }
        const double allowed =
            std::max(accuracy.max_relative_error * std::abs(exact), accuracy.max_absolute_error);
        ASSERT_LE(std::abs(nearest.distance), std::abs(exact) + allowed + slack);
      }
    }
  }
}

TEST(NearestTriangle, MoreLeavesAreNeverWorse) {
  std::mt19937 generator(15);
  for (const CollisionMesh& organ : organs()) {
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d tip = randomTip(generator, organ);
      double last = std::numeric_limits<double>::infinity();
      for (std::uint32_t leaves = 1; leaves <= 24; ++leaves) {
        const double distance = std::abs(nearestTriangle(organ, tip, {0, 0, leaves}).distance);
        ASSERT_LE(distance, last);
        last = distance;
      }
    }
  }
}

TEST(NearestTriangle, AnErrorThatIsAllowedIsUsedToStopEarly) {
  const CollisionMesh organ(test::blob(5));
  const Eigen::Vector3d far(0.3, 0.2, 0.4);
  const std::uint32_t exact = nearestTriangle(organ, far).work.bounds;
  EXPECT_LT(nearestTriangle(organ, far, {0.1, 0, 0}).work.bounds, exact / 2);
  EXPECT_LT(nearestTriangle(organ, far, {0, 0.02, 0}).work.bounds, exact / 2);
  EXPECT_LT(nearestTriangle(organ, far, {0, 0, 4}).work.bounds, exact / 2);
}

TEST(NearestTriangle, DoesNotDependOnTheNumbersOfTheTriangles) {
  std::mt19937 generator(16);
  for (const CollisionMesh& organ : organs()) {
    const CollisionMesh renumbered(test::shuffled(organ.mesh(), 4));
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector3d tip = randomTip(generator, organ);
      for (const Accuracy& accuracy :
           {Accuracy::exact(), Accuracy::greedy(), Accuracy{0.05, 0, 0}}) {
        const NearestTriangle nearest = nearestTriangle(organ, tip, accuracy);
        const NearestTriangle other = nearestTriangle(renumbered, tip, accuracy);
        ASSERT_EQ(nearest.distance, other.distance);
        ASSERT_EQ(nearest.closest.point, other.closest.point);
        ASSERT_EQ(nearest.lower_bound, other.lower_bound);
      }
    }
  }
}

TEST(NearestTriangle, ScalesWithAPowerOfTwoBitForBit) {
  std::mt19937 generator(17);
  const TriangleMesh mesh = test::blob(3);
  const CollisionMesh organ(mesh);
  for (const int exponent : {-300, -7, 9, 300}) {
    const double scale = std::ldexp(1.0, exponent);
    Points points = mesh.positions();
    for (Eigen::Vector3d& point : points) point *= scale;
    const CollisionMesh scaled(TriangleMesh(points, mesh.triangles()));
    for (int i = 0; i < 500; ++i) {
      const Eigen::Vector3d tip = randomTip(generator, organ);
      for (const Accuracy& accuracy : {Accuracy::exact(), Accuracy::greedy()}) {
        const NearestTriangle nearest = nearestTriangle(organ, tip, accuracy);
        const NearestTriangle other = nearestTriangle(scaled, scale * tip, accuracy);
        ASSERT_EQ(other.triangle, nearest.triangle);
        ASSERT_EQ(other.distance, scale * nearest.distance);
        ASSERT_EQ(other.lower_bound, scale * nearest.lower_bound);
        ASSERT_EQ(other.normal, nearest.normal);
      }
    }
  }
}

TEST(NearestTriangle, RefusesWhatItCannotAnswerAndSaysWhat) {
  const CollisionMesh cube(test::cube());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { nearestTriangle(cube, Eigen::Vector3d(0, nan, 0)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("tip")));
  EXPECT_THAT(
      [&] {
        nearestTriangle(cube, Eigen::Vector3d(0, 0, 0), {-0.1, 0, 0});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("max_relative_error is -0.1")));
  EXPECT_THAT(
      [&] {
        nearestTriangle(cube, Eigen::Vector3d(0, 0, 0), {0, nan, 0});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("max_absolute_error")));
}

TEST(NearestTriangle, ApproximateAnswersClaimASignOnlyOutsideTheBox) {
  const CollisionMesh organ(test::blob(4));
  EXPECT_TRUE(nearestTriangle(organ, Eigen::Vector3d(1, 1, 1), Accuracy::greedy()).distance_signed);
  const NearestTriangle inside =
      nearestTriangle(organ, Eigen::Vector3d(0, 0, 0), Accuracy::greedy());
  ASSERT_FALSE(inside.isExact());
  EXPECT_FALSE(inside.distance_signed);
  EXPECT_GT(inside.distance, 0.0);
}

}  // namespace
}  // namespace organ_collision::core
