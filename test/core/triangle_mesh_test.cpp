#include "organ_collision/core/triangle_mesh.h"

#include <gmock/gmock.h>

#include <limits>
#include <stdexcept>

#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using test::corners;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Points kThreePoints = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

TEST(TriangleMesh, RefusesToBeEmpty) {
  EXPECT_THAT([] { TriangleMesh(kThreePoints, {}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("no triangle")));
}

TEST(TriangleMesh, RefusesACornerThatIsNoVertexAndNamesBoth) {
  EXPECT_THAT(
      [] {
        TriangleMesh(kThreePoints, {corners(0, 1, 2), corners(0, 1, 3)});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("triangle 1 names vertex 3 of 3")));
}

TEST(TriangleMesh, RefusesPositionsThatAreNotUsableAndNamesTheVertex) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), -1e200}) {
    Points points = kThreePoints;
    points[2].y() = bad;
    EXPECT_THAT([&] { TriangleMesh(points, {corners(0, 1, 2)}); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("vertex 2")));
  }
}

TEST(TriangleMesh, StaysAsItWasWhenNewPositionsDoNotFit) {
  TriangleMesh mesh(kThreePoints, {corners(0, 1, 2)});
  EXPECT_THAT(
      [&] {
        mesh.setPositions({{0, 0, 0}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("1 positions given for 3 vertices")));
  Points bad = kThreePoints;
  bad[1].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(mesh.setPositions(bad), std::invalid_argument);
  EXPECT_EQ(mesh.positions(), kThreePoints);
}

TEST(TriangleMesh, CentroidHasTheSameBitsForEveryOrderOfTheCorners) {
  std::mt19937 generator(1);
  for (int i = 0; i < 1000; ++i) {
    const Triangle t = {test::randomPoint(generator, 1), test::randomPoint(generator, 1e3),
                        test::randomPoint(generator, 1e-3)};
    const Eigen::Vector3d expected = centroid(t);
    for (const Triangle& turned :
         {Triangle{t.b, t.c, t.a}, Triangle{t.c, t.a, t.b}, Triangle{t.b, t.a, t.c},
          Triangle{t.a, t.c, t.b}, Triangle{t.c, t.b, t.a}}) {
      EXPECT_EQ(centroid(turned), expected);
    }
  }
}

/// Enough for several tasks.
TEST(TriangleMesh, RefusesOneOfManyPositionsAndKnowsTheirBox) {
  const TriangleMesh large = test::blob(6);
  for (const std::size_t vertex :
       {std::size_t{0}, std::size_t{9000}, large.positions().size() - 1}) {
    Points points = large.positions();
    points[vertex].x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(TriangleMesh(points, large.triangles()), std::invalid_argument);
    for (const double x : {-3.0, 3.0}) {
      points[vertex].x() = x;
      const Box box = TriangleMesh(large).setPositions(points);
      EXPECT_TRUE(box.contains(points[vertex])) << vertex;
    }
  }
}

TEST(TriangleMesh, NamesTheVertexThatCannotBeMoved) {
  const TriangleMesh mesh(kThreePoints, {corners(0, 1, 2)});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(
      [&] {
        mesh.requireFitting({VertexId{2}}, {{0, nan, 0}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("vertex 2 is")));
  EXPECT_THAT(
      [&] {
        mesh.requireFitting({VertexId{9}}, {{0, 0, 0}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("no vertex 9: the mesh has 3")));
}

}  // namespace
}  // namespace organ_collision::core
