// The nearest triangles of two surfaces against brute force, in random placements.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/nearest_pair_search.h"
#include "organ_collision/core/nearest_pair.h"
#include "organ_collision/core/sign.h"
#include "organ_collision/core/triangle_distance.h"
#include "organ_collision/core/vector_unit.h"
#include "organs_and_tips.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::queryCount;

const std::vector<CollisionMesh>& surfaces() {
  static const std::vector<CollisionMesh> all = {
      CollisionMesh(test::cube()), CollisionMesh(test::grid(3, 3)), CollisionMesh(test::blob(2)),
      CollisionMesh(test::soup(30, 5))};
  return all;
}

double sizeOf(const CollisionMesh& surface) {
  return (surface.health().box.high - surface.health().box.low).maxCoeff();
}

/// From touching to far, some inside, some so far that single precision does not do.
Isometry3d randomPlacement(std::mt19937& generator, const CollisionMesh& first,
                           const CollisionMesh& second) {
  const double reach =
      std::ldexp(sizeOf(first) + sizeOf(second), 2 - static_cast<int>(generator() % 8)) *
      (generator() % 8 == 0 ? std::ldexp(1.0, static_cast<int>(generator() % 20)) : 1.0);
  Isometry3d pose = test::randomPose(generator, reach);
  if (generator() % 8 == 0) {  // a vertex on a vertex
    const Points& ours = first.mesh().positions();
    const Points& theirs = second.mesh().positions();
    pose.translation() =
        theirs[generator() % theirs.size()] - pose.linear() * ours[generator() % ours.size()];
    return pose;
  }
  const Box& box = second.health().box;
  return Eigen::Translation3d(0.5 * (box.low + box.high)) * pose;
}

bool holds(const CollisionMesh& solid, const Vector3d& point) {
  return solid.health().isSolid() && windingNumber(solid, point) != 0;
}

double truth(const CollisionMesh& first, const Isometry3d& pose, const CollisionMesh& second) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < first.mesh().triangleCount(); ++i) {
    const auto [a, b, c] = first.mesh().triangle(TriangleId(i));
    const Triangle moved = {pose * a, pose * b, pose * c};
    for (std::size_t k = 0; k < second.mesh().triangleCount(); ++k) {
      const ClosestPair pair = closestPoints(moved, second.mesh().triangle(TriangleId(k)));
      least = std::min(least, pair.on_second.squared_distance);
    }
  }
  const auto any_inside = [](const CollisionMesh& solid, const Isometry3d& solid_from_other,
                             const CollisionMesh& other) {
    const auto& parts = other.topology().parts();
    return std::any_of(parts.begin(), parts.end(), [&](VertexId vertex) {
      return holds(solid, solid_from_other * other.mesh().position(vertex));
    });
  };
  const bool inside =
      least > 0.0 && (any_inside(second, pose, first) ||
                      any_inside(first, Isometry3d(pose.inverse(Eigen::Affine)), second));
  return inside ? -std::sqrt(least) : std::sqrt(least);
}

/// Bit for bit; the side only where it is not rounding that puts a vertex there.
void expectTruth(double expected, const CollisionMesh& first, const Isometry3d& pose,
                 const CollisionMesh& second) {
  const NearestTriangle nearest = nearestPair(first, pose, second).nearest;
  ASSERT_EQ(std::abs(nearest.distance), std::abs(expected));
  if (std::abs(expected) > 2 * poseRounding(first, pose, second)) {
    ASSERT_EQ(nearest.distance, expected);
  }
  ASSERT_TRUE(nearest.isExact());
}
void expectTruth(const CollisionMesh& first, const Isometry3d& pose, const CollisionMesh& second) {
  expectTruth(truth(first, pose, second), first, pose, second);
}

/// Calls `check(first, pose, second)` for random placements of all surfaces.
template <class Check>
void forEachPlacement(unsigned seed, std::size_t count, const Check& check) {
  std::mt19937 generator(seed);
  for (const CollisionMesh& first : surfaces()) {
    for (const CollisionMesh& second : surfaces()) {
      for (std::size_t i = 0; i < count && !testing::Test::HasFailure(); ++i) {
        const Isometry3d pose = randomPlacement(generator, first, second);
        check(first, pose, second);
      }
    }
  }
}

TEST(NearestPair, EqualsBruteForceBitForBit) {
  std::size_t meeting = 0;
  std::size_t inside = 0;
  forEachPlacement(
      75, queryCount(12),
      [&](const CollisionMesh& first, const Isometry3d& pose, const CollisionMesh& second) {
        const double expected = truth(first, pose, second);
        ASSERT_NO_FATAL_FAILURE(expectTruth(expected, first, pose, second));
        meeting += expected == 0.0 ? 1 : 0;
        inside += expected < 0.0 ? 1 : 0;
      });
  EXPECT_GT(meeting, 0U);
  EXPECT_GT(inside, 0U);
}

TEST(NearestPair, BoundsHoldTheTruthAtEverySetting) {
  const std::vector<Accuracy> settings = {{0, 0, 1}, {0.1, 0, 0}, {0, 1e-2, 0}, {0.05, 1e-3, 16}};
  forEachPlacement(
      76, queryCount(20),
      [&](const CollisionMesh& first, const Isometry3d& pose, const CollisionMesh& second) {
        const double exact = truth(first, pose, second);
        for (const Accuracy& accuracy : settings) {
          const NearestTriangle nearest = nearestPair(first, pose, second, accuracy).nearest;
          const double expected = nearest.distance_signed ? exact : std::abs(exact);
          const double slack =
              test::rounding(second, pose.translation()) + test::rounding(first, {0, 0, 0});
          ASSERT_LE(nearest.lower_bound, expected + slack);
          ASSERT_GE(nearest.upper_bound, expected - slack);
          if (accuracy.max_leaves != 0) continue;
          ASSERT_LE(std::abs(nearest.distance),
                    std::max((1 + accuracy.max_relative_error) * std::abs(exact),
                             std::abs(exact) + accuracy.max_absolute_error) +
                        slack);
        }
      });
}

TEST(NearestPair, SwappedHasTheSameDistance) {
  forEachPlacement(
      77, queryCount(5),
      [&](const CollisionMesh& first, const Isometry3d& pose, const CollisionMesh& second) {
        const double exact = truth(first, pose, second);
        constexpr double kRoundings = 16;  // of the coordinates in two frames
        const double slack = kRoundings * (test::rounding(second, pose.translation()) +
                                           test::rounding(first, pose.inverse().translation()));
        const NearestPair swapped = nearestPair(second, pose.inverse(), first);
        ASSERT_NEAR(swapped.nearest.distance, exact, slack);
      });
}

TEST(NearestPair, MovingBothChangesNothingButRounding) {
  std::mt19937 generator(87);
  for (const CollisionMesh& second : surfaces()) {
    const Isometry3d move = test::randomPose(generator, 1.0);
    Points positions = second.mesh().positions();
    for (Vector3d& position : positions) position = move * position;
    const CollisionMesh moved({positions, second.mesh().triangles()});
    for (const CollisionMesh& first : surfaces()) {
      for (std::size_t i = 0; i < queryCount(50); ++i) {
        const Isometry3d pose = randomPlacement(generator, first, second);
        const NearestTriangle before = nearestPair(first, pose, second).nearest;
        const NearestTriangle after = nearestPair(first, move * pose, moved).nearest;
        constexpr double kRoundings = 16;  // of the coordinates in two places
        const double slack =
            kRoundings * (test::rounding(second, pose.translation()) +
                          test::rounding(first, {0, 0, 0}) + test::rounding(moved, {0, 0, 0}));
        ASSERT_TRUE(std::abs(before.distance - after.distance) <= slack ||
                    std::abs(before.distance) <= slack);
      }
    }
  }
}

TEST(NearestPair, OfSurfacesOfUnlikeSizesEqualsBruteForceBitForBit) {
  std::mt19937 generator(80);
  const CollisionMesh organ(test::blob(2));
  for (std::size_t i = 0; i < queryCount(60); ++i) {
    const double size = std::ldexp(1.0, 30 - static_cast<int>(generator() % 60));
    const CollisionMesh tool(test::cube(size));
    const Isometry3d pose = randomPlacement(generator, tool, organ);
    ASSERT_NO_FATAL_FAILURE(expectTruth(tool, pose, organ)) << size;
    ASSERT_NO_FATAL_FAILURE(expectTruth(organ, pose.inverse(), tool)) << size;
  }
}

/// A triangle astray makes a surface so large that single precision knows its squares no more.
TEST(NearestPair, OfASurfaceWithATriangleAstrayEqualsBruteForceBitForBit) {
  std::mt19937 generator(97);
  const CollisionMesh tool(test::blob(1));
  for (const int exponent : {30, 45, 70, 130, 200, 450}) {
    const double far = std::ldexp(1.0, exponent);
    Points points = test::blob(2).positions();
    std::vector<Corners> triangles = test::blob(2).triangles();
    const std::size_t first = points.size();
    for (int i = 0; i < 3; ++i) {
      Vector3d corner(far, far, far);
      corner[i] = -far;
      points.push_back(corner);
    }
    triangles.push_back(test::corners(first, first + 1, first + 2));
    const CollisionMesh organ(TriangleMesh(std::move(points), std::move(triangles)));
    for (int i = 0; i < 10; ++i) {
      const Isometry3d pose = test::randomPose(generator, 0.7);
      ASSERT_NO_FATAL_FAILURE(expectTruth(tool, pose, organ)) << exponent;
      ASSERT_NO_FATAL_FAILURE(expectTruth(organ, pose.inverse(), tool)) << exponent;
    }
  }
}

/// Hierarchies of many levels, with nodes and packets side by side in every node.
TEST(NearestPair, OfDeepHierarchiesEqualsBruteForceBitForBit) {
  std::mt19937 generator(84);
  const CollisionMesh first(test::halvings(40));
  const CollisionMesh second(test::shuffled(test::halvings(25), 1));
  for (std::size_t i = 0; i < queryCount(30); ++i) {
    const Isometry3d pose = randomPlacement(generator, first, second);
    ASSERT_NO_FATAL_FAILURE(expectTruth(first, pose, second));
    ASSERT_NO_FATAL_FAILURE(expectTruth(second, pose.inverse(), first));
  }
}

/// Triangles so thin that single precision gets their normals wrong.
TEST(NearestPair, OfNeedlesEqualsBruteForceBitForBit) {
  std::mt19937 generator(85);
  for (std::size_t i = 0; i < queryCount(100); ++i) {
    const auto needles = [&generator] {
      Points points;
      std::vector<Corners> triangles;
      for (std::size_t corner = 0; corner < 60; corner += 3) {
        const Vector3d a = test::randomPoint(generator, 1.0);
        const Vector3d b = a + test::randomPoint(generator, 0.3);
        const Vector3d c = a + 0.37 * (b - a) + test::randomPoint(generator, 1e-9);
        points.insert(points.end(), {a, b, c});
        triangles.push_back(test::corners(corner, corner + 1, corner + 2));
      }
      return CollisionMesh({points, triangles});
    };
    const CollisionMesh first = needles();
    const CollisionMesh second = needles();
    const Isometry3d pose = test::randomPose(generator, 1.0);
    ASSERT_NO_FATAL_FAILURE(expectTruth(first, pose, second));
  }
}

/// Where all are equally far but for rounding, a bound that forgets its own leaves the nearest out.
TEST(NearestPair, OfParallelSurfacesEqualsBruteForceBitForBit) {
  std::mt19937 generator(82);
  const TriangleMesh grid = test::grid(4, 4);
  for (std::size_t i = 0; i < queryCount(100); ++i) {
    const Isometry3d tilt = test::randomPose(generator, 1000.0);  // rounds more than once
    Points tilted = grid.positions();
    for (Vector3d& position : tilted) position = tilt * position;
    const CollisionMesh first(grid);
    const CollisionMesh second({tilted, grid.triangles()});
    const double turn = test::randomPoint(generator, 3.0).x();
    const Isometry3d pose =
        tilt * Eigen::Translation3d(0, 0, std::ldexp(1.0, static_cast<int>(generator() % 8) - 4)) *
        Eigen::AngleAxisd(turn, Vector3d::UnitZ());
    ASSERT_NO_FATAL_FAILURE(expectTruth(first, pose, second));
  }
}

TEST(NearestPair, IsTheSameOnEveryVectorUnit) {
  const VectorUnit usual = vectorUnit();
  forEachPlacement(
      81, queryCount(5),
      [&](const CollisionMesh& first, const Isometry3d& pose, const CollisionMesh& second) {
        useVectorUnit(VectorUnit::kBaseline);
        const NearestPair expected = nearestPair(first, pose, second, {0.1, 0, 0});
        for (const VectorUnit unit : availableVectorUnits()) {
          useVectorUnit(unit);
          const NearestPair found = nearestPair(first, pose, second, {0.1, 0, 0});
          ASSERT_EQ(found.triangle_of_first, expected.triangle_of_first);
          ASSERT_EQ(found.nearest.triangle, expected.nearest.triangle);
          ASSERT_EQ(found.nearest.lower_bound, expected.nearest.lower_bound);
        }
      });
  useVectorUnit(usual);
}

}  // namespace
}  // namespace organ_collision::core
