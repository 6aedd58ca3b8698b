#include "organ_collision/core/nearest_triangle.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "brute_force.h"
#include "every_vector_unit.h"
#include "organ_collision/core/triangle_distance.h"
#include "organs_and_tips.h"
#include "paper_hierarchy.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

using test::organs;
using test::queryCount;
using test::randomTip;
using test::randomTriangle;

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

/// The nearest triangle, of those that tie the first of the hierarchy's leaves.
TriangleId triangleByBruteForce(const CollisionMesh& organ, const Eigen::Vector3d& tip) {
  TriangleId nearest{};
  double least = std::numeric_limits<double>::infinity();
  for (FarthestPairTree::Leaf leaf = 0; leaf < organ.tree().root().size(); ++leaf) {
    const TriangleId triangle = organ.tree().triangle(leaf);
    const double squared_distance =
        closestPointOnTriangle(tip, organ.mesh().triangle(triangle)).squared_distance;
    if (squared_distance < least) nearest = triangle;
    least = std::min(least, squared_distance);
  }
  return nearest;
}

class NearestTriangleOf : public test::EveryVectorUnit {};
ORGAN_COLLISION_ON_EVERY_VECTOR_UNIT(NearestTriangleOf);

void expectSameAsBruteForce(const CollisionMesh& organ, const Eigen::Vector3d& tip) {
  const NearestTriangle nearest = nearestTriangle(organ, tip);
  ASSERT_TRUE(nearest.isExact());
  ASSERT_EQ(nearest.triangle, triangleByBruteForce(organ, tip));
  const ClosestPoint& closest = nearest.closest;
  const ClosestPoint measured =
      closestPointOnTriangle(tip, organ.mesh().triangle(nearest.triangle));
  ASSERT_EQ(nearest.tip_point, tip);
  ASSERT_EQ(std::abs(nearest.distance), std::sqrt(measured.squared_distance));
  ASSERT_EQ(closest.squared_distance, measured.squared_distance);
  ASSERT_EQ(closest.point, measured.point);
  ASSERT_EQ(closest.offset, measured.offset);
  ASSERT_EQ(closest.barycentric, measured.barycentric);
  ASSERT_EQ(closest.feature, measured.feature);
}

TEST_P(NearestTriangleOf, PointTipsEqualsBruteForceBitForBit) {
  std::mt19937 generator(11);
  for (const CollisionMesh& organ : organs())
    for (std::size_t i = 0; i < queryCount(3000); ++i)
      ASSERT_NO_FATAL_FAILURE(expectSameAsBruteForce(organ, randomTip(generator, organ)));
}

TEST_P(NearestTriangleOf, PointTipsEqualsBruteForceWhereCoordinatesAreCoarse) {
  std::mt19937 generator(16);
  for (const CollisionMesh& organ : organs()) {
    const CollisionMesh far = test::farAway(organ);
    for (std::size_t i = 0; i < queryCount(3000); ++i)
      ASSERT_NO_FATAL_FAILURE(expectSameAsBruteForce(far, randomTip(generator, far)));
  }
}

TEST_P(NearestTriangleOf, TriangleTipsEqualsBruteForceBitForBit) {
  std::mt19937 generator(12);
  for (const CollisionMesh& organ : organs()) {
    for (std::size_t i = 0; i < queryCount(200); ++i) {
      const Triangle tip = randomTriangle(generator, organ);
      const NearestTriangle nearest = nearestTriangle(organ, tip);
      ASSERT_EQ(std::abs(nearest.distance),
                std::sqrt(test::squaredDistanceByBruteForce(organ.mesh(), tip)));
      ASSERT_TRUE(nearest.isExact());
      const ClosestPair measured = closestPoints(tip, organ.mesh().triangle(nearest.triangle));
      ASSERT_EQ(nearest.tip_point, measured.point_on_first);
      ASSERT_EQ(nearest.closest.point, measured.on_second.point);
      ASSERT_EQ(nearest.closest.offset, measured.on_second.offset);
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
      ASSERT_EQ(greedyTriangle(organ, tip), nearest.triangle);
      ASSERT_EQ(nearest.work.triangles, 1U);
    }
    const Triangle tip = randomTriangle(generator, organ);
    ASSERT_EQ(nearestTriangle(organ, tip, Accuracy::greedy()).triangle,
              paper.search(centroid(tip)));
  }
}

/// That `bare` tells the same as `whole`, but for the sign and the normal.
void expectSameWithoutSign(const NearestTriangle& bare, const NearestTriangle& whole) {
  ASSERT_EQ(bare.triangle, whole.triangle);
  ASSERT_EQ(bare.closest.point, whole.closest.point);
  ASSERT_EQ(bare.tip_point, whole.tip_point);
  ASSERT_EQ(bare.normal, Eigen::Vector3d(0, 0, 0));
  ASSERT_FALSE(bare.distance_signed);
  ASSERT_EQ(bare.distance, std::abs(whole.distance));
  const bool inside = whole.distance < 0.0;
  ASSERT_EQ(bare.lower_bound, inside ? -whole.upper_bound : whole.lower_bound);
  ASSERT_EQ(bare.upper_bound, inside ? -whole.lower_bound : whole.upper_bound);
  ASSERT_EQ(bare.work.bounds, whole.work.bounds);
  ASSERT_EQ(bare.work.triangles, whole.work.triangles);
}

TEST(NearestTriangle, WithoutSignIsTheSameOtherwise) {
  std::mt19937 generator(14);
  for (const CollisionMesh& organ : organs()) {
    for (const Accuracy& accuracy : {Accuracy::exact(), Accuracy::greedy(), Accuracy{0.1, 0, 0}}) {
      for (int i = 0; i < 300; ++i) {
        const Eigen::Vector3d point = randomTip(generator, organ);
        ASSERT_NO_FATAL_FAILURE(
            expectSameWithoutSign(nearestTriangle(organ, point, accuracy, Sign::kNone),
                                  nearestTriangle(organ, point, accuracy)));
      }
      const Triangle tip = randomTriangle(generator, organ);
      ASSERT_NO_FATAL_FAILURE(
          expectSameWithoutSign(nearestTriangle(organ, tip, accuracy, Sign::kNone),
                                nearestTriangle(organ, tip, accuracy)));
    }
  }
}

TEST(NearestTriangle, FromSoFarThatSquaresWouldOverflowMeasuresAllTriangles) {
  const CollisionMesh speck(test::cube(0x1p-300));
  const Eigen::Vector3d tip(0x1p200, 0, 0);
  const NearestTriangle nearest = nearestTriangle(speck, tip);
  EXPECT_EQ(nearest.distance, 0x1p200);
  EXPECT_TRUE(nearest.isExact());
  EXPECT_EQ(nearest.work.triangles, 12U);
  const NearestTriangle of_four = nearestTriangle(speck, tip, {0, 0, 4});
  EXPECT_EQ(of_four.work.triangles, 4U);
  EXPECT_EQ(of_four.upper_bound, 0x1p200);
  EXPECT_LE(of_four.lower_bound, 0x1p200);
}

TEST(NearestTriangle, OfAnOrganInOnePointIsThatPoint) {
  const CollisionMesh point(TriangleMesh({{1, 2, 3}}, {test::corners(0, 0, 0)}));
  EXPECT_EQ(nearestTriangle(point, Eigen::Vector3d(1, 2, 7)).distance, 4.0);
  EXPECT_EQ(nearestTriangle(point, Eigen::Vector3d(1, 2, 3)).distance, 0.0);
}

/// Most of a shaft may be far from where it is nearest.
TEST(NearestTriangle, OfAShaftThatPointsAtTheOrganIsFoundNearlyAsSoonAsOfItsEnd) {
  const CollisionMesh organ(test::blob(6));
  std::uint64_t of_end = 0;
  std::uint64_t of_shaft = 0;
  for (std::size_t i = 0; i < organ.mesh().positions().size(); i += 100) {
    const Eigen::Vector3d& place = organ.mesh().positions()[i];
    const Eigen::Vector3d end = 1.02 * place;
    const Eigen::Vector3d handle = end + 0.2 * place.normalized();
    of_end += nearestTriangle(organ, end).work.bounds;
    of_shaft += nearestTriangle(organ, Triangle{end, handle, handle}).work.bounds;
  }
  EXPECT_LT(of_shaft, 2 * of_end);
}

TEST(NearestTriangle, RefusesWhatItCannotAnswerAndSaysWhat) {
  const CollisionMesh cube(test::cube());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT([&] { nearestTriangle(cube, Eigen::Vector3d(0, nan, 0)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("tip")));
  EXPECT_THAT([&] { greedyTriangle(cube, Eigen::Vector3d(nan, 0, 0)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("tip")));
  EXPECT_THAT(
      [&] {
        nearestTriangle(cube, Triangle{{0, 0, 0}, {1, 0, 0}, {0, nan, 0}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("tip")));
  EXPECT_THAT(
      [&] {
        nearestTriangle(cube, Eigen::Vector3d(0, 0, 0), {-1e-9, 0, 0});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("max_relative_error is -1e-09:")));
  EXPECT_THAT(
      [&] {
        nearestTriangle(cube, Eigen::Vector3d(0, 0, 0), {0, nan, 0});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("max_absolute_error")));
  EXPECT_THAT(
      [&] {
        nearestTriangle(cube, Eigen::Vector3d(0, 0, 0), {infinity, 0, 0});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("max_relative_error is inf")));
}

}  // namespace
}  // namespace organ_collision::core
