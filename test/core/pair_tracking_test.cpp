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
        ASSERT_NO_FATAL_FAILURE(expectSame(tracker.nearestPair(first, {}, pose, second, {}),
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
      MeshMotion motion_of_first;
      MeshMotion motion_of_second;
      const double size = sizeOf(first) + sizeOf(second);
      PairTracker tracker;
      Isometry3d pose = test::randomPose(generator, size);
      Vector3d step = Vector3d::Zero();
      for (std::size_t i = 0; i < queryCount(100); ++i) {
        if (i % 25 == 0) step = test::randomPoint(generator, 0.001 * size);
        const bool moves_first = i / 25 % 2 == 0;
        (moves_first ? motion_of_first : motion_of_second).travel +=
            drift(moves_first ? first : second, generator, step);
        if (i % 32 == 5) {
          first.rebuild();
          ++motion_of_first.build;
        }
        if (i % 32 == 10) {
          second.rebuild();
          ++motion_of_second.build;
        }
        if (i % 50 == 49) pose = moved(pose, generator, size);
        ASSERT_NO_FATAL_FAILURE(
            expectSame(tracker.nearestPair(first, motion_of_first, pose, second, motion_of_second),
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
    tracked += tracker.nearestPair(tool, {}, pose, organ, {}).nearest.work.bounds;
    searched += nearestPair(tool, pose, organ).nearest.work.bounds;
  }
  EXPECT_LT(tracked, searched / 10);
}

TEST(PairTracker, RefusesAPoseThatIsNotRigid) {
  const CollisionMesh cube(test::cube());
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() *= 2.0;
  EXPECT_THROW(PairTracker().nearestPair(cube, {}, pose, cube, {}), std::invalid_argument);
}

}  // namespace
}  // namespace organ_collision::core
