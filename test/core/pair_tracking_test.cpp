#include "organ_collision/core/pair_tracking.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "every_vector_unit.h"
#include "organs_and_tips.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::queryCount;

void expectSame(const NearestPair& tracked, const NearestPair& searched) {
  ASSERT_EQ(tracked.triangle_of_first, searched.triangle_of_first);
  ASSERT_EQ(tracked.nearest.triangle, searched.nearest.triangle);
  ASSERT_EQ(tracked.nearest.distance, searched.nearest.distance);
  ASSERT_EQ(tracked.nearest.lower_bound, searched.nearest.lower_bound);
  ASSERT_EQ(tracked.nearest.upper_bound, searched.nearest.upper_bound);
  ASSERT_EQ(tracked.nearest.distance_signed, searched.nearest.distance_signed);
  ASSERT_EQ(tracked.nearest.closest.point, searched.nearest.closest.point);
  ASSERT_EQ(tracked.nearest.tip_point, searched.nearest.tip_point);
  ASSERT_EQ(tracked.nearest.normal, searched.nearest.normal);
}

double sizeOf(const CollisionMesh& surface) {
  return (surface.health().box.high - surface.health().box.low).maxCoeff();
}

/// The next pose: it rests, creeps, moves or jumps, near enough for the surfaces to meet at times.
Isometry3d moved(const Isometry3d& pose, std::mt19937& generator, double size) {
  const auto by = [&](double reach, double turn) {
    return Eigen::Translation3d(test::randomPoint(generator, reach)) * pose *
           Eigen::AngleAxisd(turn, Vector3d::UnitX());
  };
  switch (generator() % 8) {
    case 0:
      return pose;
    case 1:
      return by(1e-15 * size, 0.0);
    case 2:
      return generator() % 4 == 0 ? test::randomPose(generator, size) : pose;
    case 3:
      return generator() % 4 == 0 ? by(0.02 * size, 0.05) : pose;
    default:
      return by(0.0001 * size, 0.0001);
  }
}

/// Moved as a whole, and each vertex a tenth of that by itself; returns the farthest that one was.
double drift(CollisionMesh& surface, std::mt19937& generator, const Vector3d& by) {
  Points positions = surface.mesh().positions();
  double farthest = 0.0;
  for (Vector3d& position : positions) {
    const Vector3d former = position;
    position += by + test::randomPoint(generator, 0.1 * by.norm());
    farthest = std::max(farthest, (position - former).norm());
  }
  surface.refit(positions);
  return farthest;
}

const std::vector<CollisionMesh>& surfaces() {
  static const std::vector<CollisionMesh> all = {
      CollisionMesh(test::cube(0.1)), CollisionMesh(test::grid(8, 8)), CollisionMesh(test::blob(4)),
      CollisionMesh(test::soup(60, 5)), CollisionMesh(test::halvings(40))};
  return all;
}

class FollowedPair : public test::EveryVectorUnit {};

TEST_P(FollowedPair, IsThatOfASearch) {
  std::mt19937 generator(91);
  for (const CollisionMesh& first : surfaces()) {
    for (const CollisionMesh& second : surfaces()) {
      const double size = sizeOf(first) + sizeOf(second);
      PairTracker tracker;
      Isometry3d pose = test::randomPose(generator, size);
      for (std::size_t i = 0; i < queryCount(60); ++i) {
        pose = moved(pose, generator, size);
        ASSERT_NO_FATAL_FAILURE(expectSame(tracker.nearestPair(first, 0.0, pose, second, 0.0),
                                           nearestPair(first, pose, second)));
      }
    }
  }
}

TEST_P(FollowedPair, IsThatOfASearchWhereSurfacesDriftAndAreRebuilt) {
  std::mt19937 generator(92);
  for (const CollisionMesh& other : surfaces()) {
    for (const bool other_is_first : {true, false}) {
      CollisionMesh worn(test::soup(60, 7));
      worn.refit(test::soup(60, 8).positions());  // a rebuild splits it otherwise
      CollisionMesh first = other_is_first ? other : worn;
      CollisionMesh second = other_is_first ? worn : other;
      double travel_of_first = 0.0;
      double travel_of_second = 0.0;
      const double size = sizeOf(first) + sizeOf(second);
      PairTracker tracker;
      Isometry3d pose = test::randomPose(generator, size);
      Vector3d step = Vector3d::Zero();
      for (std::size_t i = 0; i < queryCount(100); ++i) {
        if (i % 25 == 0) step = test::randomPoint(generator, 0.001 * size);
        const bool moves_first = i / 25 % 2 == 0;
        (moves_first ? travel_of_first : travel_of_second) +=
            drift(moves_first ? first : second, generator, step);
        if (i % 32 == 5) first.rebuild();
        if (i % 32 == 10) second.rebuild();
        if (i % 50 == 49) pose = moved(pose, generator, size);
        ASSERT_NO_FATAL_FAILURE(
            expectSame(tracker.nearestPair(first, travel_of_first, pose, second, travel_of_second),
                       nearestPair(first, pose, second)));
      }
    }
  }
}

ORGAN_COLLISION_ON_EVERY_VECTOR_UNIT(FollowedPair);

TEST(PairTracker, LooksAtLessThanATenthOfTheBoxesOfASearch) {
  const CollisionMesh organ(test::blob(6));
  const CollisionMesh tool(test::blob(3));
  PairTracker tracker;
  std::uint64_t tracked = 0;
  std::uint64_t searched = 0;
  for (int i = 0; i < 1000; ++i) {
    const Isometry3d pose =
        Eigen::Translation3d(0.1 + 1e-5 * i, 0.1, 0.15) * Isometry3d::Identity();
    tracked += tracker.nearestPair(tool, 0.0, pose, organ, 0.0).nearest.work.bounds;
    searched += nearestPair(tool, pose, organ).nearest.work.bounds;
  }
  EXPECT_LT(tracked, searched / 10);
}

TEST(PairTracker, FollowsAToolThatTurnsAroundItsLowEnd) {
  const CollisionMesh organ(test::blob(4));
  Points points = test::blob(3).positions();
  for (Vector3d& point : points) point = {0.1 * point.x(), 0.1 * point.y(), 4.0 * point.z()};
  const CollisionMesh tool(TriangleMesh(points, test::blob(3).triangles()));
  const Vector3d end(0.0, 0.0, tool.health().box.low.z());
  PairTracker tracker;
  for (int i = 0; i < 300; ++i) {
    const Isometry3d pose = Eigen::Translation3d(0.0, 0.0, 0.6) *
                            Eigen::AngleAxisd(0.01 * i, Vector3d::UnitX()) *
                            Eigen::Translation3d(-end);
    ASSERT_NO_FATAL_FAILURE(expectSame(tracker.nearestPair(tool, 0.0, pose, organ, 0.0),
                                       nearestPair(tool, pose, organ)));
  }
}

TEST(PairTracker, FollowsNothingInAnotherHierarchyOfTheSecond) {
  std::mt19937 generator(95);
  const CollisionMesh first(test::blob(2));
  const CollisionMesh former(test::soup(60, 7));
  const CollisionMesh second(test::soup(60, 8));
  for (int i = 0; i < 200; ++i) {
    const Isometry3d pose = test::randomPose(generator, 1.5);
    PairTracker tracker;
    tracker.nearestPair(first, 0.0, pose, former, 0.0);
    ASSERT_NO_FATAL_FAILURE(expectSame(tracker.nearestPair(first, 0.0, pose, second, 0.0),
                                       nearestPair(first, pose, second)));
  }
}

/// A pose that is hardly rigid makes more of what the first moves by.
TEST(PairTracker, FollowsAFirstThatMovesFartherThanItSaysOnceItIsPosed) {
  const auto plate = [](Points& points, std::vector<Corners>& triangles, double x, double y) {
    const TriangleMesh grid = test::grid(4, 4);
    const std::size_t first = points.size();
    for (const Vector3d& point : grid.positions())
      points.emplace_back(x, y + 0.04 * point.x(), 0.04 * point.y());
    for (const auto& [a, b, c] : grid.triangles())
      triangles.push_back(test::corners(first + index(a), first + index(b), first + index(c)));
  };
  Points points, wall;
  std::vector<Corners> triangles, wall_triangles;
  plate(points, triangles, 0.3, 0.0);
  const std::size_t moving = points.size();
  plate(points, triangles, 1.0, 0.52);
  plate(wall, wall_triangles, 0.0, 0.0);
  plate(wall, wall_triangles, 0.0, 0.52);
  CollisionMesh first(TriangleMesh(points, triangles));
  const CollisionMesh second(TriangleMesh(wall, wall_triangles));
  Isometry3d pose = Isometry3d::Identity();
  pose.linear()(0, 0) = 1.03;
  PairTracker tracker;
  double travel = 0.0;
  for (int i = 0; i < 400; ++i) {
    ASSERT_NO_FATAL_FAILURE(expectSame(tracker.nearestPair(first, travel, pose, second, 0.0),
                                       nearestPair(first, pose, second)));
    for (std::size_t k = moving; k < points.size(); ++k) points[k].x() -= 0.002;
    first.refit(points);
    travel += 0.0020001;
  }
}

/// As large as that from its middle to its farthest side.
Points blobOfReach(double reach) {
  const CollisionMesh blob(test::blob(4));
  Points points = blob.mesh().positions();
  for (Vector3d& point : points) point *= 2.0 * reach / sizeOf(blob);
  return points;
}

/// Then lengths are told in another unit.
TEST(PairTracker, FollowsOverASurfaceThatOutgrowsAPowerOfTwo) {
  CollisionMesh organ(TriangleMesh(blobOfReach(0.999), test::blob(4).triangles()));
  const CollisionMesh tool(test::blob(3));
  PairTracker tracker;
  double travel = 0.0;
  Isometry3d pose(Eigen::Translation3d(0.0, 0.0, 1.0));
  const auto expect_same = [&] {
    expectSame(tracker.nearestPair(tool, 0.0, pose, organ, travel), nearestPair(tool, pose, organ));
  };
  expect_same();
  organ.refit(blobOfReach(1.001));
  travel += 0.01;
  for (int i = 0; i < 50; ++i) {
    pose.translation().x() += 0.005;
    ASSERT_NO_FATAL_FAILURE(expect_same());
  }
}

TEST(PairTracker, FollowsNothingFromWhereASurfaceWasToWhereItHadBeenBefore) {
  std::mt19937 generator(93);
  const CollisionMesh before(test::blob(4));
  const CollisionMesh tool(test::blob(3));
  Points positions = before.mesh().positions();
  for (Vector3d& position : positions) position.x() += 0.05;
  CollisionMesh after = before;
  after.refit(positions);
  for (int i = 0; i < 50; ++i) {
    const Isometry3d pose = test::randomPose(generator, 0.3);
    PairTracker as_first, as_second;
    expectSame(as_first.nearestPair(after, 0.05, pose, tool, 0.0), nearestPair(after, pose, tool));
    expectSame(as_second.nearestPair(tool, 0.0, pose, after, 0.05), nearestPair(tool, pose, after));
    ASSERT_NO_FATAL_FAILURE(expectSame(as_first.nearestPair(before, 0.0, pose, tool, 0.0),
                                       nearestPair(before, pose, tool)));
    ASSERT_NO_FATAL_FAILURE(expectSame(as_second.nearestPair(tool, 0.0, pose, before, 0.0),
                                       nearestPair(tool, pose, before)));
  }
}

TEST(PairTracker, ForgetsWhatItKnewOfASurfaceThatWasMovedAndNobodySaysHowFar) {
  std::mt19937 generator(96);
  CollisionMesh organ(test::blob(4));
  CollisionMesh tool(test::blob(3));
  const Isometry3d pose(Eigen::Translation3d(0.0, 0.0, 1.2));
  PairTracker tracker;
  for (std::size_t i = 0; i < queryCount(200); ++i) {
    ASSERT_NO_FATAL_FAILURE(expectSame(tracker.nearestPair(tool, 0.0, pose, organ, 0.0),
                                       nearestPair(tool, pose, organ)));
    CollisionMesh& moved = i % 2 == 0 ? organ : tool;
    const auto vertex = static_cast<VertexId>(generator() % moved.mesh().positions().size());
    const Vector3d position = 1.1 * moved.mesh().position(vertex);
    moved.refit({vertex}, Points{position});
  }
}

TEST(PairTracker, RefusesAPoseThatIsNotRigid) {
  const CollisionMesh cube(test::cube());
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() *= 2.0;
  for (const double x : {0.0, 5.0}) {  // where they meet, and where they do not
    pose.translation().x() = x;
    EXPECT_THROW(PairTracker().nearestPair(cube, 0.0, pose, cube, 0.0), std::invalid_argument);
  }
}

}  // namespace
}  // namespace organ_collision::core
