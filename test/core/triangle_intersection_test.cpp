#include "organ_collision/core/triangle_intersection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reference/exact.h"
#include "reference/hard_triangles.h"
#include "reference/triangle_pairs.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector3d;

constexpr int kSamples = 10000;  // of each pair of shapes

const Triangle kRight{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};

void expectInEveryOrder(const Triangle& first, const Triangle& second, bool intersect) {
  EXPECT_EQ(exact::intersect(first, second), intersect) << "the reference";
  forEachOrder(first, second, [intersect](const Triangle& one, const Triangle& other) {
    EXPECT_EQ(trianglesIntersect(one, other), intersect);
  });
}

TEST(TrianglesIntersect, DecidesPublishedHardCasesInEveryOrder) {
  for (const HardPair& pair : kHardPairs) {
    SCOPED_TRACE(pair.source);
    expectInEveryOrder(pair.first, pair.second, pair.distance == 0);
  }
}

TEST(TrianglesIntersect, WhereAnEdgePiercesTheFace) {
  expectInEveryOrder(kRight, {{1, 1, -1}, {1, 1, 1}, {9, 9, 1}}, true);
  expectInEveryOrder(kRight, {{3, 3, -1}, {3, 3, 1}, {9, 9, 1}}, false);
}

TEST(TrianglesIntersect, WhereACornerTouches) {
  expectInEveryOrder(kRight, {{1, 1, 0}, {1, 1, 1}, {2, 1, 1}}, true);           // the face
  expectInEveryOrder(kRight, {{2, 2, 0}, {2, 2, 1}, {3, 2, 1}}, true);           // an edge
  expectInEveryOrder(kRight, {{4, 0, 0}, {4, 0, 1}, {5, 0, 1}}, true);           // a corner
  expectInEveryOrder(kRight, {{1, 1, 0x1p-1000}, {1, 1, 1}, {2, 1, 1}}, false);  // above the face
  expectInEveryOrder(kRight, {{2, std::nextafter(2, 3), 0}, {2, 2, 1}, {3, 2, 1}},
                     false);  // beside the edge
  expectInEveryOrder(kRight, {{std::nextafter(4, 5), 0, 0}, {4, 0, 1}, {5, 0, 1}},
                     false);  // beside the corner
}

TEST(TrianglesIntersect, WhereTheyShareAnEdge) {
  expectInEveryOrder(kRight, {{0, 0, 0}, {4, 0, 0}, {0, 0, 9}}, true);
}

TEST(TrianglesIntersect, WhereEdgesCross) {
  expectInEveryOrder(kRight, {{1, -1, -1}, {1, 1, 1}, {1, -1, 9}}, true);
  expectInEveryOrder(kRight, {{1, -1, -1}, {1, 1, std::nextafter(1, 2)}, {1, -1, 9}}, false);
}

TEST(TrianglesIntersect, InOnePlane) {
  expectInEveryOrder(kRight, {{1, 1, 0}, {1.5, 1, 0}, {1, 1.5, 0}}, true);  // one within the other
  expectInEveryOrder(kRight, {{-1, 1, 0}, {9, 1, 0}, {-1, 1.5, 0}}, true);  // edges cross
  expectInEveryOrder(kRight, {{-1, -1, 0}, {5, -1, 0}, {2, 0, 0}}, true);   // a corner on an edge
  expectInEveryOrder(kRight, {{3, 0, 0}, {9, 0, 0}, {9, -1, 0}}, true);     // edges overlap
  expectInEveryOrder(kRight, {{3, 3, 0}, {9, 3, 0}, {3, 9, 0}}, false);
  expectInEveryOrder(kRight, {{2, std::nextafter(2, 3), 0}, {9, 3, 0}, {3, 9, 0}}, false);
}

TEST(TrianglesIntersect, NotInParallelPlanes) {
  expectInEveryOrder(kRight, {{0, 0, 1}, {4, 0, 1}, {0, 4, 1}}, false);
}

TEST(TrianglesIntersect, WhereASegmentMeetsAFace) {
  const auto segment = [](const Vector3d& p, const Vector3d& q) { return Triangle{p, q, p}; };
  expectInEveryOrder(kRight, segment({1, 1, -1}, {1, 1, 1}), true);
  expectInEveryOrder(kRight, segment({1, 1, 0}, {1, 1, 1}), true);
  expectInEveryOrder(kRight, segment({-1, 0, 0}, {9, 0, 0}),
                     true);  // along an edge and past both corners
  expectInEveryOrder(kRight, segment({-1, 5, 0}, {5, -1, 0}), true);  // along another
  expectInEveryOrder(kRight, segment({3, 5, 0}, {5, -1, 0}), false);
  expectInEveryOrder(kRight, segment({3, -1, 0}, {5, 1, 0}), true);  // through a corner
  expectInEveryOrder(kRight, segment({3, 3, -1}, {3, 3, 1}), false);
}

TEST(TrianglesIntersect, WhereTrianglesAreSegmentsOrPoints) {
  const Vector3d p{1, 2, 3};
  const Vector3d q{3, 6, 9};
  const Triangle segment{p, q, 0.5 * (p + q)};
  const auto point = [](const Vector3d& x) { return Triangle{x, x, x}; };
  expectInEveryOrder(segment, {q, 2 * q, q}, true);
  expectInEveryOrder(segment, {2 * q, 1.5 * q, 2 * q}, false);           // on its line
  expectInEveryOrder(segment, {{2, 4, 5}, {2, 4, 7}, {2, 4, 7}}, true);  // crossing
  expectInEveryOrder(segment, {{2, 4.5, 5}, {2, 4.5, 7}, {2, 4.5, 7}}, false);
  expectInEveryOrder(segment, point(1.5 * p), true);
  expectInEveryOrder(segment, point(Vector3d(1.5, 3, 4.25)), false);
  expectInEveryOrder(point(p), point(p), true);
  expectInEveryOrder(point(p), point(q), false);
  expectInEveryOrder(kRight, point({2, 2, 0}), true);
  expectInEveryOrder(kRight, point({1, 1, 0}), true);
  expectInEveryOrder(kRight, point({1, 1, 1}), false);
}

TEST(TrianglesIntersect, AgreesWithExactArithmetic) {
  for (const double scale : {1.0, 0x1p-300, 0x1p+300}) {
    for (const TriangleKind kind : kTriangleKinds) {
      SCOPED_TRACE(testing::Message() << name(kind) << " times " << scale);
      HardTriangles triangles(1);
      int intersecting = 0;
      const int count = scale == 1 ? kSamples : kSamples / 20;
      for (int i = 0; i < count; ++i) {
        const auto [first, second] = anyPair(triangles, kind);
        const bool expected = exact::intersect(first, second);
        ASSERT_EQ(trianglesIntersect(scaled(first, scale), scaled(second, scale)), expected);
        intersecting += expected ? 1 : 0;
      }
      EXPECT_GT(intersecting, count / 20);
      EXPECT_LT(intersecting, count - count / 20);
    }
  }
}

TEST(TrianglesIntersect, DoesNotDependOnTheOrder) {
  for (const TriangleKind kind : kTriangleKinds) {
    SCOPED_TRACE(name(kind));
    HardTriangles triangles(2);
    for (int i = 0; i < kSamples / 50; ++i) {
      const auto [first, second] = anyPair(triangles, kind);
      const bool expected = trianglesIntersect(first, second);
      forEachOrder(first, second, [expected](const Triangle& one, const Triangle& other) {
        ASSERT_EQ(trianglesIntersect(one, other), expected);
      });
    }
  }
}

}  // namespace
}  // namespace organ_collision::core
