#include "organ_collision/core/tracking.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "followed_tips.h"
#include "organs_and_tips.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using test::expectSame;
using test::moved;
using test::organs;
using test::queryCount;
using test::randomPoint;
using test::randomTip;
using test::sizeOf;

TEST(Tracker, FollowsAPointAsIfItSearched) {
  std::mt19937 generator(31);
  for (const CollisionMesh& organ : organs()) {
    Tracker tracker;
    Eigen::Vector3d tip = randomTip(generator, organ);
    for (std::size_t i = 0; i < queryCount(3000); ++i) {
      tip = moved(tip, generator, organ);
      ASSERT_NO_FATAL_FAILURE(
          expectSame(tracker.nearestTriangle(organ, 0.0, tip), nearestTriangle(organ, tip)));
    }
  }
}

TEST(Tracker, FollowsAPointAsIfItSearchedWhereCoordinatesAreCoarse) {
  std::mt19937 generator(39);
  for (const CollisionMesh& organ : organs()) {
    const CollisionMesh far = test::farAway(organ);
    Tracker tracker;
    Eigen::Vector3d tip = randomTip(generator, far);
    for (std::size_t i = 0; i < queryCount(3000); ++i) {
      tip = moved(tip, generator, far);
      ASSERT_NO_FATAL_FAILURE(
          expectSame(tracker.nearestTriangle(far, 0.0, tip), nearestTriangle(far, tip)));
    }
  }
}

TEST(Tracker, FollowsATriangleOrASegmentAsIfItSearched) {
  std::mt19937 generator(32);
  for (const CollisionMesh& organ : organs()) {
    for (const bool is_segment : {false, true}) {
      Tracker tracker;
      Triangle tip = test::randomTriangle(generator, organ);
      for (std::size_t i = 0; i < queryCount(300); ++i) {
        for (Eigen::Vector3d* corner : {&tip.a, &tip.b, &tip.c})
          *corner = moved(*corner, generator, organ);
        if (is_segment) tip.c = tip.b;
        ASSERT_NO_FATAL_FAILURE(
            expectSame(tracker.nearestTriangle(organ, 0.0, tip), nearestTriangle(organ, tip)));
      }
    }
  }
}

/// The farthest that a vertex is moved.
double moveHeights(Points& positions, std::mt19937& generator, double most) {
  double farthest = 0.0;
  for (std::size_t i = 1; i < positions.size(); ++i) {
    const double up = randomPoint(generator, most).z();
    positions[i].z() += up;
    farthest = std::max(farthest, std::abs(up));
  }
  return farthest;
}

TEST(Tracker, FollowsAroundAVertexThatSixTrianglesShare) {
  std::mt19937 generator(36);
  Points flat = {{0, 0, 0}};
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0; i < 6; ++i) {
    flat.emplace_back(std::cos(i * M_PI / 3), std::sin(i * M_PI / 3), -0.01);
    triangles.push_back(test::corners(0, i + 1, (i + 1) % 6 + 1));
  }
  for (std::size_t fan = 0; fan < queryCount(2000); ++fan) {
    Points positions = flat;
    moveHeights(positions, generator, 0.01);
    CollisionMesh organ(TriangleMesh(positions, triangles));
    Tracker tracker;
    double travel = 0.0;
    Eigen::Vector3d tip(0, 0, std::exp(randomPoint(generator, 2.0).z()));
    for (int step = 0; step < 20; ++step) {
      if (generator() % 4 == 0) {
        travel += moveHeights(positions, generator, 0.02);
        organ.refit(positions);
      }
      if (generator() % 2 == 0) tip += randomPoint(generator, 0.02);
      ASSERT_NO_FATAL_FAILURE(
          expectSame(tracker.nearestTriangle(organ, travel, tip), nearestTriangle(organ, tip)));
    }
  }
}

/// Of so many that touch the tip, not all are looked at.
TEST(Tracker, FollowsATipThatLeavesAVertexThatHundredsOfTrianglesShare) {
  constexpr std::uint32_t kTriangles = 301;
  Points positions = {{0, 0, 0}};
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0; i < kTriangles; ++i) {
    const double angle = 2.0 * M_PI * i / kTriangles;
    positions.emplace_back(std::cos(angle), std::sin(angle), -0.1);
    triangles.push_back(test::corners(0, i + 1, (i + 1) % kTriangles + 1));
  }
  const CollisionMesh organ(TriangleMesh(positions, triangles));
  Tracker tracker;
  for (int step = 0; step < 20; ++step) {
    const Eigen::Vector3d tip(0.0, 0.0, 1e-3 * step);
    ASSERT_NO_FATAL_FAILURE(
        expectSame(tracker.nearestTriangle(organ, 0.0, tip), nearestTriangle(organ, tip)));
  }
}

TEST(Tracker, ProvesTheSignWhenItIsAskedAgain) {
  std::mt19937 generator(35);
  CollisionMesh organ(test::blob(4));
  Tracker tracker;
  double travel = 0.0;
  Eigen::Vector3d tip(0.1, 0.1, 0.1);
  for (int i = 0; i < 300; ++i) {
    if (generator() % 2 == 0) {  // turned: at the same feature the normal is another one
      const Eigen::AngleAxisd turn(0.01, Eigen::Vector3d(1, 2, 3).normalized());
      Points positions = organ.mesh().positions();
      for (Eigen::Vector3d& position : positions) position = turn * position;
      organ.refit(positions);
      travel += 0.01;
      tip = turn * tip;
    }
    const Sign sign = generator() % 2 == 0 ? Sign::kProven : Sign::kNone;
    ASSERT_NO_FATAL_FAILURE(expectSame(tracker.nearestTriangle(organ, travel, tip, sign),
                                       nearestTriangle(organ, tip, Accuracy::exact(), sign)));
  }
}

TEST(Tracker, FollowsFromAPointToATriangleAndBack) {
  const CollisionMesh organ(test::blob(4));
  Tracker tracker;
  const Eigen::Vector3d point(0.1, 0.1, 0.1);
  const Triangle triangle = {point, {0.11, 0.1, 0.1}, {0.1, 0.11, 0.0}};
  for (const int unused : {0, 1}) {
    static_cast<void>(unused);
    expectSame(tracker.nearestTriangle(organ, 0.0, point), nearestTriangle(organ, point));
    expectSame(tracker.nearestTriangle(organ, 0.0, triangle), nearestTriangle(organ, triangle));
  }
}

/// What 1000 tips cost, each `next` of the one before.
struct Looked {
  SearchWork tracked, searched;
};
Looked lookedAt(const CollisionMesh& organ,
                const std::function<Eigen::Vector3d(const Eigen::Vector3d& tip)>& next) {
  Looked looked;
  const auto add = [](const SearchWork& work, SearchWork& sum) {
    sum.bounds += work.bounds;
    sum.triangles += work.triangles;
  };
  Tracker tracker;
  Eigen::Vector3d tip(0.06, 0.06, 0.06);
  for (int i = 0; i < 1000; ++i) {
    tip = next(tip);
    add(tracker.nearestTriangle(organ, 0.0, tip).work, looked.tracked);
    add(nearestTriangle(organ, tip).work, looked.searched);
  }
  return looked;
}

TEST(Tracker, LooksAtLessThanHalfOfTheTrianglesOfASearch) {
  std::mt19937 generator(34);
  const auto [tracked,
              searched] = lookedAt(CollisionMesh(test::blob(6)), [&](const Eigen::Vector3d& tip) {
    return Eigen::Vector3d(tip + Eigen::Vector3d(1e-5, -1e-5, 0.0) + randomPoint(generator, 1e-5));
  });
  EXPECT_LT(tracked.triangles, searched.triangles / 2);
}

/// Along it, no distance changes much: who lowers bounds by the length of the way looks again.
TEST(Tracker, LooksAtAnEighthWhereTheTipGoesAlongTheSurface) {
  const Eigen::AngleAxisd turn(1e-3, Eigen::Vector3d::UnitZ());
  const auto [tracked, searched] =
      lookedAt(CollisionMesh(test::blob(6)), [&](const Eigen::Vector3d& tip) {
        return Eigen::Vector3d(turn * (0.2 * Eigen::Vector3d(tip.x(), tip.y(), 0).normalized()));
      });
  EXPECT_LT(tracked.triangles, searched.triangles / 8);
  EXPECT_LT(tracked.bounds, searched.bounds / 8);
}

TEST(Tracker, LooksAtHardlyMoreThanASearchWhereTipsJump) {
  const CollisionMesh organ(test::blob(6));
  std::mt19937 generator(36);
  const auto [tracked, searched] = lookedAt(
      organ, [&](const Eigen::Vector3d&) { return randomPoint(generator, sizeOf(organ)); });
  EXPECT_LT(tracked.triangles, searched.triangles + searched.triangles / 10);
  EXPECT_LT(tracked.bounds, searched.bounds + searched.bounds / 10);
}

TEST(Tracker, SearchesFromWhatWasNearestWhereFollowingDoesNotPay) {
  std::mt19937 generator(37);
  const auto [tracked, searched] =
      lookedAt(CollisionMesh(test::blob(7)), [&](const Eigen::Vector3d& tip) {
        return Eigen::Vector3d(tip + randomPoint(generator, 1e-4));
      });
  EXPECT_LT(tracked.bounds, searched.bounds - searched.bounds / 40);
}

TEST(Tracker, FollowsFromAPointToATriangleOfWhichOtherCornersWereKnown) {
  const CollisionMesh organ(test::blob(4));
  Tracker tracker;
  const Eigen::Vector3d above(0.0, 0.0, 0.5), beside(0.3, 0.0, 0.3);
  const Triangle triangle = {above, {-0.1, 0.0, 0.06}, {-0.1, 0.01, 0.06}};
  const Triangle moved_corner = {beside, triangle.b, triangle.c};
  expectSame(tracker.nearestTriangle(organ, 0.0, triangle), nearestTriangle(organ, triangle));
  for (int i = 0; i < 4; ++i)  // until it is followed
    expectSame(tracker.nearestTriangle(organ, 0.0, beside), nearestTriangle(organ, beside));
  expectSame(tracker.nearestTriangle(organ, 0.0, moved_corner),
             nearestTriangle(organ, moved_corner));
}

TEST(Tracker, FollowsSegmentsWhicheverOfTheirCornersCoincide) {
  std::mt19937 generator(11);
  const CollisionMesh organ(test::blob(4));
  for (int round = 0; round < 300; ++round) {
    Tracker tracker;
    Eigen::Vector3d a = randomPoint(generator, 0.2);
    Eigen::Vector3d b = a + randomPoint(generator, 0.05);
    for (int i = 0; i < 8; ++i) {
      a += randomPoint(generator, 1e-4);
      b += randomPoint(generator, 1e-4);
      const Eigen::Vector3d c = b + randomPoint(generator, 0.1);
      const std::array<Triangle, 4> tips = {{{a, b, b}, {a, a, b}, {a, b, a}, {a, b, c}}};
      const Triangle& tip = tips[i < 3 ? 0 : generator() % tips.size()];
      const NearestTriangle tracked = tracker.nearestTriangle(organ, 0.0, tip);
      const NearestTriangle searched = nearestTriangle(organ, tip);
      ASSERT_EQ(tracked.distance, searched.distance) << round << " " << i;
      ASSERT_EQ(tracked.triangle, searched.triangle) << round << " " << i;
    }
  }
}

TEST(Tracker, FollowsOnWhereATipComesBackToFromFarAway) {
  std::mt19937 generator(43);
  CollisionMesh organ(test::blob(6));
  const double size = sizeOf(organ);
  const Eigen::Vector3d middle = organ.mesh().positions()[0];
  Tracker tracker;
  double travel = 0.0;
  SearchWork tracked, searched;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d tip = middle + randomPoint(generator, 1e-4 * size);
    const NearestTriangle found = tracker.nearestTriangle(organ, travel, tip);
    const NearestTriangle expected = nearestTriangle(organ, tip);
    ASSERT_NO_FATAL_FAILURE(expectSame(found, expected));
    tracked.bounds += found.work.bounds;
    searched.bounds += expected.work.bounds;
    const Eigen::Vector3d far = tip + Eigen::Vector3d(0, 0, 1e3 * size);
    ASSERT_NO_FATAL_FAILURE(
        expectSame(tracker.nearestTriangle(organ, travel, far), nearestTriangle(organ, far)));
    Points positions = organ.mesh().positions();
    travel += moveHeights(positions, generator, 1e-6 * size);
    organ.refit(positions);
    ASSERT_NO_FATAL_FAILURE(
        expectSame(tracker.nearestTriangle(organ, travel, far), nearestTriangle(organ, far)));
  }
  EXPECT_LT(tracked.bounds, searched.bounds / 2);
}

/// Of a thin organ both sides are as near there, but for rounding.
TEST(Tracker, TellsTheNormalOfASearchAlsoFromFarAway) {
  Points points = test::cube().positions();
  for (Eigen::Vector3d& point : points)
    point = (point - Eigen::Vector3d(0.5, 0.5, 0.5)).cwiseProduct(Eigen::Vector3d(0.2, 0.2, 2e-6));
  const CollisionMesh organ({points, test::cube().triangles()});
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d tip(1e8 * (i % 20 - 10), 1e8 * (i / 20 - 10), i % 2 == 0 ? 1e11 : -1e11);
    Tracker tracker;
    ASSERT_NO_FATAL_FAILURE(
        expectSame(tracker.nearestTriangle(organ, 0.0, tip), nearestTriangle(organ, tip)));
  }
}

TEST(Tracker, RefusesATipThatIsNotANumber) {
  const CollisionMesh organ(test::cube());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Tracker().nearestTriangle(organ, 0.0, Eigen::Vector3d(0, nan, 0)),
               std::invalid_argument);
  const Triangle triangle{{0, 0, 0}, {1, 0, 0}, {0, nan, 0}};
  EXPECT_THROW(Tracker().nearestTriangle(organ, 0.0, triangle), std::invalid_argument);
}

}  // namespace
}  // namespace organ_collision::core
