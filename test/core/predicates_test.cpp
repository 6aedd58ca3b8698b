#include "organ_collision/core/predicates.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "reference/exact.h"
#include "reference/hard_triangles.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSamples = 10000;  // of each kind
constexpr std::array<double, 6> kScales{0x1p-450, 0x1p-350, 0x1p-300, 1, 0x1p+300, 0x1p+450};

TEST(Orientation, IsPositiveWhereTheCornersRunAnticlockwise) {
  const Vector3d a{0, 0, 0};
  const Vector3d b{1, 0, 0};
  const Vector3d c{0, 1, 0};
  EXPECT_EQ(orientation(a, b, c, {0, 0, 1}), 1);
  EXPECT_EQ(orientation(a, b, c, {0, 0, -1}), -1);
  EXPECT_EQ(orientation(a, b, c, {5, 7, 0}), 0);
}

TEST(Orientation, IsPositiveForAnAnticlockwiseTriangleOfThePlane) {
  EXPECT_EQ(orientation(Vector2d{0, 0}, Vector2d{1, 0}, Vector2d{0, 1}), 1);
  EXPECT_EQ(orientation(Vector2d{0, 0}, Vector2d{0, 1}, Vector2d{1, 0}), -1);
  EXPECT_EQ(orientation(Vector2d{0, 0}, Vector2d{1, 1}, Vector2d{3, 3}), 0);
}

TEST(Orientation, SeesTheLastBitOfACoordinate) {
  const Vector3d a{0.1, 0.2, 0.1 + 0.2};
  const Vector3d b{12, 12, 24};
  const Vector3d c{-7, 24, 17};  // a, b, c and the plane x + y = z: all but a on it
  EXPECT_EQ(orientation(Vector3d::Zero(), b, c, {0.5, 0.25, 0.75}), 0);
  EXPECT_EQ(orientation(Vector3d::Zero(), b, c, {0.5, 0.25, std::nextafter(0.75, 1)}),
            orientation(Vector3d::Zero(), b, c, {0.5, 0.25, 1}));
  EXPECT_EQ(orientation(Vector3d::Zero(), b, c, {0.5, 0.25, std::nextafter(0.75, 0)}),
            orientation(Vector3d::Zero(), b, c, {0.5, 0.25, 0}));
  EXPECT_EQ(orientation(Vector3d::Zero(), b, c, a), exact::orientation(Vector3d::Zero(), b, c, a));
}

TEST(Orientation, SeesTheLastBitOfALineInThePlane) {
  // Kettner et al. (2008): plain doubles give all three signs here, in stripes
  const Vector2d b{12, 12};
  const Vector2d c{24, 24};
  const double ulp = 0x1p-53;
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j) {
      EXPECT_EQ(orientation(Vector2d{0.5 + i * ulp, 0.5 + j * ulp}, b, c), (j > i) - (j < i))
          << i << " " << j;
    }
  }
}

TEST(Orientation, IsExactForPointsNearAPlane) {
  for (const double scale : kScales) {
    for (const TriangleKind kind : kTriangleKinds) {
      SCOPED_TRACE(testing::Message() << name(kind) << " times " << scale);
      HardTriangles triangles(1);
      for (int i = 0; i < kSamples / 5; ++i) {
        const Sample sample = triangles.sample(kind);
        const Triangle t = scaled(sample.triangle, scale);
        const Vector3d d = scale * (i % 2 == 0 ? sample.query : triangles.pointOf(sample.triangle));
        const int sign = exact::orientation(t.a, t.b, t.c, d);
        ASSERT_EQ(orientation(t.a, t.b, t.c, d), sign);
        ASSERT_EQ(orientation(t.b, t.a, t.c, d), -sign);
        ASSERT_EQ(orientation(t.a, d, t.b, t.c), sign);
        ASSERT_EQ(orientation(d, t.a, t.b, t.c), -sign);
      }
    }
  }
}

TEST(Orientation, IsExactWhereEveryProductOfTailsCounts) {
  HardTriangles triangles(2);
  int on_plane = 0;
  for (int i = 0; i < kSamples; ++i) {
    // integer combinations of p and q, moved: on one plane but for the rounding of the sum
    const Vector3d p = triangles.inCube().cwiseProduct(Vector3d(1e-6, 1, 1e6));
    const Vector3d q = triangles.inCube().cwiseProduct(Vector3d(1, 1e-3, 1e3));
    const Vector3d a = 0.25 * (p + q);
    const Vector3d d =
        a + std::floor(triangles.uniform(-4, 5)) * p + std::floor(triangles.uniform(-4, 5)) * q;
    const int sign = exact::orientation(a, a + p, a + q, d);
    ASSERT_EQ(orientation(a, a + p, a + q, d), sign);
    on_plane += sign == 0 ? 1 : 0;
  }
  EXPECT_GT(on_plane, 0);
  EXPECT_LT(on_plane, kSamples / 2);
}

TEST(Collinear, HoldsForMultiplesOfOneVector) {
  const Vector3d v{3111, -4999, 7919};
  EXPECT_TRUE(collinear(v, 0x1p-40 * v, -12345 * v));
  EXPECT_FALSE(collinear(v, 0x1p-40 * v, -12345 * v + 0x1p-20 * Vector3d::UnitZ()));
}

TEST(Collinear, HoldsWherePointsCoincide) {
  const Vector3d p{0.1, 0.2, 0.3};
  const Vector3d q{0.7, -0.2, 1e-9};
  EXPECT_TRUE(collinear(p, p, p));
  EXPECT_TRUE(collinear(p, p, q));
  EXPECT_TRUE(collinear(p, q, p));
  EXPECT_TRUE(collinear(q, p, p));
}

TEST(Collinear, LooksAlongEachAxis) {
  EXPECT_FALSE(collinear({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  EXPECT_FALSE(collinear({0, 0, 0}, {0, 1, 0}, {0, 0, 1}));
  EXPECT_FALSE(collinear({0, 0, 0}, {0, 0, 1}, {1, 0, 0}));
}

TEST(Collinear, IsExactForCaps) {
  for (const double scale : kScales) {
    for (const TriangleKind kind : {TriangleKind::kCap, TriangleKind::kZeroArea,
                                    TriangleKind::kLattice, TriangleKind::kMixedScale}) {
      SCOPED_TRACE(testing::Message() << name(kind) << " times " << scale);
      HardTriangles triangles(3);
      for (int i = 0; i < kSamples / 5; ++i) {
        const Triangle t = scaled(triangles.triangle(kind), scale);
        ASSERT_EQ(collinear(t.a, t.b, t.c), exact::collinear(t.a, t.b, t.c));
      }
    }
  }
}

TEST(Collinear, DecidesAtTheSmallestAndLargestCoordinates) {
  const double smallest = std::numeric_limits<double>::denorm_min();
  const double largest = 0.99 * kLargestCoordinate;
  EXPECT_TRUE(collinear({0, 0, 0}, {smallest, smallest, 0}, {largest, largest, 0}));
  EXPECT_FALSE(collinear({0, 0, 0}, {smallest, 0, 0}, {0, smallest, 0}));
  EXPECT_FALSE(collinear({0, 0, 0}, {largest, 0, 0}, {0, largest, 0}));
}

}  // namespace
}  // namespace organ_collision::core
