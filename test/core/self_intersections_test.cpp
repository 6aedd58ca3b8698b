#include "organ_collision/core/self_intersections.h"

#include <gmock/gmock.h>

#include <array>
#include <random>
#include <string>
#include <vector>

#include "organ_collision/core/predicates.h"
#include "organ_collision/core/triangle_intersection.h"
#include "test_meshes.h"

namespace organ_collision::core {

bool operator==(const TrianglePair& left, const TrianglePair& right) {
  return left.first == right.first && left.second == right.second;
}

namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr std::size_t kAll = 1'000'000;

TriangleMesh soupOf(const std::vector<Triangle>& triangles) {
  Points points;
  std::vector<Corners> corners;
  for (const Triangle& triangle : triangles) {
    const std::size_t first = points.size();
    for (const Vector3d& corner : cornersOf(triangle)) points.push_back(corner);
    corners.push_back(test::corners(first, first + 1, first + 2));
  }
  return {points, corners};
}

bool crossEachOther(const Triangle& first, const Triangle& second) {
  const SelfIntersections found = selfIntersections(CollisionMesh(soupOf({first, second})), kAll);
  EXPECT_TRUE(found.complete);
  return !found.pairs.empty();
}

const Vector3d kO(0, 0, 0), kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

TEST(SelfIntersections, AreNotWhereNeighboursMeet) {
  EXPECT_FALSE(crossEachOther({kO, kX, kY}, {kO, kY, -kX})) << "an edge, flat";
  EXPECT_FALSE(crossEachOther({kO, kX, kY}, {kX, kO, kZ})) << "an edge, bent";
  EXPECT_FALSE(crossEachOther({kO, kX, kY}, {kO, -kX, -kY})) << "a corner";
  EXPECT_FALSE(crossEachOther({kO, kX, kY}, {2 * kX, 2 * kY, 3 * kX})) << "nothing";
}

TEST(SelfIntersections, AreWhereTrianglesShareMore) {
  EXPECT_TRUE(crossEachOther({kO, kX, kY}, {kO, kX, 3 * kY + kX})) << "folded over the edge";
  EXPECT_TRUE(crossEachOther({kO, kX, kY}, {kO, kX + kY + kZ, kX + kY - kZ})) << "from a corner on";
  EXPECT_TRUE(crossEachOther({kO, kX, kY}, {kO, 2 * kX, -kZ})) << "part of an edge";
  EXPECT_TRUE(crossEachOther({kO, kX, kY}, {kO, kY, kX})) << "all";
  EXPECT_TRUE(crossEachOther({kO, kX, kY}, {0.2 * (kX + kY), kZ, kX + kZ})) << "touched inside";
  EXPECT_TRUE(crossEachOther({kO, kX, kY}, {0.5 * kX, kX - kY, -kY})) << "touched at an edge";
}

TEST(SelfIntersections, LeaveOutTrianglesOfNoArea) {
  EXPECT_FALSE(crossEachOther({kO, kX, kY}, {-kZ, kZ, kZ}));
  EXPECT_FALSE(crossEachOther({0.2 * (kX + kY), kZ, 2 * kZ - 0.2 * (kX + kY)}, {kO, kX, kY}));
}

/// By other pieces than the edges across a corner: what is left of a triangle beyond the middles of
/// the edges that meet there; points ever nearer to a shared edge.
bool haveMoreInCommon(const Triangle& first, const Triangle& second) {
  const std::array<Vector3d, 3> ours = cornersOf(first), theirs = cornersOf(second);
  std::vector<std::size_t> our_shared, their_shared;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (ours[i] != theirs[k]) continue;
      our_shared.push_back(i);
      their_shared.push_back(k);
    }
  }
  const auto rest_meets = [](const std::array<Vector3d, 3>& corners, std::size_t shared,
                             const Triangle& other) {
    const Vector3d& next = corners[(shared + 1) % 3];
    const Vector3d& last = corners[(shared + 2) % 3];
    const Vector3d to_next = 0.5 * (corners[shared] + next);
    const Vector3d to_last = 0.5 * (corners[shared] + last);
    return trianglesIntersect({to_next, next, last}, other) ||
           trianglesIntersect({to_next, last, to_last}, other);
  };
  if (our_shared.empty()) return trianglesIntersect(first, second);
  if (our_shared.size() == 3) return true;
  if (our_shared.size() == 1)
    return rest_meets(ours, our_shared[0], second) || rest_meets(theirs, their_shared[0], first);
  const Vector3d middle = 0.5 * (ours[our_shared[0]] + ours[our_shared[1]]);
  const Vector3d& apex = ours[3 - our_shared[0] - our_shared[1]];
  const Vector3d inside = middle + 0x1p-8 * (apex - middle);
  return trianglesIntersect({inside, inside, inside}, second);
}

TEST(SelfIntersections, AreThoseOfEveryPairOfTrianglesOnALattice) {
  std::mt19937 generator(57);
  const auto lattice_point = [&] {
    const auto coordinate = [&] { return static_cast<double>(generator() % 3); };
    const double x = coordinate();
    const double y = coordinate();
    return Vector3d(x, y, coordinate());
  };
  int crossing = 0, apart = 0;
  for (int i = 0; i < 20000; ++i) {
    const Triangle first = {lattice_point(), lattice_point(), lattice_point()};
    Triangle second = {lattice_point(), lattice_point(), lattice_point()};
    if (i % 3 > 0) second.b = first.c;
    if (i % 3 > 1) second.c = first.a;
    if (collinear(first.a, first.b, first.c) || collinear(second.a, second.b, second.c)) continue;
    const bool expected = haveMoreInCommon(first, second);
    ASSERT_EQ(crossEachOther(first, second), expected) << i;
    ++(expected ? crossing : apart);
  }
  EXPECT_GT(crossing, 2000);
  EXPECT_GT(apart, 2000);
}

/// A ball of which some vertices are anywhere.
TriangleMesh crumpled(std::mt19937& generator, double reach) {
  const TriangleMesh ball = test::blob(3);
  Points points = ball.positions();
  for (std::size_t i = 0; i < points.size(); i += 5)
    points[i] += test::randomPoint(generator, reach);
  return {points, ball.triangles()};
}

TEST(SelfIntersections, AreAllThatThereAreInAMesh) {
  std::mt19937 generator(58);
  for (const double reach : {0.001, 0.02, 0.2}) {
    const TriangleMesh mesh = crumpled(generator, reach);
    std::vector<TrianglePair> expected;
    for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
      for (std::size_t k = i + 1; k < mesh.triangleCount(); ++k) {
        const auto first = static_cast<TriangleId>(i);
        const auto second = static_cast<TriangleId>(k);
        if (haveMoreInCommon(mesh.triangle(first), mesh.triangle(second)))
          expected.push_back({first, second});
      }
    }
    const SelfIntersections found = selfIntersections(CollisionMesh(mesh), kAll);
    EXPECT_TRUE(found.complete);
    EXPECT_EQ(found.pairs, expected);
    EXPECT_EQ(expected.empty(), reach < 0.01);
  }
}

TEST(SelfIntersections, AreLookedForWhereTheVerticesAreNow) {
  CollisionMesh organ(test::blob(3));
  EXPECT_THAT(selfIntersections(organ, kAll).pairs, IsEmpty());
  const Points before = organ.mesh().positions();
  organ.refit({VertexId{0}}, {-before[0]});
  EXPECT_THAT(selfIntersections(organ, kAll).pairs, Not(IsEmpty()));
  organ.refit(before);
  EXPECT_THAT(selfIntersections(organ, kAll).pairs, IsEmpty());
}

TEST(SelfIntersections, AreTheFirstOnesWhereTheyAreTooMany) {
  std::mt19937 generator(59);
  const CollisionMesh organ(crumpled(generator, 0.2));
  const std::vector<TrianglePair> all = selfIntersections(organ, kAll).pairs;
  const SelfIntersections some = selfIntersections(organ, 10);
  EXPECT_FALSE(some.complete);
  EXPECT_EQ(some.pairs, std::vector<TrianglePair>(all.begin(), all.begin() + 10));
  EXPECT_TRUE(selfIntersections(organ, all.size()).complete);
}

/// Side by side along the diagonal of all their boxes.
TEST(SelfIntersections, AreNotLookedForWithoutEnd) {
  std::vector<Triangle> needles;
  for (int i = 0; i < 4000; ++i) {
    const Vector3d start(1e-9 * i, 0.0, 0.0);
    needles.push_back({start, start + Vector3d::Ones(), start + Vector3d(0.0, 0.0, 1e-3)});
  }
  const SelfIntersections found = selfIntersections(CollisionMesh(soupOf(needles)), kAll);
  EXPECT_FALSE(found.complete);
  EXPECT_THAT(found.pairs, IsEmpty());
  EXPECT_THAT(warning(found), HasSubstr("is not known"));
}

TEST(SelfIntersections, AreToldInASentence) {
  EXPECT_EQ(warning({{}, true}), "");
  const TrianglePair pair = {TriangleId{3}, TriangleId{7}};
  EXPECT_THAT(warning({{pair, pair}, true}), HasSubstr("triangles 3 and 7 cross or touch"));
  EXPECT_THAT(warning({{pair, pair}, true}), HasSubstr("such pairs: 2)"));
  EXPECT_THAT(warning({{pair, pair}, false}), HasSubstr("such pairs: 2 or more)"));
}

}  // namespace
}  // namespace organ_collision::core
