#include "organ_collision/core/closest_point.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "organ_collision/core/box.h"
#include "organ_collision/core/predicates.h"
#include "reference/exact.h"
#include "reference/hard_triangles.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector3d;

// The promise of the header, in units of u * extent.
constexpr double kPromise = 4;
constexpr int kSamples = 10000;  // of each kind

const Triangle kRight{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

double extentOf(const Vector3d& query, const Triangle& t) {
  return std::max({(t.a - query).norm(), (t.b - query).norm(), (t.c - query).norm()});
}

exact::Real distanceOf(const ClosestPoint& closest) { return std::sqrt(closest.squared_distance); }

/// [u * extent]
double errorOf(const Vector3d& query, const Triangle& t) {
  const double extent = extentOf(query, t);
  if (extent == 0) return 0;
  const exact::Real error =
      distanceOf(closestPointOnTriangle(query, t)) - exact::distance(query, t);
  return static_cast<double>(abs(error) / (kUnit * extent));
}

/// Calls `check(query, triangle)` for samples of every kind.
template <typename Check>
void forEachSample(unsigned seed, int count, const Check& check) {
  for (const TriangleKind kind : kTriangleKinds) {
    SCOPED_TRACE(name(kind));
    HardTriangles triangles(seed);
    for (int i = 0; i < count && !testing::Test::HasFailure(); ++i) {
      const Sample sample = triangles.sample(kind);
      check(sample.query, sample.triangle);
    }
  }
}

bool sameBits(const ClosestPoint& left, const ClosestPoint& right) {
  return left.point == right.point && left.offset == right.offset &&
         left.barycentric == right.barycentric && left.feature == right.feature &&
         left.squared_distance == right.squared_distance;
}

TEST(ClosestPoint, IsBelowAQueryAboveTheFace) {
  const ClosestPoint closest = closestPointOnTriangle({0.25, 0.25, 2}, kRight);
  EXPECT_EQ(closest.point, Vector3d(0.25, 0.25, 0));
  EXPECT_EQ(closest.offset, Vector3d(0, 0, -2));
  EXPECT_EQ(closest.barycentric, Vector3d(0.5, 0.25, 0.25));
  EXPECT_EQ(closest.feature, Feature::kFace);
  EXPECT_EQ(closest.squared_distance, 4);
}

TEST(ClosestPoint, IsOnTheEdgeThatTheQueryIsBeyond) {
  const ClosestPoint below = closestPointOnTriangle({0.25, -3, 4}, kRight);
  EXPECT_EQ(below.point, Vector3d(0.25, 0, 0));
  EXPECT_EQ(below.barycentric, Vector3d(0.75, 0.25, 0));
  EXPECT_EQ(below.feature, Feature::kEdgeAB);
  EXPECT_EQ(below.squared_distance, 25);
  EXPECT_EQ(closestPointOnTriangle({2, 2, 0}, kRight).feature, Feature::kEdgeBC);
  EXPECT_EQ(closestPointOnTriangle({-1, 0.5, 0}, kRight).feature, Feature::kEdgeCA);
}

TEST(ClosestPoint, IsTheCornerThatTheQueryIsBeyond) {
  const ClosestPoint a = closestPointOnTriangle({-1, -2, 2}, kRight);
  EXPECT_EQ(a.point, kRight.a);
  EXPECT_EQ(a.barycentric, Vector3d(1, 0, 0));
  EXPECT_EQ(a.feature, Feature::kVertexA);
  EXPECT_EQ(a.squared_distance, 9);
  EXPECT_EQ(closestPointOnTriangle({3, 0, 0}, kRight).feature, Feature::kVertexB);
  EXPECT_EQ(closestPointOnTriangle({0, 3, 0}, kRight).feature, Feature::kVertexC);
}

TEST(ClosestPoint, TakesACollapsedTriangleForItsSegment) {
  // dimforge/parry#76: 0 was returned
  const Triangle collapsed{{2.27699995, -7.9000001, 16.3180008},
                           {-0.569999993, -8.10000038, 16.6070004},
                           {-0.569999993, -8.10000038, 16.6070004}};
  const Vector3d query{1.10000002, -7.9000001, 16.5879993};
  const ClosestPoint closest = closestPointOnTriangle(query, collapsed);
  EXPECT_NEAR(std::sqrt(closest.squared_distance), 0.171478265901441516,
              kPromise * kUnit * extentOf(query, collapsed));
  EXPECT_TRUE(closest.feature == Feature::kEdgeAB || closest.feature == Feature::kEdgeCA);
}

TEST(ClosestPoint, FindsTheSegmentBesideATriangleThatIsAPoint) {
  EXPECT_EQ(closestPointOnTriangle({1, 0, 0.5}, {{0, 0, 0}, {0, 0, 0}, {0, 0, 1}}).squared_distance,
            1);
  EXPECT_EQ(closestPointOnTriangle({1, 0, 0.5}, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}).squared_distance,
            1.25);
}

TEST(ClosestPoint, KeepsTheDistanceFromATriangleOfATenthOfAMillimetre) {
  // FCL 0.7 answers 0
  const Triangle small{{0, 0, 0}, {1.5e-4, 0, 0}, {0, 1.5e-4, 0}};
  const Vector3d query{5e-5, 5e-5, 1.5e-5};
  EXPECT_NEAR(std::sqrt(closestPointOnTriangle(query, small).squared_distance), 1.5e-5,
              kPromise * kUnit * extentOf(query, small));
}

TEST(ClosestPoint, IsOnTheNeedleThatRegionMethodsMiss) {
  const Vector3d query{0x1.3eaae8a04848p-7, 0x1.470bd32a5324cp-1, -0x1.3040feaed6472p+0};
  const Triangle needle{{0x1.c6edb78d4b263p-3, 0x1.9ac3608b45908p-1, -0x1.62cdd81ebeb04p+0},
                        {-0x1.ee5c5b80ea279p-1, -0x1.caba4fa4f949p-4, -0x1.209bfef03778fp-2},
                        {-0x1.ee5c5bb00ac8p-1, -0x1.caba50c0af9c6p-4, -0x1.209bfee2b88e5p-2}};
  EXPECT_NEAR(std::sqrt(closestPointOnTriangle(query, needle).squared_distance),
              6.53229269437997e-10, kPromise * kUnit * extentOf(query, needle));
}

TEST(ClosestPoint, IsCorrectedWhereTheQueryNearlyTouchesTheFace) {
  // found by a search for bad cases: 4.005 u * extent from uncorrected weights
  const Vector3d query{0x1.cc2cd18d29c1ap-4, -0x1.afad97a62326fp-3, 0x1.22433daabfd29p-2};
  const Triangle needle{{0x1.f3981b48f08adp-4, -0x1.b0637b851743ep-4, -0x1.c0658bfb77c2dp-3},
                        {0x1.a8f873af8e3f5p-4, -0x1.380fc57a96b05p-2, 0x1.76dc1e55374dap-1},
                        {0x1.a8f8729d4191bp-4, -0x1.380fc7c5130eep-2, 0x1.76dc1dbb63f0dp-1}};
  EXPECT_LE(errorOf(query, needle), kPromise);
}

TEST(ClosestPoint, KeepsWhatTheDifferenceOfQueryAndCornerLoses) {
  // found by climbing, where every rounding takes most: 4.48 u * extent without that,
  const Vector3d query{0x1.812cdec126311p-1, 0x1.c00700cbbbfa7p+0, 0x1.492d17911ea95p-7};
  const Triangle small{{0x1.81bf4c47c4c61p-1, 0x1.7ff233935caf8p-1, 0x1.4de4b07219e9ap-7},
                       {0x1.8553ae844259p-1, 0x1.8003a19fbf4e7p-1, -0x1.0a6cba9cbd3e2p-9},
                       {0x1.8695e422155f6p-1, 0x1.800212982969fp-1, -0x1.4fe99f93e958cp-11}};
  EXPECT_LE(errorOf(query, small), kPromise);
  // and 4.23 where candidates are compared without
  const Vector3d other{0x1.87a697205ad4p-1, 0x1.c66e38ac7ea5p+0, 0x1.5a9e8a4e50e5ap-5};
  const Triangle fair{{0x1.819893f5365d3p-1, 0x1.7ef14cd795da1p-1, -0x1.755f4ca77bb9p-7},
                      {0x1.7f9c7f58ee50bp-1, 0x1.7ec110a395fc1p-1, -0x1.5e5dbba89d5bp-10},
                      {0x1.8398eb4ab5857p-1, 0x1.7ea527e43f3c3p-1, 0x1.4d475863c907fp-11}};
  EXPECT_LE(errorOf(other, fair), kPromise);
}

TEST(ClosestPoint, IsCorrectedWhereTheQueryNearlyTouchesAnEdge) {
  // found by climbing, in u * extent from an uncorrected share of the edge:
  // 7.06, an edge alone
  EXPECT_LE(errorOf({0x1.5afe5e7d9b5b6p-17, -0x1.e3078761c10ebp+0, -0x1.7177bde286ecp-15},
                    {{0x1.cdfc2232caf0cp-17, 0x1.e3745f47ec443p-1, -0x1.b3fa45d9b88afp-13},
                     {0x1.d0012b8b1472ap-18, -0x1.2df2577f46448p+2, 0x1.f67cebc3c951ep-14},
                     {0x1.d0012b8b1472ap-18, -0x1.2df2577f46448p+2, 0x1.f67cebc3c951ep-14}}),
            kPromise);
  // 6.49
  EXPECT_LE(errorOf({-0x1.813c68bb39602p-27, -0x1.7e9194c81526ap-1, -0x1.62248a00684fbp-10},
                    {{-0x1.6a47e1c895793p-27, 0x1.35d11c236e175p-1, 0x1.1978621858c31p-9},
                     {0x1.2b878cb436613p+0, -0x1.8da3fdb371b1p+0, -0x1.3dd1086424aa6p-8},
                     {-0x1.2b6d76624a35ep+0, 0x1.e00df77d30ba4p-5, 0x1.19559618de11fp-9}}),
            kPromise);
  // and 4.80 where the edge is corrected, but not whether the face is left
  EXPECT_LE(errorOf({-0x1.084ce089a3e2dp+1, 0x1.94456e0a0fe23p+1, 0x1.b0d7f0f9c609p-91},
                    {{-0x1.c42670348919fp+2, -0x1.d77523eb5ce4p+0, 0x1.b0d7f0faed243p-91},
                     {-0x1.c4264d1211422p+2, 0x1.fde4879eef44dp+2, 0x1.b0d80df658f9ep-91},
                     {0x1.77b31f564dc65p+1, 0x1.05115b8294635p+3, 0x1.b0d7f0f9c609p-91}}),
            kPromise);
}

TEST(ClosestPoint, GivesNothingBackToLongSteps) {
  // found by climbing: 4.41 u * extent if long steps got what the difference loses, too
  const Vector3d query{0x1.60ef175ed2beap-2, -0x1.32b8b1c4d365bp-2, -0x1.00f7fb8e660bp-1};
  const Triangle touched{{0x1.bd8051d5fd208p-2, -0x1.95fc414dd192ap-1, -0x1.00fe0b0ef6196p-1},
                         {0x1.1p-2, 0x1.0e0fce7c2a8fdp-3, -0x1.00f2af09cda01p-1},
                         {0x1.20e66bffff8cfp-2, -0x1.7384d0eb3b45p-2, -0x1.afffffffdep-1}};
  EXPECT_LE(errorOf(query, touched), kPromise);
}

TEST(ClosestPoint, ReferenceKnowsHandMadeDistances) {
  EXPECT_EQ(exact::distance({0.25, 0.25, 2}, kRight), 2);
  EXPECT_EQ(exact::distance({0.25, -3, 4}, kRight), 5);
  EXPECT_EQ(exact::distance({-1, -2, 2}, kRight), 3);
  EXPECT_EQ(exact::distance({3e5, 4e5, 0}, scaled(kRight, 0)), 5e5);
}

TEST(ClosestPoint, DistanceIsWithinFourRoundingErrorsOfTheExtent) {
  forEachSample(1, kSamples, [](const Vector3d& query, const Triangle& t) {
    ASSERT_LE(errorOf(query, t), kPromise);
  });
}

TEST(ClosestPoint, DistanceIsAsGoodAtTheExtremesOfScale) {
  for (const double scale : {0x1p-450, 0x1p-300, 0x1p-60, 0x1p+60, 0x1p+300, 0x1p+450}) {
    SCOPED_TRACE(scale);
    forEachSample(2, kSamples / 20, [scale](const Vector3d& query, const Triangle& t) {
      ASSERT_LE(errorOf(scale * query, scaled(t, scale)), kPromise);
    });
  }
}

TEST(ClosestPoint, ScalingByAPowerOfTwoChangesNoOtherBit) {
  for (const int exponent : {-300, -101, -3, 1, 99, 300}) {
    const double scale = std::ldexp(1.0, exponent);
    forEachSample(3, kSamples / 5, [scale](const Vector3d& query, const Triangle& t) {
      ClosestPoint closest = closestPointOnTriangle(query, t);
      closest.point *= scale;
      closest.offset *= scale;
      closest.squared_distance *= scale * scale;
      ASSERT_TRUE(sameBits(closest, closestPointOnTriangle(scale * query, scaled(t, scale))));
    });
  }
}

TEST(ClosestPoint, IsTheSameForEveryOrderOfTheCorners) {
  forEachSample(4, kSamples, [](const Vector3d& query, const Triangle& t) {
    const ClosestPoint closest = closestPointOnTriangle(query, t);
    for (int order = 1; order < 6; ++order) {
      const ClosestPoint other = closestPointOnTriangle(query, reordered(t, order));
      ASSERT_EQ(other.offset, closest.offset);
      ASSERT_EQ(other.point, closest.point);
    }
  });
}

TEST(ClosestPoint, IsNeverNearerThanTheBox) {
  forEachSample(5, kSamples, [](const Vector3d& query, const Triangle& t) {
    ASSERT_LE(squaredDistance(boxOf(t), query), closestPointOnTriangle(query, t).squared_distance);
  });
}

TEST(ClosestPoint, IsNeverNearerThanTheBoxOfAThinTriangle) {
  HardTriangles triangles(6);
  // the face is nearer than its box by less than a rounding error
  for (int i = 0; i < kSamples; ++i) {
    Triangle t = triangles.triangle(TriangleKind::kRandom);
    for (Vector3d* corner : {&t.a, &t.b, &t.c}) corner->x() *= 1e-15;
    const Vector3d query = triangles.pointOf(t) + triangles.uniform(0, 4) * Vector3d::UnitX();
    ASSERT_LE(squaredDistance(boxOf(t), query), closestPointOnTriangle(query, t).squared_distance);
  }
}

TEST(ClosestPoint, DoesNotLeaveTheBoxByARoundingError) {
  HardTriangles triangles(12);
  for (int i = 0; i < kSamples; ++i) {  // the face ends at an edge in a side of its box
    const double side = triangles.uniform(0, 1);
    const Triangle t{triangles.inCube() - Vector3d::UnitX(), {side, 9, 0}, {side, -9, 0}};
    const Vector3d query{side, 0, triangles.magnitude(-17, -14)};
    ASSERT_TRUE(boxOf(t).contains(closestPointOnTriangle(query, t).point));
  }
}

TEST(ClosestPoint, LiesInTheTriangle) {
  forEachSample(7, kSamples, [](const Vector3d& query, const Triangle& t) {
    const ClosestPoint closest = closestPointOnTriangle(query, t);
    const Vector3d& w = closest.barycentric;
    const double coordinate = largestCoordinate(t);
    ASSERT_TRUE(boxOf(t).contains(closest.point));
    ASSERT_LE((w.x() * t.a + w.y() * t.b + w.z() * t.c - closest.point).norm(),
              2 * kPromise * kUnit * coordinate);
    ASSERT_LE((closest.point - query - closest.offset).norm(),
              2 * kPromise * kUnit * (extentOf(query, t) + coordinate + query.norm()));
  });
}

/// Needles, caps, and queries that all but touch them.
TEST(ClosestPoint, IsWhereTheOffsetLeads) {
  HardTriangles triangles(17);
  for (int i = 0; i < kSamples; ++i) {
    const Vector3d a = triangles.inCube();
    const Vector3d b = triangles.inCube();
    const Vector3d base = a + (i % 2 == 0 ? triangles.uniform(0, 1) : 0.0) * (b - a);
    const Triangle t = {a, b, base + triangles.magnitude(-15, 0) * triangles.inCube()};
    const Vector3d above = triangles.magnitude(-18, 0) * (b - a).cross(t.c - a).stableNormalized();
    const Vector3d query =
        a + triangles.uniform(0, 0.5) * (b - a) + triangles.uniform(0, 0.5) * (t.c - a) + above;
    const ClosestPoint closest = closestPointOnTriangle(query, t);
    ASSERT_LE((closest.point - query - closest.offset).norm(),
              8 * kPromise * kUnit * extentOf(query, t));
  }
}

TEST(ClosestPoint, FeatureNamesTheCornersThatHaveWeight) {
  forEachSample(8, kSamples, [](const Vector3d& query, const Triangle& t) {
    const ClosestPoint closest = closestPointOnTriangle(query, t);
    const Vector3d& w = closest.barycentric;
    ASSERT_TRUE((w.array() >= 0).all() && (w.array() <= 1).all());
    ASSERT_NEAR(w.sum(), 1, 2 * kUnit);
    const std::string with_weight =
        std::string(w.x() > 0 ? "a" : "") + (w.y() > 0 ? "b" : "") + (w.z() > 0 ? "c" : "");
    constexpr std::array<const char*, 7> kNamed{"a", "b", "c", "ab", "bc", "ac", "abc"};
    ASSERT_EQ(with_weight, kNamed[static_cast<std::size_t>(closest.feature)]);
    if (with_weight.size() == 1) {
      ASSERT_EQ(closest.point, w.x() == 1 ? t.a : (w.y() == 1 ? t.b : t.c));
    }
    ASSERT_EQ(closest.squared_distance, squaredLength(closest.offset));
  });
}

TEST(ClosestPoint, HasNoFaceWithoutAnArea) {
  HardTriangles triangles(9);
  for (int i = 0; i < kSamples; ++i) {
    // exact multiples of one vector: collinear, though their rounded differences are not parallel
    const auto multiple = [&triangles] {
      const double factor = std::floor(triangles.uniform(-1e6, 1e6));
      return Vector3d(std::ldexp(factor, static_cast<int>(triangles.uniform(-60, 0))) *
                      Vector3d(3111, -4999, 7919));
    };
    const Triangle flat{multiple(), multiple(), multiple()};
    ASSERT_TRUE(exact::collinear(flat.a, flat.b, flat.c));
    const double size = (flat.b - flat.a).norm();
    const Vector3d query =
        triangles.pointOf(flat) + size * triangles.magnitude(-18, 0) * triangles.inCube();
    ASSERT_NE(closestPointOnTriangle(query, flat).feature, Feature::kFace);
    ASSERT_LE(errorOf(query, flat), kPromise);
  }
}

/// Moves the query as far as it may, towards where the other corners come near.
void expectRoom(const Vector3d& query, const Vector3d& corner, const Vector3d& edge,
                const Vector3d& other_edge) {
  const double room = roomAtClosestCorner(corner - query, edge, other_edge);
  for (const Vector3d& towards : {edge, other_edge}) {
    const Vector3d moved = query + room * towards.stableNormalized();
    if ((moved - query).norm() > room) continue;
    ASSERT_TRUE(isClosestCorner(corner - moved, edge, other_edge));
  }
}

TEST(ClosestPoint, IsTheCornerFromWhichBothEdgesLeadAway) {
  int found = 0;
  const auto check = [&found](const Vector3d& query, const Triangle& t) {
    const std::array<Vector3d, 3> corners = cornersOf(t);
    for (const std::size_t i : {0, 1, 2}) {
      const Vector3d offset = corners[i] - query;
      const Vector3d edge = corners[(i + 1) % 3] - corners[i];
      const Vector3d other_edge = corners[(i + 2) % 3] - corners[i];
      if (!isClosestCorner(offset, edge, other_edge)) continue;
      ++found;
      const ClosestPoint closest = closestPointOnTriangle(query, t);
      ASSERT_EQ(closest.point, corners[i]);
      ASSERT_EQ(closest.squared_distance, squaredLength(offset));
      ASSERT_NO_FATAL_FAILURE(expectRoom(query, corners[i], edge, other_edge));
    }
  };
  forEachSample(12, kSamples, check);
  // From so far that rounding makes all corners, or the wrong one, the nearest.
  forEachSample(13, kSamples, [&](const Vector3d& query, const Triangle& t) {
    for (const double factor : {0x1p20, 0x1p26, 0x1p40, 0x1p60})
      ASSERT_NO_FATAL_FAILURE(check(factor * query, t));
  });
  EXPECT_GT(found, kSamples);
}

TEST(ClosestPoint, StaysTheCornerWhileTheQueryMovesLessThanTheEdgesLeadAway) {
  // The second edge leads away by a third of the offset, the first by all of it.
  const Vector3d offset(0, 0, -3);
  const Vector3d edge(0, 0, -1), other_edge(std::sqrt(8.0), 0, -1);
  EXPECT_NEAR(roomAtClosestCorner(offset, edge, other_edge), 1.0, 1e-12);
}

/// Whether isClosestOnEdge() says so; then any triangle with that edge and corner gives the same.
bool isTiedAtEdge(const Vector3d& query, const ClosestPoint& closest, const Triangle& t) {
  if (!isClosestOnEdge(query, closest, t.a, t.b, t.c)) return false;
  const Vector3d& w = closest.barycentric;
  const auto expect = [&](const Triangle& tied, const Vector3d& weights, Feature feature) {
    EXPECT_TRUE(
        sameBits(closestPointOnTriangle(query, tied),
                 {closest.point, closest.offset, weights, feature, closest.squared_distance}));
  };
  expect(t, w, Feature::kEdgeAB);
  expect({t.c, t.a, t.b}, {w.z(), w.x(), w.y()}, Feature::kEdgeBC);
  expect({t.b, t.c, t.a}, {w.y(), w.z(), w.x()}, Feature::kEdgeCA);
  expect({t.b, t.a, t.c}, {w.y(), w.x(), w.z()}, Feature::kEdgeAB);
  return true;
}

TEST(ClosestPoint, IsTheSameOnAnEdgeFromWhichTheThirdCornerLeadsAway) {
  HardTriangles triangles(14);
  int found = 0;
  for (int i = 0; i < 10 * kSamples && !HasFailure(); ++i) {
    // Up to so far from the origin that coordinates, and the point, are rounded to an eighth.
    const Vector3d start =
        (triangles.oneIn(2) ? 1.0 : triangles.magnitude(0, 15)) * triangles.inCube();
    Vector3d edge = triangles.inCube();
    if (triangles.oneIn(2)) edge.x() = triangles.magnitude(-17, -12);
    const Vector3d end = start + edge;
    // Above the edge, perhaps hardly beside a corner; near or far away.
    const double from_start =
        triangles.oneIn(2) ? triangles.uniform(0, 1) : triangles.magnitude(-12, 0);
    const Vector3d foot = start + (triangles.oneIn(2) ? from_start : 1 - from_start) * edge;
    const Vector3d up = edge.cross(triangles.inCube());
    const Vector3d query = foot + triangles.magnitude(-4, 4) * up;
    const ClosestPoint closest = closestPointOnTriangle(query, {start, end, foot - up});
    if (closest.feature != Feature::kEdgeAB) continue;
    // The corner near or far away; sideways, a little or much away, or towards the query.
    for (const double away :
         {0.0, 1.0, triangles.magnitude(-12, 2), -triangles.magnitude(-12, 2)}) {
      const Vector3d sideways = triangles.uniform(-1, 1) * edge + up.cross(edge);
      const Vector3d corner = foot + triangles.magnitude(-6, 6) * (sideways - away * up);
      if (isTiedAtEdge(query, closest, {start, end, corner})) ++found;
    }
  }
  EXPECT_GT(found, kSamples);
}

TEST(ClosestPoint, IsFiniteForTheLargestCoordinates) {
  HardTriangles triangles(10);
  for (int i = 0; i < kSamples; ++i) {
    const auto huge = [&triangles] {
      return Vector3d(
          triangles.inCube().cwiseProduct(0.999 * kLargestCoordinate * Vector3d::Ones()));
    };
    const auto tiny = [&triangles] {
      return Vector3d(triangles.magnitude(-320, 0) * triangles.inCube());
    };
    const auto any = [&] { return triangles.oneIn(2) ? huge() : tiny(); };
    const Triangle t{any(), any(), any()};
    const ClosestPoint closest = closestPointOnTriangle(any(), t);
    ASSERT_TRUE(closest.point.allFinite() && closest.offset.allFinite() &&
                closest.barycentric.allFinite());
    ASSERT_TRUE(std::isfinite(closest.squared_distance));
  }
}

TEST(ClosestPoint, KeepsThePromiseForTheLargestCoordinates) {
  HardTriangles triangles(11);
  for (int i = 0; i < kSamples / 10; ++i) {
    const double scale = 0.99 * kLargestCoordinate;
    const Triangle t = scaled(triangles.triangle(TriangleKind::kRandom), scale);
    ASSERT_LE(errorOf(scale * triangles.inCube(), t), kPromise);
  }
}

}  // namespace
}  // namespace organ_collision::core
