#include "organ_collision/core/collision_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "brute_force.h"
#include "every_vector_unit.h"
#include "inspect.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organs_and_tips.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using test::queryCount;

Points twisted(const Points& points, double turns_per_metre) {
  Points result = points;
  for (Eigen::Vector3d& point : result) {
    point = Eigen::AngleAxisd(turns_per_metre * point.x(), Eigen::Vector3d::UnitX()) * point;
  }
  return result;
}

Points flattened(const Points& points) {
  Points result = points;
  for (Eigen::Vector3d& point : result) point.z() = 0.0;
  return result;
}

void expectBruteForce(const CollisionMesh& organ, std::mt19937& generator) {
  for (std::size_t i = 0; i < queryCount(500); ++i) {
    const Eigen::Vector3d tip = test::randomPoint(generator, 0.2);
    const NearestTriangle nearest = nearestTriangle(organ, tip);
    ASSERT_EQ(std::abs(nearest.distance),
              std::sqrt(test::squaredDistanceByBruteForce(organ.mesh(), tip)));
  }
}

class MovedMesh : public test::EveryVectorUnit {};
ORGAN_COLLISION_ON_EVERY_VECTOR_UNIT(MovedMesh);

TEST_P(MovedMesh, AnswersAtItsNewPlaceAfterRefitAndRebuild) {
  std::mt19937 generator(31);
  const Points original = test::blob(4).positions();
  CollisionMesh organ(test::blob(4));
  for (const Points& deformed : {twisted(original, 20.0), flattened(original), original}) {
    organ.refit(deformed);
    expectBruteForce(organ, generator);
    organ.rebuild();
    expectBruteForce(organ, generator);
  }
}

TEST_P(MovedMesh, AnswersLikeANewOneAfterAPartialRefit) {
  std::mt19937 generator(32);
  const double sizes[] = {0.001, 0.02, 0.3};  // [m] the last is beyond the box
  for (const TriangleMesh& mesh : {test::blob(4), test::grid(20, 20), test::soup(300, 3)}) {
    CollisionMesh organ(mesh);
    for (std::size_t round = 0; round < queryCount(60); ++round) {
      Points all = organ.mesh().positions();
      std::vector<VertexId> moved;
      Points positions;
      const Eigen::Vector3d push = test::randomPoint(generator, sizes[round % 3]);
      const std::size_t first = generator() % all.size();
      for (std::size_t i = first; i < std::min(first + 1 + generator() % 30, all.size()); ++i) {
        all[i] += push;
        moved.push_back(static_cast<VertexId>(i));
        positions.push_back(all[i]);
      }
      organ.refit(moved, positions);
      const MeshHealth expected = test::inspect(organ.mesh(), organ.topology());
      EXPECT_EQ(organ.health().box.low, expected.box.low);
      EXPECT_EQ(organ.health().box.high, expected.box.high);
      EXPECT_EQ(organ.health().degenerate_triangles, expected.degenerate_triangles);
      EXPECT_EQ(organ.health().closed, expected.closed);
      EXPECT_EQ(organ.health().inverted, expected.inverted);
      for (std::size_t i = 0; i < queryCount(60); ++i) {
        const Eigen::Vector3d tip =
            i % 2 == 0 ? all[generator() % all.size()]
                       : Eigen::Vector3d(positions[0] + test::randomPoint(generator, 0.1));
        ASSERT_EQ(std::abs(nearestTriangle(organ, tip).distance),
                  std::sqrt(test::squaredDistanceByBruteForce(organ.mesh(), tip)));
        ASSERT_EQ(nearestTriangle(organ, tip, Accuracy::greedy()).triangle,
                  organ.tree().triangle(test::greedyPath(organ.tree(), organ.mesh(), tip).first));
      }
    }
  }
}

TEST_P(MovedMesh, KnowsWhetherItIsInvertedHoweverThinItIs) {
  const TriangleMesh blob = test::blob(4);
  const Eigen::Matrix3d tilt =
      Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  CollisionMesh organ(blob);
  for (int exponent = 0; exponent > -40; exponent -= 4) {
    for (const double thickness : {std::ldexp(1.0, exponent), -std::ldexp(1.0, exponent)}) {
      Points pressed = blob.positions();
      for (Eigen::Vector3d& point : pressed)
        point = tilt * Eigen::Vector3d(point.x(), point.y(), thickness * point.z());
      organ.refit(pressed);
      EXPECT_EQ(organ.health().inverted, thickness < 0.0) << thickness;
      organ.refit({VertexId{0}}, {pressed[0]});
      EXPECT_EQ(organ.health().inverted, thickness < 0.0) << thickness;
      EXPECT_EQ(CollisionMesh(organ.mesh()).health().inverted, thickness < 0.0) << thickness;
    }
  }
}

TEST(CollisionMesh, VerticesOfNoTriangleStayOutOfTheBox) {
  Points points = test::cube().positions();
  points.emplace_back(0, 0, 100);
  CollisionMesh organ(TriangleMesh(points, test::cube().triangles()));
  EXPECT_EQ(organ.health().box.high.z(), 1.0);
  organ.refit(points);
  EXPECT_EQ(organ.health().box.high.z(), 1.0);
}

TEST(CollisionMesh, VerticesOfNoTriangleStayOutOfTheBoxOfAPartialRefit) {
  Points points = test::cube().positions();
  points.emplace_back(0, 0, 100);
  CollisionMesh organ(TriangleMesh(points, test::cube().triangles()));
  organ.refit({VertexId{7}, VertexId{8}}, {{1, 1, 1.5}, {0, 0, 200}});
  EXPECT_EQ(organ.health().box.high.z(), 1.5);
}

TEST(CollisionMesh, HasTheBoxOfWhatMovesAlongAFaceOfItOrOffIt) {
  Points points = test::cube().positions();
  points.emplace_back(0, 0, 100);  // of no triangle
  for (const std::size_t count : {points.size() - 1, points.size()}) {
    CollisionMesh organ(
        TriangleMesh({points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count)},
                     test::cube().triangles()));
    std::vector<VertexId> top;
    for (std::size_t i = 0; i < count; ++i)
      if (points[i].z() > 0.0) top.push_back(static_cast<VertexId>(i));
    const auto height_with = [&](const std::vector<double>& heights) {
      Points moved;
      for (const double height : heights) moved.emplace_back(0.5, 0.25, height);
      organ.refit({top.begin(), top.begin() + static_cast<std::ptrdiff_t>(heights.size())}, moved);
      return organ.health().box.high.z();
    };
    EXPECT_EQ(height_with({1.0}), 1.0);
    EXPECT_EQ(height_with({0.5}), 1.0);
    EXPECT_EQ(height_with({0.5, 0.5, 0.75, 0.5}), 0.75);
    EXPECT_EQ(height_with({0.75, 0.5, 0.5}), 0.75);
    EXPECT_EQ(height_with({1.5}), 1.5);
    EXPECT_EQ(height_with({0.25}), 0.5);
  }
}

/// Single precision counts on it.
TEST(CollisionMesh, StaysClosedWhereAVertexOfNoTriangleLeavesAnother) {
  const TriangleMesh cube = test::cube();
  Points points = cube.positions();
  points.insert(points.begin(), points.front());  // where the next one is, and of no triangle
  std::vector<Corners> triangles;
  for (const Corners& corners : cube.triangles())
    triangles.push_back(
        test::corners(index(corners[0]) + 1, index(corners[1]) + 1, index(corners[2]) + 1));
  CollisionMesh organ(TriangleMesh(points, triangles));
  EXPECT_TRUE(organ.health().isSolid());
  organ.refit({VertexId{0}}, {Eigen::Vector3d(5, 5, 5)});
  EXPECT_TRUE(organ.health().isSolid());
  organ.refit({VertexId{1}}, {Eigen::Vector3d(-0.25, 0, 0)});
  EXPECT_TRUE(organ.health().isSolid());
  EXPECT_TRUE(CollisionMesh(organ.mesh()).health().isSolid());
}

TEST(CollisionMesh, HasAFrameThatFitsWhereAPartialRefitMovesAVertexFarAway) {
  CollisionMesh organ(test::blob(3));
  organ.refit({VertexId{5}}, {Eigen::Vector3d(0.0, 0.0, 100.0)});
  EXPECT_EQ(organ.health().box.high.z(), 100.0);
  EXPECT_LE(largestCoordinate(organ.wideTree().frame()(organ.health().box.high)), 1.0);
  EXPECT_LE(largestCoordinate(organ.wideTree().frame()(organ.health().box.low)), 1.0);
}

TEST(CollisionMesh, HasAFrameThatFitsWhereAPartialRefitMovesAVertexALittle) {
  CollisionMesh organ(test::blob(3));
  for (double z = 1.0; z < 4.0; z += 0.0625) {
    organ.refit({VertexId{5}}, {Eigen::Vector3d(0.0, 0.0, z)});
    ASSERT_LE(largestCoordinate(organ.wideTree().frame()(organ.health().box.high)), 1.0);
    ASSERT_LE(largestCoordinate(organ.wideTree().frame()(organ.health().box.low)), 1.0);
  }
}

/// A grid of which one vertex was taken to that x, and back.
CollisionMesh gridOnceAsWideAs(double x) {
  CollisionMesh organ(test::grid(4, 4));
  const Eigen::Vector3d place = organ.mesh().positions().back();
  const auto last = static_cast<VertexId>(organ.mesh().positions().size() - 1);
  organ.refit({last}, {Eigen::Vector3d(x, 0, 0)});
  organ.refit({last}, {place});
  return organ;
}

TEST(CollisionMesh, HasAFrameThatFitsAgainAfterARebuild) {
  CollisionMesh organ = gridOnceAsWideAs(100.0);
  EXPECT_LT(organ.wideTree().frame().scale, 0.1) << "near enough to be kept";
  organ.rebuild();
  EXPECT_EQ(organ.wideTree().frame().scale, CollisionMesh(organ.mesh()).wideTree().frame().scale);
}

TEST(CollisionMesh, HasAFrameThatFitsAgainWhereAPartialRefitTakesAVertexBack) {
  const CollisionMesh organ = gridOnceAsWideAs(1e6);
  EXPECT_EQ(organ.wideTree().frame().scale, CollisionMesh(organ.mesh()).wideTree().frame().scale);
}

TEST(CollisionMesh, AnswersHoweverFarItWasMoved) {
  std::mt19937 generator(34);
  const TriangleMesh row = test::row(101);
  for (const double way : {-1e7, 1e7}) {
    CollisionMesh whole(row);
    CollisionMesh part(row);
    Points points = row.positions();
    std::vector<VertexId> moved;
    Points positions;
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i].x() += way;
      if (i >= points.size() / 2) continue;
      moved.push_back(static_cast<VertexId>(i));
      positions.push_back(points[i]);
    }
    whole.refit(points);
    part.refit(moved, positions);
    for (const CollisionMesh* organ : {&whole, &part}) {
      for (std::size_t i = 0; i < queryCount(500); ++i) {
        const Eigen::Vector3d tip =
            Eigen::Vector3d(way + 25.0, 0, 0) + test::randomPoint(generator, 25.0);
        ASSERT_EQ(nearestTriangle(*organ, tip).distance,
                  std::sqrt(test::squaredDistanceByBruteForce(organ->mesh(), tip)));
      }
    }
  }
}

TEST(CollisionMesh, IsClosedAgainWhenVerticesThatPartedTogetherMeetOneByOne) {
  const TriangleMesh cube = test::cube();
  Points points;
  std::vector<Corners> triangles;
  for (const Corners& corners : cube.triangles()) {  // with vertices of its own
    const std::size_t first = points.size();
    for (const VertexId corner : corners) points.push_back(cube.position(corner));
    triangles.push_back(test::corners(first, first + 1, first + 2));
  }
  CollisionMesh organ(TriangleMesh(points, triangles));
  organ.refit({VertexId{0}, VertexId{1}}, {{-0.1, 0, 0}, {-0.2, 0, 0}});
  EXPECT_FALSE(organ.health().closed);
  organ.refit({VertexId{0}}, {points[0]});
  EXPECT_FALSE(organ.health().closed);
  organ.refit({VertexId{1}}, {points[1]});
  EXPECT_TRUE(organ.health().closed);
}

TEST(CollisionMesh, FindsTrianglesThatAreFlatExactlyThoughNotInSinglePrecision) {
  std::mt19937 generator(35);
  for (int i = 0; i < 20; ++i) {
    const auto whole = [&](double most) {
      return Eigen::Vector3d(test::randomPoint(generator, most).array().round() * 0x1p-40);
    };
    const Eigen::Vector3d corner = whole(0x1p40);
    const Eigen::Vector3d step = whole(0x1p38);
    const CollisionMesh organ(TriangleMesh({corner, corner + step, corner + 3 * step, {2, 2, 2}},
                                           {test::corners(0, 1, 2), test::corners(0, 1, 3)}));
    EXPECT_EQ(organ.health().degenerate_triangles, 1);
  }
}

TEST(CollisionMesh, KnowsThatPartialRefitsTurnedItInsideOut) {
  CollisionMesh organ(test::cube());
  std::vector<VertexId> all;
  Points smaller;
  for (std::uint32_t i = 0; i < 8; ++i) {
    all.push_back(VertexId{i});
    smaller.push_back(organ.mesh().position(VertexId{i}).cwiseProduct(Eigen::Vector3d(1, 1, -0.5)));
  }
  organ.refit(all, smaller);
  EXPECT_TRUE(organ.health().inverted);
}

/// Two bodies, 1.5 apart, of 0.1 times that size.
TriangleMesh twoBodies(double size, std::mt19937& generator) {
  const Eigen::Vector3d apart(1.5, 0.3, 0.2);
  return test::joined(test::placed(test::blob(2), size, test::randomPoint(generator, 0.2)),
                      test::placed(test::blob(2), size, apart + test::randomPoint(generator, 0.2)));
}

TEST(CollisionMesh, KnowsWhetherItIsInvertedHoweverSmallItsPartsAre) {
  std::mt19937 generator(1);
  for (int exponent = 0; exponent > -40; exponent -= 2) {
    for (int i = 0; i < 10; ++i) {
      const TriangleMesh bodies = twoBodies(std::ldexp(1.0, exponent), generator);
      EXPECT_FALSE(CollisionMesh(bodies).health().inverted) << exponent;
      EXPECT_TRUE(CollisionMesh(test::turned(bodies)).health().inverted) << exponent;
    }
  }
}

TEST(CollisionMesh, KnowsItWhenPartialRefitsMadeItsPartsSmall) {
  std::mt19937 generator(1);
  for (int exponent = -12; exponent > -40; --exponent) {
    const TriangleMesh large = twoBodies(3.0, generator);
    const std::size_t half = large.positions().size() / 2;
    CollisionMesh organ(large);
    for (std::uint32_t i = 0; i < 2 * half; ++i) {
      const Eigen::Vector3d& centre = large.positions()[i < half ? 0 : half];
      organ.refit({VertexId{i}},
                  {centre + std::ldexp(1.0, exponent) * (large.positions()[i] - centre)});
    }
    EXPECT_FALSE(organ.health().inverted) << exponent;
  }
}

TEST(CollisionMesh, RebuildEqualsANewOne) {
  const Points deformed = twisted(test::blob(4).positions(), 20.0);
  CollisionMesh organ(test::blob(4));
  organ.refit(deformed);
  organ.rebuild();
  const CollisionMesh fresh(TriangleMesh(deformed, test::blob(4).triangles()));
  for (FarthestPairTree::Leaf leaf = 0; leaf < fresh.tree().root().size(); ++leaf)
    EXPECT_EQ(organ.tree().triangle(leaf), fresh.tree().triangle(leaf));
}

TEST(CollisionMesh, ACopyKeepsAnsweringForItsOwnPositions) {
  const CollisionMesh before(test::cube());
  CollisionMesh after = before;
  Points moved = test::cube().positions();
  for (Eigen::Vector3d& point : moved) point.z() += 1.0;
  after.refit(moved);
  const Eigen::Vector3d tip(0.5, 0.5, 3.0);
  EXPECT_EQ(nearestTriangle(before, tip).distance, 2.0);
  EXPECT_EQ(nearestTriangle(after, tip).distance, 1.0);
}

TEST(CollisionMesh, StaysAsItWasWhenPositionsDoNotFit) {
  CollisionMesh organ(test::cube());
  EXPECT_THROW(organ.refit(Points{{0, 0, 0}}), std::invalid_argument);
  const VertexId last{7};
  EXPECT_THROW(organ.refit({last}, {}), std::invalid_argument);
  EXPECT_THROW(organ.refit({last, VertexId{8}}, {{0, 0, 9}, {0, 0, 9}}), std::invalid_argument);
  EXPECT_THROW(organ.refit({last, last}, {{0, 0, 9}, {0, NAN, 9}}), std::invalid_argument);
  EXPECT_EQ(nearestTriangle(organ, Eigen::Vector3d(0.5, 0.5, 3.0)).distance, 2.0);
}

TEST(CollisionMesh, TakesTheLastOfTwoPlacesOfAVertex) {
  CollisionMesh organ(test::cube());
  const VertexId vertex{0};
  const Eigen::Vector3d before = organ.mesh().position(vertex);
  organ.refit({vertex, vertex}, {{-100, 0, 0}, before});
  EXPECT_EQ(organ.mesh().position(vertex), before);
  EXPECT_EQ(organ.health().box.low, CollisionMesh(test::cube()).health().box.low);
}

TEST(CollisionMesh, MayBeSmallerThanNumbersCanScaleUp) {
  for (const double size : {1e-307, 1e-308, 1e-310, 5e-324}) {
    const CollisionMesh organ(test::cube(size));
    EXPECT_TRUE(std::isfinite(organ.wideTree().frame().scale));
    const Eigen::Vector3d near(0.5 * size, 0.5 * size, 3 * size);
    for (const Eigen::Vector3d& tip : {near, Eigen::Vector3d(0.1, 0.2, 0.3)}) {
      const double distance = std::abs(nearestTriangle(organ, tip).distance);
      EXPECT_NEAR(distance, tip.norm(), 1e-15);
    }
  }
}

/// So far from the many that they are a node high up in the tree.
TEST(CollisionMesh, HoldsAFewTrianglesFarFromManyToo) {
  TriangleMesh few = test::placed(test::subdivided(test::cube()), 0.1, {5, 5, 5});
  std::vector<Corners> triangles = few.triangles();
  triangles.push_back(test::corners(0, 0, 1));
  few = {few.positions(), triangles};
  CollisionMesh organ(test::joined(test::blob(5), few));
  std::mt19937 generator(12);
  for (const bool is_refitted : {false, true}) {
    if (is_refitted) {
      Points positions = organ.mesh().positions();
      for (Eigen::Vector3d& position : positions) position *= 1.25;
      organ.refit(positions);
    }
    EXPECT_EQ(organ.health().degenerate_triangles, 1U);
    for (int i = 0; i < 30; ++i) {
      const Eigen::Vector3d tip = organ.health().box.high + test::randomPoint(generator, 0.2);
      const double distance = nearestTriangle(organ, tip, {}, Sign::kNone).distance;
      EXPECT_EQ(distance, std::sqrt(test::squaredDistanceByBruteForce(organ.mesh(), tip)));
    }
  }
}

}  // namespace
}  // namespace organ_collision::core
