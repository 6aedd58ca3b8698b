#include "organ_collision/core/triangle_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "organ_collision/core/box.h"
#include "organ_collision/core/triangle_intersection.h"
#include "reference/exact.h"
#include "reference/hard_triangles.h"
#include "reference/triangle_pairs.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector3d;

// The promise of the header, in units of u * extent.
constexpr double kPromise = 4;
constexpr int kSamples = 3000;  // of each kind

const Triangle kRight{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};

double extentOf(const Triangle& first, const Triangle& second) {
  double extent = 0;
  for (const Vector3d& p : {first.a, first.b, first.c, second.a, second.b, second.c}) {
    for (const Vector3d& q : {first.a, first.b, first.c, second.a, second.b, second.c}) {
      extent = std::max(extent, (p - q).norm());
    }
  }
  return extent;
}

/// [u * extent]
double errorOf(const Triangle& first, const Triangle& second) {
  const double extent = extentOf(first, second);
  if (extent == 0) return 0;
  const exact::Real distance = std::sqrt(closestPoints(first, second).on_second.squared_distance);
  return static_cast<double>(abs(distance - exact::distance(first, second)) / (kUnit * extent));
}

/// Calls `check(first, second)` for pairs of every kind.
template <typename Check>
void forEachPair(unsigned seed, int count, const Check& check) {
  for (const TriangleKind kind : kTriangleKinds) {
    SCOPED_TRACE(name(kind));
    HardTriangles triangles(seed);
    for (int i = 0; i < count && !testing::Test::HasFailure(); ++i) {
      const auto [first, second] = anyPair(triangles, kind);
      check(first, second);
    }
  }
}

TEST(ClosestPoints, OfACornerAboveAFace) {
  const ClosestPair pair = closestPoints({{1, 1, 2}, {1, 1, 5}, {2, 1, 5}}, kRight);
  EXPECT_EQ(pair.point_on_first, Vector3d(1, 1, 2));
  EXPECT_EQ(pair.on_second.point, Vector3d(1, 1, 0));
  EXPECT_EQ(pair.on_second.offset, Vector3d(0, 0, -2));
  EXPECT_EQ(pair.on_second.barycentric, Vector3d(0.5, 0.25, 0.25));
  EXPECT_EQ(pair.on_second.feature, Feature::kFace);
  EXPECT_EQ(pair.on_second.squared_distance, 4);
}

TEST(ClosestPoints, OfAFaceBelowACorner) {
  const ClosestPair pair = closestPoints(kRight, {{1, 1, 5}, {2, 1, 5}, {1, 1, 2}});
  EXPECT_EQ(pair.point_on_first, Vector3d(1, 1, 0));
  EXPECT_EQ(pair.on_second.point, Vector3d(1, 1, 2));
  EXPECT_EQ(pair.on_second.offset, Vector3d(0, 0, 2));
  EXPECT_EQ(pair.on_second.barycentric, Vector3d(0, 0, 1));
  EXPECT_EQ(pair.on_second.feature, Feature::kVertexC);
  EXPECT_EQ(pair.on_second.squared_distance, 4);
}

TEST(ClosestPoints, OfTwoEdgesThatPass) {
  const ClosestPair pair = closestPoints(kRight, {{1, -3, -1}, {1, -3, 3}, {1, -9, 0}});
  EXPECT_EQ(pair.point_on_first, Vector3d(1, 0, 0));
  EXPECT_EQ(pair.on_second.point, Vector3d(1, -3, 0));
  EXPECT_EQ(pair.on_second.offset, Vector3d(0, -3, 0));
  EXPECT_EQ(pair.on_second.barycentric, Vector3d(0.75, 0.25, 0));
  EXPECT_EQ(pair.on_second.feature, Feature::kEdgeAB);
  EXPECT_EQ(pair.on_second.squared_distance, 9);
}

TEST(ClosestPoints, OfTrianglesThatPierceAreOnePoint) {
  const ClosestPair pair = closestPoints(kRight, {{1, 1, -1}, {1, 1, 1}, {9, 9, 1}});
  EXPECT_EQ(pair.on_second.squared_distance, 0);
  EXPECT_EQ(pair.on_second.offset, Vector3d::Zero());
  EXPECT_EQ(pair.on_second.point, pair.point_on_first);
  EXPECT_EQ(pair.point_on_first.z(), 0);
}

TEST(ClosestPoints, OfPublishedHardCasesAreRightInEveryOrder) {
  for (const HardPair& pair : kHardPairs) {
    SCOPED_TRACE(pair.source);
    const double tolerance =
        pair.distance == 0 ? 0 : kPromise * kUnit * extentOf(pair.first, pair.second);
    forEachOrder(pair.first, pair.second, [&](const Triangle& one, const Triangle& other) {
      EXPECT_NEAR(std::sqrt(closestPoints(one, other).on_second.squared_distance), pair.distance,
                  tolerance);
    });
  }
}

TEST(ClosestPoints, ReferenceKnowsHandMadeDistances) {
  EXPECT_EQ(exact::distance(Triangle{{1, 1, 2}, {1, 1, 5}, {2, 1, 5}}, kRight), 2);
  EXPECT_EQ(exact::distance(kRight, {{1, -3, -1}, {1, -3, 3}, {1, -9, 0}}), 3);
  EXPECT_EQ(exact::distance(kRight, {{1, 1, -1}, {1, 1, 1}, {9, 9, 1}}), 0);
  EXPECT_EQ(exact::distance(kRight, {{7, 0, 4}, {8, 0, 4}, {8, 0, 5}}), 5);
}

TEST(ClosestPoints, DistanceIsWithinFourRoundingErrorsOfTheExtent) {
  forEachPair(1, kSamples, [](const Triangle& first, const Triangle& second) {
    ASSERT_LE(errorOf(first, second), kPromise);
  });
}

TEST(ClosestPoints, TakesATriangleWithTwoEqualCornersForTheSegmentThatItIs) {
  forEachPair(29, kSamples, [](const Triangle& first, const Triangle& second) {
    const Triangle segment{first.a, first.b, first.b};
    EXPECT_LE(errorOf(segment, second), kPromise);
    EXPECT_LE(errorOf(segment, {second.a, second.c, second.c}), kPromise);
    EXPECT_LE(errorOf({first.a, first.a, first.a}, {second.a, second.c, second.c}), kPromise);
  });
}

TEST(ClosestPoints, OfEdgesThatPassNearlySideBySideAreAsGood) {
  // Found by climbing.
  const Triangle segment = {{0x1.492633af4a38p-3, -0x1.d589446c0ae5dp-2, -0x1.671880defdadfp-6},
                            {-0x1.fa83c9aef37cap-4, 0x1.6946803a7b601p-2, 0x1.144c942db382p-6},
                            {-0x1.fa83c9aef37cap-4, 0x1.6946803a7b601p-2, 0x1.144c942db382p-6}};
  const Triangle beside = {{0x1.0dcf58028a82ap-3, -0x1.80d5563e51cd6p-2, -0x1.2586032730aadp-6},
                           {-0x1.997b06ed5d229p-4, 0x1.241e982f28782p-2, 0x1.c067706642debp-7},
                           {0x1.8282b616f5965p-3, 0x1.ec99b347c86e2p-2, -0x1.a004219bc6a0bp-4}};
  const Triangle first = {{0x1.43338a7690bap-3, 0x1.bcbb72555f7a2p+0, 0x1.e8135b2de3b76p-1},
                          {0x1.e2d0f8eff0e1dp-2, 0x1.a9a33de0fe3a3p-1, 0x1.de00b07bdcf1cp-1},
                          {0x1.0981713f413a9p-1, 0x1.6259f1f68103ap-1, 0x1.d9c60bdd57371p-1}};
  const Triangle second = {{0x1.03a3e2ca76b4cp-4, 0x1.352c9fc6ce382p+0, 0x1.8904fde387492p-1},
                           {0x1.96837ebcb55acp-3, 0x1.a1f1f4c54aeap-1, 0x1.83a9ce6c8b28dp-1},
                           {0x1.252e9467b3433p-1, 0x1.28d7f8727618bp-1, 0x1.4d3e113fa9487p-2}};
  const auto is_good = [](const Triangle& one, const Triangle& other) {
    EXPECT_LE(errorOf(one, other), kPromise);
  };
  forEachOrder(segment, beside, is_good);
  forEachOrder(first, second, is_good);
}

TEST(ClosestPoints, KeepWhatTheDifferenceOfStartsLoses) {
  // found by climbing: without that 4.28 u * extent,
  const Triangle first{{0x1.7f30e3c9c763ap-1, 0x1.7ff0181983185p-1, -0x1.8dd1d4086c57p-14},
                       {0x1.43cb46e644d17p-1, 0x1.7fed8347c0552p-1, 0x1.ab4e35241b674p-5},
                       {0x1.70ca4f508943fp-1, 0x1.7a2fa0aa4e612p-1, 0x1.24d83748d0e02p-3}};
  const Triangle second{{0x1.85d9d2a21a86ep-1, 0x1.c00670c14adc2p+0, 0x1.3812368474568p-4},
                        {0x1.7ffff29f1fba1p-1, 0x1.bffff4a1aa925p+0, -0x1.73f0eff802696p-24},
                        {0x1.6fb61f9a31729p-1, 0x1.bfb66c4f0ce57p+0, 0x1.c5ec4f7af3798p-3}};
  EXPECT_LE(errorOf(first, second), kPromise);
  // and 4.37 between segments
  const Vector3d end{0x1.812bf4e5a13c6p-1, 0x1.8019b5f77443dp-1, 0x1.90f0a6ceae924p-7};
  const Vector3d other_end{0x1.780309095de68p-1, 0x1.c01035420e3fp+0, 0x1.85ad8adb3fd37p-8};
  const Vector3d start{0x1.82c6bbbb8d3d4p-1, 0x1.801ecccb7bf66p-1, 0x1.ef4435a11ead5p-10};
  const Vector3d other_start{0x1.78e0c80f92791p-1, 0x1.c013534e73acbp+0, 0x1.b4278e09f7407p-7};
  EXPECT_LE(errorOf({start, end, end}, {other_start, other_end, other_end}), kPromise);
  // and 4.09 between longer ones
  const Vector3d far_end{-0x1.fd982ce6eecb9p-5, -0x1.9204c936fdb9ap+5, 0x1.dda446076192p+9};
  const Vector3d other_far_end{0x1.065b4a6bb8724p+15, 0x1.536232fedf44bp+13, -0x1.37105b2b53cd5p+9};
  EXPECT_LE(
      errorOf(
          {{-0x1.72b6cf0e00002p-7, -0x1.d51ccbb5e2a38p+5, -0x1.370eec0c8e774p+9}, far_end, far_end},
          {{0x1.058edd800f036p+15, -0x1.753eef5de0eeep+13, 0x1.0083887979dc4p+11},
           other_far_end,
           other_far_end}),
      kPromise);
}

TEST(ClosestPoints, DistanceIsAsGoodAtTheExtremesOfScale) {
  for (const double scale : {0x1p-450, 0x1p-300, 0x1p-60, 0x1p+60, 0x1p+300, 0x1p+450}) {
    SCOPED_TRACE(scale);
    forEachPair(2, kSamples / 20, [scale](const Triangle& first, const Triangle& second) {
      ASSERT_LE(errorOf(scaled(first, scale), scaled(second, scale)), kPromise);
    });
  }
}

TEST(ClosestPoints, DistanceIsZeroWhereTheTrianglesIntersect) {
  forEachPair(3, kSamples, [](const Triangle& first, const Triangle& second) {
    if (!trianglesIntersect(first, second)) return;
    const ClosestPair pair = closestPoints(first, second);
    ASSERT_EQ(pair.on_second.squared_distance, 0);
    ASSERT_EQ(pair.on_second.offset, Vector3d::Zero());
    ASSERT_EQ(pair.on_second.point, pair.point_on_first);
  });
}

TEST(ClosestPoints, CommonPointLiesInBothTriangles) {
  for (const double scale : {1.0, 0x1p-300, 0x1p+300, 0x1p+480}) {
    forEachPair(4, kSamples / 5, [scale](const Triangle& one, const Triangle& other) {
      if (!trianglesIntersect(one, other)) return;
      const Triangle first = scaled(one, scale);
      const Triangle second = scaled(other, scale);
      const Vector3d point = closestPoints(first, second).point_on_first;
      const double coordinate = std::max(largestCoordinate(first), largestCoordinate(second));
      const double tolerance = kPromise * kUnit * (extentOf(first, second) + coordinate);
      ASSERT_LE(exact::distance(point, first), tolerance);
      ASSERT_LE(exact::distance(point, second), tolerance);
    });
  }
}

TEST(ClosestPoints, LieInTheTriangles) {
  forEachPair(5, kSamples, [](const Triangle& first, const Triangle& second) {
    const ClosestPair pair = closestPoints(first, second);
    const Vector3d& w = pair.on_second.barycentric;
    const double coordinate = std::max(largestCoordinate(first), largestCoordinate(second));
    const double tolerance = kPromise * kUnit * (extentOf(first, second) + coordinate);
    ASSERT_LE(exact::distance(pair.point_on_first, first), tolerance);
    ASSERT_LE(exact::distance(pair.on_second.point, second), tolerance);
    ASSERT_LE(
        (w.x() * second.a + w.y() * second.b + w.z() * second.c - pair.on_second.point).norm(),
        2 * tolerance);
    ASSERT_LE((pair.on_second.point - pair.point_on_first - pair.on_second.offset).norm(),
              2 * tolerance);
    ASSERT_EQ(pair.on_second.squared_distance, squaredLength(pair.on_second.offset));
  });
}

TEST(ClosestPoints, AreNeverNearerThanTheBoxes) {
  forEachPair(6, kSamples, [](const Triangle& first, const Triangle& second) {
    const double distance = closestPoints(first, second).on_second.squared_distance;
    ASSERT_LE(squaredDistance(boxOf(first), boxOf(second)), distance);
  });
}

TEST(ClosestPoints, AreNeverNearerThanTheBoxesOfThinTriangles) {
  HardTriangles triangles(7);
  // they are nearer than their boxes by less than a rounding error
  for (int i = 0; i < kSamples; ++i) {
    Triangle first = triangles.triangle(TriangleKind::kRandom);
    Triangle second = triangles.triangle(TriangleKind::kRandom);
    for (Vector3d* corner : {&first.a, &first.b, &first.c}) corner->x() *= 1e-15;
    const double gap = triangles.uniform(0, 4);
    for (Vector3d* corner : {&second.a, &second.b, &second.c})
      corner->x() = gap + 1e-15 * corner->x();
    ASSERT_LE(squaredDistance(boxOf(first), boxOf(second)),
              closestPoints(first, second).on_second.squared_distance);
  }
}

TEST(ClosestPoints, OffsetIsWithinTheBoxesWhereCoordinatesAreLostInAnotherUnit) {
  HardTriangles triangles(10);
  const Vector3d scale(0x1p-640, 0x1p490, 0x1p490);
  for (int i = 0; i < kSamples; ++i) {
    Triangle first = triangles.triangle(TriangleKind::kRandom);
    Triangle second = triangles.triangle(TriangleKind::kRandom);
    for (Vector3d* corner : {&first.a, &first.b, &first.c}) *corner = corner->cwiseProduct(scale);
    for (Vector3d* corner : {&second.a, &second.b, &second.c})
      *corner = (*corner + Vector3d(4, 0, 4)).cwiseProduct(scale);
    const Vector3d offset = closestPoints(first, second).on_second.offset;
    const Vector3d low = boxOf(second).low - boxOf(first).high;
    const Vector3d high = boxOf(second).high - boxOf(first).low;
    ASSERT_EQ(offset, offset.cwiseMax(low).cwiseMin(high));
  }
}

TEST(ClosestPoints, ScalingByAPowerOfTwoChangesNoOtherBit) {
  for (const int exponent : {-300, -101, 1, 300}) {
    const double scale = std::ldexp(1.0, exponent);
    forEachPair(8, kSamples / 5, [scale](const Triangle& first, const Triangle& second) {
      const ClosestPair pair = closestPoints(first, second);
      const ClosestPair other = closestPoints(scaled(first, scale), scaled(second, scale));
      ASSERT_EQ(other.point_on_first, scale * pair.point_on_first);
      ASSERT_EQ(other.on_second.point, scale * pair.on_second.point);
      ASSERT_EQ(other.on_second.offset, scale * pair.on_second.offset);
      ASSERT_EQ(other.on_second.squared_distance, scale * scale * pair.on_second.squared_distance);
      ASSERT_EQ(other.on_second.barycentric, pair.on_second.barycentric);
      ASSERT_EQ(other.on_second.feature, pair.on_second.feature);
    });
  }
}

TEST(ClosestPoints, AreFiniteForTheLargestCoordinates) {
  HardTriangles triangles(9);
  for (int i = 0; i < kSamples; ++i) {
    const auto any = [&triangles] {
      const double size =
          triangles.oneIn(2) ? 0.999 * kLargestCoordinate : triangles.magnitude(-320, 0);
      return Vector3d(size * triangles.inCube());
    };
    const ClosestPair pair = closestPoints({any(), any(), any()}, {any(), any(), any()});
    ASSERT_TRUE(pair.point_on_first.allFinite() && pair.on_second.point.allFinite());
    ASSERT_TRUE(pair.on_second.offset.allFinite() && pair.on_second.barycentric.allFinite());
    ASSERT_TRUE(std::isfinite(pair.on_second.squared_distance));
  }
}

}  // namespace
}  // namespace organ_collision::core
