#include "organ_collision/core/mesh_topology.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector3d;
using test::cube;
using test::joined;
using test::placed;

std::size_t partsOf(const TriangleMesh& mesh) { return MeshTopology(mesh).parts().size(); }

TEST(MeshTopology, HasAsManyPartsAsHangTogether) {
  EXPECT_EQ(partsOf(cube()), 1U);
  EXPECT_EQ(partsOf(test::shuffled(test::blob(4), 5)), 1U);
  EXPECT_EQ(partsOf(joined(cube(), placed(cube(), 0.5, {2, 0, 0}))), 2U);
  EXPECT_EQ(partsOf(joined(cube(), placed(cube(), 1.0, {1, 1, 1}))), 1U) << "they share a vertex";
  EXPECT_EQ(partsOf(test::shuffled(test::tetrahedra({0, 10, 20, 30}), 6)), 4U);
  Points points = cube().positions();
  points.insert(points.begin(), Vector3d(9, 9, 9));
  EXPECT_EQ(partsOf({points, {test::corners(1, 2, 3)}}), 1U) << "some vertices have no triangle";
}

TEST(MeshTopology, TellsOnePieceFromWhatOnlyTouches) {
  EXPECT_TRUE(MeshTopology(cube()).isOnePiece());
  EXPECT_TRUE(MeshTopology(test::blob(4)).isOnePiece());
  EXPECT_FALSE(MeshTopology(test::grid(2, 2)).isOnePiece()) << "open";
  const TriangleMesh apart = joined(cube(), placed(cube(), 1.0, {2, 2, 2}));
  EXPECT_FALSE(MeshTopology(apart).isOnePiece());
  Points points = {{0, 0, 0}};  // a body with forty triangles around a vertex
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < 40; ++i) {
    const double turn = 0.157 * static_cast<double>(i);
    points.emplace_back(std::cos(turn), std::sin(turn), i % 2 == 0 ? 0.5 : 0.75);
  }
  points.emplace_back(0, 0, 2);
  for (std::size_t i = 1; i <= 40; ++i) {
    triangles.push_back(test::corners(0, i % 40 + 1, i));
    triangles.push_back(test::corners(41, i, i % 40 + 1));
  }
  EXPECT_TRUE(MeshTopology(TriangleMesh(points, triangles)).isOnePiece());
}

/// A tetrahedron whose bottom is one triangle, each corner of which has more triangles than are
/// looked at as a fan: the sides are fans from there to points on the edge across.
TriangleMesh tetrahedronOfFans() {
  constexpr int kPoints = 40;  // on each of the edges that go up
  const std::array<Vector3d, 3> bottom = {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
  const Vector3d top(0.2, 0.2, 1);
  Points points(bottom.begin(), bottom.end());
  points.push_back(top);
  for (const Vector3d& corner : bottom)
    for (int i = 1; i <= kPoints; ++i)
      points.emplace_back(corner + (top - corner) * i / (kPoints + 1.0));
  const auto on_edge = [](int corner, int i) {
    if (i > kPoints) return 3;
    return i == 0 ? corner : 4 + corner * kPoints + i - 1;
  };
  std::vector<Corners> triangles = {test::corners(0, 2, 1)};
  for (int corner = 0; corner < 3; ++corner) {
    const int next = (corner + 1) % 3;
    for (int i = 0; i < kPoints; ++i)
      triangles.push_back(test::corners(corner, on_edge(next, i), on_edge(next, i + 1)));
    for (int i = 0; i <= kPoints; ++i)
      triangles.push_back(
          test::corners(on_edge(corner, i), on_edge(next, kPoints), on_edge(corner, i + 1)));
  }
  return {points, triangles};
}

TEST(MeshTopology, HangsTogetherWhereNoCornerOfATriangleIsAFan) {
  EXPECT_TRUE(MeshTopology(tetrahedronOfFans()).isOnePiece());
}

/// Large enough for several tasks, of which one finds the fault.
TEST(MeshTopology, FindsTheOneFaultOfALargeSurface) {
  const TriangleMesh sound = test::blob(6);
  std::mt19937 generator(9);
  for (int i = 0; i < 30; ++i) {
    const std::size_t one = generator() % sound.triangleCount();
    std::vector<Corners> open = sound.triangles();
    open.erase(open.begin() + static_cast<std::ptrdiff_t>(one));
    EXPECT_FALSE(MeshTopology({sound.positions(), open}).closed());
    std::vector<Corners> turned = sound.triangles();
    std::swap(turned[one][0], turned[one][1]);
    EXPECT_FALSE(MeshTopology({sound.positions(), turned}).consistentlyWound());
    std::vector<Corners> twice = sound.triangles();
    twice.push_back(twice[one]);
    EXPECT_EQ(MeshTopology({sound.positions(), twice}).duplicateTriangles(), 1U);
  }
}

}  // namespace
}  // namespace organ_collision::core
