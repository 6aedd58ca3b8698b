#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "brute_force.h"
#include "every_vector_unit.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/sign.h"
#include "organs_and_tips.h"
#include "test_meshes.h"

// The dial from the greedy search to exact: what each setting promises.
namespace organ_collision::core {
namespace {

using test::organs;
using test::queryCount;
using test::randomTip;
using test::rounding;

const std::vector<Accuracy>& dial() {
  static const std::vector<Accuracy> kSettings = {
      {0, 0, 1},    {0, 0, 2},     {0, 0, 4},    {0, 0, 16},   {0, 0, 64},       {0.1, 0, 0},
      {0.01, 0, 0}, {0.001, 0, 0}, {0, 1e-2, 0}, {0, 1e-4, 0}, {0.05, 1e-3, 16}, {0, 0, 0}};
  return kSettings;
}

/// Signed where the organ is solid.
double truth(const CollisionMesh& organ, const Eigen::Vector3d& tip) {
  const double distance = std::sqrt(test::squaredDistanceByBruteForce(organ.mesh(), tip));
  return organ.health().isSolid() && windingNumber(organ, tip) != 0 ? -distance : distance;
}

void expectPromises(const NearestTriangle& nearest, const Accuracy& accuracy, double truth,
                    double slack) {
  const double expected = nearest.distance_signed ? truth : std::abs(truth);
  ASSERT_LE(nearest.lower_bound, expected + slack);
  ASSERT_GE(nearest.upper_bound, expected - slack);
  ASSERT_TRUE(nearest.distance == nearest.lower_bound || nearest.distance == nearest.upper_bound);
  ASSERT_TRUE(nearest.distance_signed || nearest.lower_bound >= 0.0);
  if (accuracy.max_leaves != 0) {
    ASSERT_LE(nearest.work.triangles, accuracy.max_leaves);
    return;
  }
  const double allowed =
      std::max(accuracy.max_relative_error * std::abs(truth), accuracy.max_absolute_error);
  ASSERT_LE(std::abs(nearest.distance), std::abs(truth) + allowed + slack);
}

class EveryAccuracy : public test::EveryVectorUnit {};
ORGAN_COLLISION_ON_EVERY_VECTOR_UNIT(EveryAccuracy);

TEST_P(EveryAccuracy, KeepsItsPromisesOfErrorsBoundsAndSigns) {
  std::mt19937 generator(14);
  for (const CollisionMesh& organ : organs()) {
    for (std::size_t i = 0; i < queryCount(1300); ++i) {
      const Eigen::Vector3d tip = randomTip(generator, organ);
      const double distance = truth(organ, tip);
      for (const Accuracy& accuracy : dial()) {
        ASSERT_NO_FATAL_FAILURE(expectPromises(nearestTriangle(organ, tip, accuracy), accuracy,
                                               distance, rounding(organ, tip)));
      }
    }
  }
}

TEST(Accuracy, MoreLeavesAreNeverWorse) {
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

TEST(Accuracy, MoreLeavesAreNeverWorseWhereAnErrorIsAllowedBesides) {
  std::mt19937 generator(16);
  for (const CollisionMesh& organ : organs()) {
    const double size = (organ.health().box.high - organ.health().box.low).maxCoeff();
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d start = randomTip(generator, organ);
      const Eigen::Vector3d end = randomTip(generator, organ);
      const double error = size * std::ldexp(1.0, -static_cast<int>(generator() % 8));
      double last = std::numeric_limits<double>::infinity();
      for (std::uint32_t leaves = 1; leaves <= 24; ++leaves) {
        const NearestTriangle nearest =
            nearestTriangle(organ, Triangle{start, end, end}, {0, error, leaves});
        ASSERT_LE(std::abs(nearest.distance), last);
        last = std::abs(nearest.distance);
      }
    }
  }
}

TEST(Accuracy, AnErrorThatIsAllowedIsUsedToStopEarly) {
  const CollisionMesh organ(test::blob(5));
  const Eigen::Vector3d far(0.3, 0.2, 0.4);
  const std::uint32_t exact = nearestTriangle(organ, far).work.bounds;
  EXPECT_LT(nearestTriangle(organ, far, {0.1, 0, 0}).work.bounds, exact / 2);
  EXPECT_LT(nearestTriangle(organ, far, {0, 0.02, 0}).work.bounds, exact / 2);
  EXPECT_LT(nearestTriangle(organ, far, {0, 0, 4}).work.bounds, exact / 2);
}

TEST(Accuracy, AnErrorSmallerThanAnyRoundingChangesNothing) {
  const CollisionMesh organ(test::blob(5));
  std::mt19937 generator(7);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d tip = test::randomPoint(generator, 2.0);
    const NearestTriangle exact = nearestTriangle(organ, tip);
    for (const Accuracy& accuracy : {Accuracy{1e-17, 0, 0}, Accuracy{0, 1e-300, 0}}) {
      const NearestTriangle nearest = nearestTriangle(organ, tip, accuracy);
      EXPECT_EQ(nearest.triangle, exact.triangle);
      EXPECT_EQ(nearest.distance, exact.distance);
      EXPECT_TRUE(nearest.isExact());
    }
  }
}

TEST(Accuracy, AnErrorLargerThanAnyLengthIsKept) {
  const CollisionMesh organ(test::cube(1e-10));
  const Accuracy any = {0, 1e308, 0};  // infinite, in sizes of the organ
  for (const double height : {0.0, 1e-11, 1e-9, 1.0, 1e30}) {
    const Eigen::Vector3d tip(0, 0, height);
    expectPromises(nearestTriangle(organ, tip, any), any, truth(organ, tip), rounding(organ, tip));
  }
}

TEST(Accuracy, ApproximateAnswersClaimASignOnlyOutsideTheBox) {
  const CollisionMesh organ(test::blob(4));
  EXPECT_TRUE(nearestTriangle(organ, Eigen::Vector3d(1, 1, 1), Accuracy::greedy()).distance_signed);
  const NearestTriangle inside =
      nearestTriangle(organ, Eigen::Vector3d(0, 0, 0), Accuracy::greedy());
  ASSERT_FALSE(inside.isExact());
  EXPECT_FALSE(inside.distance_signed);
  EXPECT_GT(inside.distance, 0.0);
}

TEST(Accuracy, DoesNotDependOnTheNumbersOfTheTriangles) {
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

TEST(Accuracy, ScalesWithAPowerOfTwoBitForBit) {
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

/// The distances of two versions of an organ agree at random tips but for `slack(tip)`.
template <class Move, class Slack>
void expectSameDistances(const CollisionMesh& organ, const CollisionMesh& other, const Move& move,
                         const Slack& slack) {
  std::mt19937 generator(18);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d tip = randomTip(generator, organ);
    const NearestTriangle nearest = nearestTriangle(organ, tip);
    const NearestTriangle counterpart = nearestTriangle(other, move(tip));
    ASSERT_EQ(nearest.distance_signed, counterpart.distance_signed);
    ASSERT_LE(std::abs(nearest.distance - counterpart.distance), slack(tip));
  }
}

const auto kSamePlace = [](const Eigen::Vector3d& tip) { return tip; };
const auto kSameBits = [](const Eigen::Vector3d&) { return 0.0; };

TEST(Accuracy, TurningTheCornersOfATriangleChangesNothing) {
  for (const CollisionMesh& organ : organs()) {
    std::vector<Corners> turned = organ.mesh().triangles();
    for (std::size_t i = 0; i < turned.size(); ++i)
      std::rotate(turned[i].begin(), turned[i].begin() + i % 3, turned[i].end());
    expectSameDistances(organ, CollisionMesh(TriangleMesh(organ.mesh().positions(), turned)),
                        kSamePlace, kSameBits);
  }
}

TEST(Accuracy, ATriangleFarAwayChangesNothing) {
  for (const CollisionMesh& organ : organs()) {
    Points points = organ.mesh().positions();
    std::vector<Corners> triangles = organ.mesh().triangles();
    const std::size_t first = points.size();
    points.insert(points.end(), {{1e6, 1e6, 1e6}, {1e6 + 1, 1e6, 1e6}, {1e6, 1e6 + 1, 1e6}});
    triangles.push_back(test::corners(first, first + 1, first + 2));
    const CollisionMesh with_stranger(TriangleMesh(points, triangles));
    std::mt19937 generator(19);
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector3d tip = randomTip(generator, organ);
      ASSERT_EQ(nearestTriangle(with_stranger, tip).distance,
                std::abs(nearestTriangle(organ, tip).distance));
    }
  }
}

TEST(Accuracy, ASecondCopyOfEveryTriangleChangesNothing) {
  for (const CollisionMesh& organ : organs()) {
    std::vector<Corners> triangles = organ.mesh().triangles();
    triangles.insert(triangles.end(), organ.mesh().triangles().begin(),
                     organ.mesh().triangles().end());
    std::mt19937 generator(20);
    const CollisionMesh doubled(TriangleMesh(organ.mesh().positions(), triangles));
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector3d tip = randomTip(generator, organ);
      ASSERT_EQ(std::abs(nearestTriangle(doubled, tip).distance),
                std::abs(nearestTriangle(organ, tip).distance));
    }
  }
}

TEST(Accuracy, SplittingTrianglesAtTheirCentroidsChangesNothingButRounding) {
  for (const CollisionMesh& organ : organs()) {
    Points points = organ.mesh().positions();
    std::vector<Corners> triangles;
    for (std::size_t i = 0; i < organ.mesh().triangleCount(); ++i) {
      const auto id = static_cast<TriangleId>(i);
      const auto [a, b, c] = organ.mesh().corners(id);
      const auto middle = static_cast<VertexId>(points.size());
      points.push_back(centroid(organ.mesh().triangle(id)));
      for (const Corners& part :
           {Corners{a, b, middle}, Corners{b, c, middle}, Corners{c, a, middle}})
        triangles.push_back(part);
    }
    // The centroid is off the plane by its own rounding.
    const double size =
        organ.health().box.high.cwiseAbs().cwiseMax(organ.health().box.low.cwiseAbs()).maxCoeff();
    expectSameDistances(
        organ, CollisionMesh(TriangleMesh(points, triangles)), kSamePlace,
        [&](const Eigen::Vector3d& tip) { return 2.0 * rounding(organ, tip) + 0x1p-50 * size; });
  }
}

TEST(Accuracy, MovingOrganAndTipRigidlyChangesNothingButRounding) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(0.3, -0.2, 0.7))
      .rotate(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()));
  for (const CollisionMesh& organ : organs()) {
    Points points = organ.mesh().positions();
    for (Eigen::Vector3d& point : points) point = pose * point;
    const CollisionMesh moved(TriangleMesh(points, organ.mesh().triangles()));
    // Each moved coordinate is a sum of four terms, none larger than what follows.
    const double size =
        organ.health().box.high.cwiseAbs().cwiseMax(organ.health().box.low.cwiseAbs()).norm() + 1.0;
    expectSameDistances(
        organ, moved, [&](const Eigen::Vector3d& tip) { return Eigen::Vector3d(pose * tip); },
        [&](const Eigen::Vector3d& tip) {
          return 2.0 * rounding(organ, tip) + 0x1p-48 * (size + tip.norm());
        });
  }
}

}  // namespace
}  // namespace organ_collision::core
