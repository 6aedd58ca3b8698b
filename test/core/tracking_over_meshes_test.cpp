#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "followed_tips.h"
#include "organ_collision/core/tracking.h"
#include "organs_and_tips.h"
#include "test_meshes.h"

// Tips over meshes that move, are rebuilt, or are others.
namespace organ_collision::core {
namespace {

using test::expectSame;
using test::moved;
using test::organs;
using test::queryCount;
using test::randomPoint;
using test::randomTip;
using test::sizeOf;

TEST(Tracker, FollowsOverAMeshThatMovesAndIsRebuilt) {
  std::mt19937 generator(33);
  for (CollisionMesh organ : organs()) {
    Tracker tracker;
    double travel = 0.0;
    Eigen::Vector3d tip = randomTip(generator, organ);
    for (std::size_t i = 0; i < queryCount(300); ++i) {
      Points positions = organ.mesh().positions();
      const Eigen::Vector3d together = randomPoint(generator, 0.01 * sizeOf(organ));
      double farthest = 0.0;
      for (Eigen::Vector3d& position : positions) {
        const Eigen::Vector3d former = position;
        position += together + randomPoint(generator, 0.001 * sizeOf(organ));
        farthest = std::max(farthest, (position - former).norm());
      }
      organ.refit(positions);
      travel += farthest;
      if (i % 16 == 15) organ.rebuild();
      tip = moved(tip, generator, organ);
      ASSERT_NO_FATAL_FAILURE(
          expectSame(tracker.nearestTriangle(organ, travel, tip), nearestTriangle(organ, tip)));
    }
  }
}

/// Then lengths are told in another unit.
/// By as much as what is nearest next comes nearer.
TEST(Tracker, FollowsOverAMeshWhoseMiddleMoves) {
  Points points;
  std::vector<Corners> triangles;
  const auto add = [&](const Eigen::Vector3d& at, double size) {
    const std::size_t first = points.size();
    for (const Eigen::Vector3d& to :
         {Eigen::Vector3d(-1, -1, 0), Eigen::Vector3d(1, -1, 0), Eigen::Vector3d(0, 1, 0)})
      points.emplace_back(at + size * to);
    triangles.push_back(test::corners(first, first + 1, first + 2));
  };
  add({0, 0, 0}, 0.01);
  add({0, 0, -0.02}, 0.01);
  for (int i = 0; i < 12; ++i)
    for (const double side : {-1.0, 1.0}) add({0.9 * std::cos(i), 0.9 * std::sin(i), side}, 0.05);
  CollisionMesh organ({points, triangles});
  Tracker tracker;
  Eigen::Vector3d tip(0, 0, 0.05);
  for (int i = 0; i < 6; ++i) {
    tip.x() += 1e-4;
    tracker.nearestTriangle(organ, 0.0, tip);
  }
  for (std::size_t i = 3; i < 6; ++i) points[i].z() += 0.03;
  for (std::size_t i = 6; i < points.size(); ++i) points[i].z() -= 0.03;
  organ.refit(points);
  const NearestTriangle tracked = tracker.nearestTriangle(organ, 0.0300001, tip);
  EXPECT_EQ(tracked.distance, nearestTriangle(organ, tip).distance);
}

TEST(Tracker, FollowsOverAMeshThatOutgrowsAPowerOfTwo) {
  const Points positions = test::blob(4).positions();
  const Box box = CollisionMesh(test::blob(4)).health().box;
  const double reach = 0.5 * (box.high - box.low).maxCoeff();
  const auto scaled = [&](double wanted_reach) {
    Points points = positions;
    for (Eigen::Vector3d& point : points) point *= wanted_reach / reach;
    return points;
  };
  CollisionMesh organ(TriangleMesh(scaled(0.999), test::blob(4).triangles()));
  Tracker tracker;
  double travel = 0.0;
  Eigen::Vector3d tip(0.0, 0.0, 1.5);
  expectSame(tracker.nearestTriangle(organ, travel, tip), nearestTriangle(organ, tip));
  organ.refit(scaled(1.001));
  travel += 0.01;
  for (int i = 0; i < 50; ++i) {
    tip.x() += 0.02;
    ASSERT_NO_FATAL_FAILURE(
        expectSame(tracker.nearestTriangle(organ, travel, tip), nearestTriangle(organ, tip)));
  }
}

TEST(Tracker, FollowsNothingFromWhereTheMeshWasToWhereItHadBeenBefore) {
  std::mt19937 generator(38);
  const CollisionMesh before(test::blob(4));
  Points positions = before.mesh().positions();
  for (Eigen::Vector3d& position : positions) position.x() += 0.05;
  CollisionMesh after = before;
  after.refit(positions);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d tip = randomPoint(generator, 0.3);
    Tracker tracker;
    expectSame(tracker.nearestTriangle(after, 0.05, tip), nearestTriangle(after, tip));
    ASSERT_NO_FATAL_FAILURE(
        expectSame(tracker.nearestTriangle(before, 0.0, tip), nearestTriangle(before, tip)));
  }
}

TEST(Tracker, ForgetsWhatItKnewOfAMeshThatWasMovedAndNobodySaysHowFar) {
  std::mt19937 generator(44);
  CollisionMesh organ(test::blob(4));
  const Eigen::Vector3d tip(0.0, 0.0, 0.5);
  Tracker tracker;
  for (std::size_t i = 0; i < queryCount(200); ++i) {
    ASSERT_NO_FATAL_FAILURE(
        expectSame(tracker.nearestTriangle(organ, 0.0, tip), nearestTriangle(organ, tip)));
    const std::size_t vertex = generator() % organ.mesh().positions().size();
    organ.refit({static_cast<VertexId>(vertex)}, {tip + randomPoint(generator, 0.1)});
  }
}

TEST(Tracker, FollowsOverAMeshThatMayHaveMovedBeyondSinglePrecision) {
  std::mt19937 generator(45);
  CollisionMesh organ(test::blob(4));
  Tracker tracker;
  double travel = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d tip = randomPoint(generator, sizeOf(organ));
    ASSERT_NO_FATAL_FAILURE(
        expectSame(tracker.nearestTriangle(organ, travel, tip), nearestTriangle(organ, tip)));
    organ.refit(Points(organ.mesh().positions()));
    travel += 1e60;
  }
}

TEST(Tracker, ForgetsTheNormalOfAnotherHierarchy) {
  const Eigen::Vector3d tip(0.2, 0.2, 1.0);
  Tracker tracker;
  for (const double height : {0.0, 0.5}) {
    const CollisionMesh organ(
        TriangleMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, height}}, {test::corners(0, 1, 2)}));
    expectSame(tracker.nearestTriangle(organ, 0.0, tip), nearestTriangle(organ, tip));
  }
}

TEST(Tracker, SearchesFromNothingInAnotherHierarchy) {
  const CollisionMesh former(test::blob(4));
  const CollisionMesh organ(test::cube());
  for (int seed = 0; seed < 10; ++seed) {
    Tracker tracker;
    std::mt19937 generator(seed);
    for (int i = 0; i < 20; ++i)
      tracker.nearestTriangle(former, 0.0, randomPoint(generator, sizeOf(former)));
    const Eigen::Vector3d tip = randomPoint(generator, sizeOf(organ));
    expectSame(tracker.nearestTriangle(organ, 0.0, tip), nearestTriangle(organ, tip));
  }
}

}  // namespace
}  // namespace organ_collision::core
