// Pieces that share vertices: which of them is outermost there.
#include <gtest/gtest.h>

#include <random>

#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/sign.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector3d;
using test::corners;
using test::randomPoint;

/// A cube with a narrow notch, and within it a wide tetrahedron with a corner at the notch's end:
/// what both are there together is no pseudonormal of either.
TEST(SignOfTouchingPieces, HoldsWhereAPartTouchesTheEndOfANotchFromWithin) {
  const Vector3d end(8, 0, 0);
  const TriangleMesh cube =
      test::subdivided(test::subdivided(test::placed(test::cube(), 20.0, {-10, -10, -10})));
  Points points = cube.positions();
  points.push_back(end);
  std::vector<Corners> triangles = cube.triangles();
  std::size_t notch = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if ((centroid(cube.triangle(static_cast<TriangleId>(i))) - Vector3d(-10, 0, 0)).norm() < 4)
      notch = i;
  const auto [a, b, c] = triangles[notch];
  const VertexId d = static_cast<VertexId>(points.size() - 1);
  triangles[notch] = {a, b, d};
  triangles.insert(triangles.end(), {{b, c, d}, {c, a, d}});
  const TriangleMesh wide(
      {end, end + Vector3d(-1, 5, -5), end + Vector3d(-1, -5, -5), end + Vector3d(-4, 0, -3)},
      {corners(0, 2, 1), corners(0, 1, 3), corners(0, 3, 2), corners(1, 2, 3)});
  const CollisionMesh organ(test::joined({points, triangles}, wide));
  EXPECT_FALSE(organ.tellsSide(static_cast<TriangleId>(notch)));
  std::mt19937 generator(82);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d tip = end + randomPoint(generator, 1.5);
    ASSERT_EQ(nearestTriangle(organ, tip).distance < 0.0, windingNumber(organ, tip) != 0)
        << tip.transpose();
  }
}

TEST(SignOfTouchingPieces, HoldsWhereTheOutermostVertexIsOfAPartWithinToo) {
  const TriangleMesh cube = test::placed(test::cube(), 10.0, {0, 0, 0});
  const TriangleMesh within(
      {{10, 10, 10}, {9, 7, 9}, {7, 9, 9}, {9, 9, 7}},
      {corners(0, 1, 2), corners(0, 3, 1), corners(0, 2, 3), corners(1, 3, 2)});
  for (const TriangleMesh& part : {within, test::turned(within)}) {
    const CollisionMesh organ(test::joined(part, cube));
    std::mt19937 generator(83);
    for (int i = 0; i < 1000; ++i) {
      const Vector3d tip = randomPoint(generator, 6.0) + Vector3d::Constant(5.0);
      ASSERT_EQ(nearestTriangle(organ, tip).distance < 0.0, windingNumber(organ, tip) != 0)
          << tip.transpose();
    }
  }
}

TEST(SignOfTouchingPieces, IsToldAtOnceThoughAVertexOfNoTriangleIsOutermost) {
  const TriangleMesh cube = test::cube();
  const TriangleMesh two = test::joined(cube, test::placed(test::cube(), 1.0, {-1, -1, -1}));
  Points points = two.positions();
  points.emplace_back(9, 9, 9);
  const CollisionMesh organ(TriangleMesh(points, two.triangles()));
  EXPECT_TRUE(organ.tellsSide(TriangleId{10}));
}

}  // namespace
}  // namespace organ_collision::core
