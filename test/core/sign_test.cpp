#include "organ_collision/core/sign.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "organ_collision/core/nearest_triangle.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using test::corners;
using test::randomPoint;

double distance(const CollisionMesh& organ, const Eigen::Vector3d& tip) {
  const NearestTriangle nearest = nearestTriangle(organ, tip);
  EXPECT_TRUE(nearest.distance_signed);
  return nearest.distance;
}

TEST(Sign, IsNegativeInsideACubeAndPositiveInAllDirectionsOutside) {
  const CollisionMesh cube(test::cube());
  EXPECT_EQ(distance(cube, {0.5, 0.5, 0.5}), -0.5);
  EXPECT_EQ(distance(cube, {-1, -1, 0}), std::sqrt(2.0));
  EXPECT_EQ(distance(cube, {-1, -1, -1}), std::sqrt(3.0));
  EXPECT_EQ(distance(cube, {1e-6, 0.5, 0.5}), -1e-6);
  EXPECT_EQ(distance(cube, {-1e-6, 0.5, 0.5}), 1e-6);
  EXPECT_EQ(distance(cube, {0, 0.5, 0.5}), 0.0);
  EXPECT_EQ(distance(CollisionMesh(test::cube(2.0)), {3, 2, 2}), 1.0);
}

TEST(Sign, OfAMeshThatIsInsideOutIsThatOfTheMeshTurnedRight) {
  std::vector<Corners> turned = test::cube().triangles();
  for (Corners& triangle : turned) std::swap(triangle[1], triangle[2]);
  const CollisionMesh cube(TriangleMesh(test::cube().positions(), turned));
  ASSERT_TRUE(cube.health().inverted);
  EXPECT_EQ(distance(cube, {0.5, 0.5, 0.75}), -0.25);
  const NearestTriangle above = nearestTriangle(cube, Eigen::Vector3d(0.5, 0.25, 2.0));
  EXPECT_EQ(above.distance, 1.0);
  EXPECT_EQ(above.normal, Eigen::Vector3d(0, 0, 1));
}

TEST(Sign, IsNotClaimedForASurfaceThatIsOpenOrWoundBothWays) {
  const CollisionMesh open(test::grid(4, 4));
  EXPECT_FALSE(nearestTriangle(open, Eigen::Vector3d(2, 2, -1)).distance_signed);
  EXPECT_EQ(nearestTriangle(open, Eigen::Vector3d(2, 2, -1)).distance, 1.0);
  std::vector<Corners> triangles = test::cube().triangles();
  std::swap(triangles[3][0], triangles[3][1]);
  const CollisionMesh mixed(TriangleMesh(test::cube().positions(), triangles));
  EXPECT_FALSE(nearestTriangle(mixed, Eigen::Vector3d(0.5, 0.5, 0.5)).distance_signed);
}

TEST(Sign, ComesThroughVerticesThatAreSplitInTheFile) {
  Points points;
  std::vector<Corners> triangles;
  const TriangleMesh whole = test::cube();
  for (const Corners& triangle : whole.triangles()) {
    const std::size_t first = points.size();
    for (const VertexId corner : triangle) points.push_back(whole.position(corner));
    triangles.push_back(corners(first, first + 1, first + 2));
  }
  const CollisionMesh cube(TriangleMesh(points, triangles));
  EXPECT_EQ(distance(cube, {0.5, 0.5, 0.5}), -0.5);
  EXPECT_EQ(distance(cube, {-1, -1, -1}), std::sqrt(3.0));
}

TEST(Sign, IsLostWhenWeldedVerticesPartAndComesBackWhenTheyMeet) {
  Points points = test::cube().positions();
  points.push_back(points[0]);
  std::vector<Corners> triangles = test::cube().triangles();
  triangles[0][0] = static_cast<VertexId>(8);
  CollisionMesh cube(TriangleMesh(points, triangles));
  ASSERT_TRUE(cube.health().closed);
  Points parted = points;
  parted[8] -= Eigen::Vector3d(0.1, 0, 0);
  cube.refit(parted);
  EXPECT_FALSE(cube.health().closed);
  EXPECT_FALSE(nearestTriangle(cube, Eigen::Vector3d(0.5, 0.5, 0.5)).distance_signed);
  cube.refit(points);
  EXPECT_TRUE(nearestTriangle(cube, Eigen::Vector3d(0.5, 0.5, 0.5)).distance_signed);
}

TEST(Sign, ByPseudonormalEqualsTheWindingNumberEverywhere) {
  std::mt19937 generator(21);
  for (const TriangleMesh& mesh : {test::cube(), test::blob(2), test::blob(4)}) {
    const CollisionMesh organ(mesh);
    const Box& box = organ.health().box;
    const double size = (box.high - box.low).maxCoeff();
    int inside = 0;
    for (int i = 0; i < 20000; ++i) {
      Eigen::Vector3d point = 0.5 * (box.low + box.high) + randomPoint(generator, 0.6 * size);
      if (i % 2 == 0)
        point = mesh.positions()[generator() % mesh.positions().size()] +
                randomPoint(generator, 0.01 * size);
      const bool is_inside = windingNumber(organ, point) != 0;
      if (is_inside) ++inside;
      EXPECT_EQ(nearestTriangle(organ, point).distance < 0.0, is_inside);
    }
    EXPECT_GT(inside, 1000);
  }
}

/// Where parts share a vertex or an edge, a pseudonormal tells the side of one of them alone.
TEST(Sign, HoldsWherePartsOfTheSurfaceTouch) {
  const TriangleMesh cube = test::placed(test::cube(), 10.0, {0, 0, 0});
  const TriangleMesh at_vertex(
      {{0, 0, 0}, {3, 1, 1}, {1, 3, 1}, {1, 1, 3}},
      {corners(0, 2, 1), corners(0, 1, 3), corners(0, 3, 2), corners(1, 2, 3)});
  const TriangleMesh at_edge(
      {{10, 10, 0}, {10, 10, 10}, {12, 11, 5}, {11, 12, 5}},
      {corners(0, 2, 1), corners(0, 3, 2), corners(0, 1, 3), corners(1, 2, 3)});
  std::mt19937 generator(63);
  for (const TriangleMesh& part :
       {at_vertex, test::turned(at_vertex), at_edge, test::turned(at_edge)}) {
    const TriangleMesh whole = test::joined(cube, part);
    for (const TriangleMesh& mesh : {whole, test::turned(whole)}) {
      const CollisionMesh organ(mesh);
      EXPECT_EQ(organ.topology().parts().size(), 1U);
      EXPECT_FALSE(organ.topology().isOnePiece());
      EXPECT_EQ(organ.tellsSide(TriangleId{10}), part.position(VertexId{0}).isZero())
          << "the cube's at x = 10, if that is outermost";
      for (int i = 0; i < 1000; ++i) {
        const Eigen::Vector3d tip = randomPoint(generator, 7.0) + Eigen::Vector3d::Constant(6.0);
        ASSERT_EQ(distance(organ, tip) < 0.0, windingNumber(organ, tip) != 0);
      }
    }
  }
}

/// A small tetrahedron that hangs at a cube's corner, and then lies within it.
TEST(Sign, HoldsWhereAnotherPieceHasBecomeOutermost) {
  const TriangleMesh cube = test::placed(test::cube(), 10.0, {0, 0, 0});
  const TriangleMesh small(
      {{10, 10, 10}, {13, 11, 11}, {11, 13, 11}, {11, 11, 13}},
      {corners(0, 2, 1), corners(0, 1, 3), corners(0, 3, 2), corners(1, 2, 3)});
  const Points within = {{9, 7, 9}, {7, 9, 9}, {9, 9, 7}};
  const TriangleMesh mesh = test::joined(cube, small);
  const std::size_t first = mesh.positions().size() - within.size();
  std::vector<VertexId> moved;
  Points positions = mesh.positions();
  for (std::size_t i = 0; i < within.size(); ++i) {
    moved.push_back(static_cast<VertexId>(first + i));
    positions[first + i] = within[i];
  }
  std::mt19937 generator(64);
  for (const bool is_whole : {true, false}) {
    CollisionMesh organ(mesh);
    is_whole ? organ.refit(positions) : organ.refit(moved, within);
    ASSERT_TRUE(organ.health().isSolid());
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector3d tip = randomPoint(generator, 6.0) + Eigen::Vector3d::Constant(5.0);
      ASSERT_EQ(distance(organ, tip) < 0.0, windingNumber(organ, tip) != 0) << tip.transpose();
    }
  }
}

TEST(Sign, ComesWithANormalThatLeadsOutwardsHoweverNearTheTipIs) {
  const TriangleMesh cube = test::placed(test::cube(), 4.0, {0, 0, 0});
  const CollisionMesh organ(test::joined(cube, test::placed(test::cube(), 1.0, {1, 1, 1})));
  for (const double height : {0x1p-20, 0x1p-30, 0x1p-40}) {
    const NearestTriangle nearest = nearestTriangle(organ, Eigen::Vector3d(1.25, 1.5, 2 + height));
    EXPECT_LT(nearest.distance, 0.0);
    EXPECT_EQ(nearest.normal, Eigen::Vector3d(0, 0, -1)) << height;
  }
}

TEST(Sign, ComesWithANormalThatLeadsOutwardsAlsoOfAPartThatIsInsideOut) {
  const TriangleMesh cube = test::cube();
  const TriangleMesh other = test::placed(cube, 1.0, {3, 0, 0});
  const TriangleMesh hollow = test::placed(cube, 0.5, {0.25, 0.25, 0.25});
  for (const TriangleMesh& part : {other, test::turned(other), test::turned(hollow)}) {
    const TriangleMesh whole = test::joined(cube, part);
    for (const TriangleMesh& mesh : {whole, test::turned(whole)}) {
      const CollisionMesh organ(mesh);
      std::mt19937 generator(67);
      for (int i = 0; i < 1000; ++i) {
        const Eigen::Vector3d tip = randomPoint(generator, 2.5) + Eigen::Vector3d(2, 0.5, 0.5);
        const NearestTriangle nearest = nearestTriangle(organ, tip);
        const Eigen::Vector3d away = tip - nearest.closest.point;
        ASSERT_GT(nearest.normal.dot(away) * nearest.distance, 0.0) << tip.transpose();
        const NearestTriangle greedy = nearestTriangle(organ, 3.0 * tip, Accuracy::greedy());
        if (greedy.isExact()) continue;
        ASSERT_EQ(greedy.normal, pseudonormal(organ, greedy.triangle, greedy.closest.feature));
      }
    }
  }
}

/// The vertices that are so many edges away from the first.
std::vector<std::size_t> verticesAway(const TriangleMesh& mesh, std::size_t edges) {
  std::vector<std::size_t> away(mesh.positions().size(), mesh.positions().size());
  away[0] = 0;
  for (std::size_t step = 1; step <= edges; ++step) {
    for (const Corners& corners : mesh.triangles())
      for (const VertexId corner : corners)
        if (away[index(corner)] == step - 1)
          for (const VertexId other : corners)
            away[index(other)] = std::min(away[index(other)], step);
  }
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < away.size(); ++i)
    if (away[i] == edges) found.push_back(i);
  return found;
}

/// Two spikes of one body that meet along an edge, or in their tips.
TEST(Sign, HoldsWhereTheSurfaceTouchesItself) {
  const TriangleMesh round = test::blob(4);
  std::mt19937 generator(65);
  for (const std::size_t edges : {2, 4}) {
    for (const std::size_t second : verticesAway(round, edges)) {
      Points points = round.positions();
      points[0] = points[second] = 0.6 * (points[0] + points[second]);
      const CollisionMesh organ(TriangleMesh(points, round.triangles()));
      ASSERT_TRUE(organ.health().isSolid());
      ASSERT_TRUE(organ.topology().isOnePiece() || edges == 2);
      for (int i = 0; i < 300; ++i) {
        const Eigen::Vector3d tip = points[0] + randomPoint(generator, 0.1);
        ASSERT_EQ(distance(organ, tip) < 0.0, windingNumber(organ, tip) != 0) << tip.transpose();
      }
    }
  }
}

TEST(WindingNumber, CountsRaysThroughVerticesAndAlongEdgesAndFacesOnce) {
  const CollisionMesh cube(test::cube());
  // Every ray from these points along +x grazes vertices, edges or faces of the cube, or runs
  // within them.
  for (const double y : {0.0, 0.5, 1.0}) {
    for (const double z : {0.0, 0.5, 1.0}) EXPECT_EQ(windingNumber(cube, {2, y, z}), 0);
  }
  EXPECT_EQ(windingNumber(cube, {0.25, 0.5, 0.5}), 1);  // leaves through a diagonal
  EXPECT_EQ(windingNumber(cube, {0.25, 0.25, 0.5}), 1);
  EXPECT_EQ(windingNumber(cube, {-1, 0.5, 0.5}), 0);  // in and out through diagonals
  EXPECT_EQ(windingNumber(cube, {-1, 1, 1}), 0);      // along an edge
  EXPECT_EQ(windingNumber(cube, {-1, 0, 0}), 0);
}

TEST(Sign, HoldsNextToCapsWithoutArea) {
  // The top splits the edge that it shares with the front (y = 0, z = 1), the front does not: a cap
  // closes the gap.
  Points points = test::cube().positions();
  points.emplace_back(0.25, 0.0, 1.0);
  std::vector<Corners> triangles = test::cube().triangles();
  triangles[2] = corners(8, 5, 6);  // with the next: what was 4 5 6
  triangles.push_back(corners(4, 8, 6));
  triangles.push_back(corners(4, 5, 8));  // the cap
  const CollisionMesh cube(TriangleMesh(points, triangles));
  ASSERT_TRUE(cube.health().isSolid());
  ASSERT_EQ(cube.health().degenerate_triangles, 1U);
  std::mt19937 generator(22);
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d point = Eigen::Vector3d(0.25, 0.0, 1.0) + randomPoint(generator, 0.2);
    const bool is_inside = point.y() > 0.0 && point.z() < 1.0 && point.x() > 0.0;
    EXPECT_EQ(distance(cube, point) < 0.0, is_inside);
  }
}

/// However turned: then the cap's normal is what rounding makes of it.
TEST(Sign, HoldsNextToCapsThatAreThinnerThanRounding) {
  Points points = test::cube().positions();
  points.emplace_back(0.25, 0.0, 1.0);
  std::vector<Corners> triangles = test::cube().triangles();
  triangles[2] = corners(8, 5, 6);
  triangles.push_back(corners(4, 8, 6));
  triangles.push_back(corners(4, 5, 8));  // the cap
  std::mt19937 generator(23);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Isometry3d pose = test::randomPose(generator, 1.0);
    Points turned = points;
    for (Eigen::Vector3d& point : turned) point = pose * point;
    const CollisionMesh cube(TriangleMesh(turned, triangles));
    for (int k = 0; k < 100; ++k) {
      const Eigen::Vector3d point = Eigen::Vector3d(0.25, 0.0, 1.0) + randomPoint(generator, 0.2);
      const bool is_inside = point.y() > 0.0 && point.z() < 1.0 && point.x() > 0.0;
      ASSERT_EQ(distance(cube, pose * point) < 0.0, is_inside);
    }
  }
}

TEST(Sign, IsThatOfTheWindingNumberAsNearAsCanBe) {
  std::mt19937 generator(25);
  const CollisionMesh organ(test::blob(2));
  for (int i = 0; i < 20000; ++i) {
    const Triangle t =
        organ.mesh().triangle(TriangleId(generator() % organ.mesh().triangleCount()));
    const Eigen::Vector3d weights = randomPoint(generator, 1.0).cwiseAbs();
    const Eigen::Vector3d on =
        (weights.x() * t.a + weights.y() * t.b + weights.z() * t.c) / weights.sum();
    const double found = distance(organ, on);
    if (found == 0.0) continue;
    ASSERT_EQ(found < 0.0, windingNumber(organ, on) != 0);
  }
}

/// Turned: then rounding makes what is left of the thickness.
TEST(Sign, OfASolidThatIsPressedFlatIsThatOfTheWindingNumber) {
  std::mt19937 generator(24);
  for (const TriangleMesh& mesh : {test::cube(), test::blob(2)}) {
    CollisionMesh organ(mesh);
    for (int i = 0; i < 20; ++i) {
      const Eigen::Isometry3d pose = test::randomPose(generator, 1.0);
      Points flat = mesh.positions();
      for (Eigen::Vector3d& point : flat) point = pose * Eigen::Vector3d(point.x(), point.y(), 0.0);
      organ.refit(flat);
      ASSERT_TRUE(organ.isPerhapsFlat());
      for (int k = 0; k < 200; ++k) {
        const Eigen::Vector3d tip = flat[generator() % flat.size()] + randomPoint(generator, 0.1);
        const NearestTriangle nearest = nearestTriangle(organ, tip);
        ASSERT_EQ(nearest.distance < 0.0, windingNumber(organ, tip) != 0);
        ASSERT_GE(nearest.normal.dot(tip - nearest.closest.point) * nearest.distance, 0.0);
      }
    }
    organ.refit(mesh.positions());
    EXPECT_FALSE(organ.isPerhapsFlat());
  }
}

/// Far from the origin, where what is nearest of it is rounded.
TEST(Sign, OfATriangleIsThatOfItsCorners) {
  std::mt19937 generator(26);
  for (const double far : {10.0, 1e6}) {
    int asked = 0;
    for (int i = 0; i < 3000; ++i) {
      const Eigen::Isometry3d pose = test::randomPose(generator, far);
      Points points = test::cube().positions();
      for (Eigen::Vector3d& point : points) point = pose * point;
      const CollisionMesh organ(TriangleMesh(points, test::cube().triangles()));
      const double height = far * std::ldexp(1.0, -50 - static_cast<int>(generator() % 10));
      const auto near_top = [&] {
        const Eigen::Vector3d place = randomPoint(generator, 0.4);
        return pose * Eigen::Vector3d(0.5 + place.x(), 0.5 + place.y(), 1.0 + height);
      };
      const Eigen::Vector3d end = near_top();
      const Triangle tip = {near_top(), end, end};
      const NearestTriangle nearest = nearestTriangle(organ, tip);
      if (nearest.distance == 0.0) continue;
      ++asked;
      ASSERT_EQ(nearest.distance < 0.0, windingNumber(organ, tip.a) != 0);
    }
    EXPECT_GT(asked, 100);
  }
}

TEST(Pseudonormal, IsAUnitVectorHoweverShortAnEdgeIs) {
  const double tiny = 0x1p-600;
  for (const Points& points :
       {Points{{0, 0, 0}, {1, 0, 0}, {0, tiny, 0}}, Points{{0, 0, 0}, {tiny, 0, 0}, {0, 1, 0}}}) {
    const CollisionMesh organ(TriangleMesh(points, {corners(0, 1, 2)}));
    EXPECT_EQ(pseudonormal(organ, TriangleId{0}, Feature::kFace), Eigen::Vector3d(0, 0, 1));
  }
}

TEST(Pseudonormal, OfACubesVertexIsItsDiagonal) {
  const CollisionMesh cube(test::cube());
  const NearestTriangle nearest = nearestTriangle(cube, Eigen::Vector3d(2, 2, 2));
  EXPECT_LT((nearest.normal - Eigen::Vector3d(1, 1, 1).normalized()).norm(), 1e-15);
}

TEST(Pseudonormal, OfATriangleWithoutAreaIsZero) {
  const CollisionMesh needle(TriangleMesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {corners(0, 1, 2)}));
  EXPECT_EQ(nearestTriangle(needle, Eigen::Vector3d(1, 1, 0)).normal, Eigen::Vector3d(0, 0, 0));
}

}  // namespace
}  // namespace organ_collision::core
