#include "reference/exact.h"

#include <gtest/gtest.h>

#include "organ_collision/core/closest_point.h"
#include "test_meshes.h"

namespace organ_collision::core::exact {
namespace {

using test::corners;

TEST(ExactNearest, KnowsHandMadeDistances) {
  EXPECT_EQ(nearest(test::cube(), {0.5, 0.25, 3.0}).distance, 2);
  EXPECT_EQ(nearest(test::cube(), {0.5, 0.25, 0.5}).distance, 0.25);
  EXPECT_EQ(nearest(test::cube(), {4.0, 5.0, 1.0}).distance, 5);
  EXPECT_EQ(index(nearest(test::row(101), {67.0, 0.5, 1.0}).triangle), 67U);
}

TEST(ExactNearest, TellsApartWhatDoublesCannot) {
  const double near = std::nextafter(1.0, 0.0);
  const TriangleMesh planes(
      {{-9, -9, 1}, {9, -9, 1}, {0, 9, 1}, {-9, -9, -near}, {9, -9, -near}, {0, 9, -near}},
      {corners(0, 1, 2), corners(3, 4, 5)});
  const Eigen::Vector3d far_aside(0, 0, 0x1p-55);
  EXPECT_EQ(index(nearest(planes, far_aside).triangle), 1U);
  EXPECT_EQ(nearest(planes, far_aside).distance, Real(near) + Real(0x1p-55));
}

TEST(ExactNearest, LeavesOutOnlyTrianglesThatAreFarther) {
  std::mt19937 generator(3);
  const TriangleMesh mesh = test::soup(60, 4);
  std::size_t left_out = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d point = test::randomPoint(generator, 1.5);
    Real least = distance(point, mesh.triangle(TriangleId{0}));
    for (std::size_t t = 0; t < mesh.triangleCount(); ++t)
      least = std::min(least, distance(point, mesh.triangle(static_cast<TriangleId>(t))));
    ASSERT_EQ(nearest(mesh, point).distance, least);
    left_out += mesh.triangleCount() - candidates(mesh, point).size();
  }
  EXPECT_GT(left_out, 0U);
}

TEST(ExactWindingNumber, IsOneInsideAndZeroOutside) {
  EXPECT_EQ(windingNumber(test::cube(), {0.5, 0.5, 0.5}), 1);
  EXPECT_EQ(windingNumber(test::cube(), {0x1p-1000, 0.5, 0.5}), 1);
  EXPECT_EQ(windingNumber(test::cube(), {-0x1p-1000, 0.5, 0.5}), 0);
  for (const Eigen::Vector3d& outside : {Eigen::Vector3d(2, 0, 0), Eigen::Vector3d(-1, 1, 1),
                                         Eigen::Vector3d(0, 0, 5), Eigen::Vector3d(0.5, 2, 0.5)})
    EXPECT_EQ(windingNumber(test::cube(), outside), 0);
}

TEST(ExactWindingNumber, CountsWithItsSignAndEveryCopy) {
  std::vector<Corners> triangles = test::cube().triangles();
  for (Corners& triangle : triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_EQ(windingNumber({test::cube().positions(), triangles}, {0.5, 0.5, 0.5}), -1);
  triangles.insert(triangles.end(), triangles.begin(), triangles.end());
  triangles.push_back(corners(0, 0, 1));  // without area
  EXPECT_EQ(windingNumber({test::cube().positions(), triangles}, {0.5, 0.5, 0.5}), -2);
}

}  // namespace
}  // namespace organ_collision::core::exact
