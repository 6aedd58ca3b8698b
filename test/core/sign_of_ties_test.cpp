// The side where rounding does not tell which feature of a surface is the nearest.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/sign.h"
#include "organ_collision/core/tracking.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using test::corners;

/// A ring's radius and height.
struct Ring {
  double radius, height;
};

/// What the rings enclose, `sides` corners each, from an apex above the first to one of the last.
TriangleMesh turnedOnALathe(const std::vector<Ring>& rings, std::size_t sides, double first_apex,
                            double last_apex) {
  Points points = {{0, 0, first_apex}};
  for (const auto& [radius, height] : rings) {
    for (std::size_t i = 0; i < sides; ++i) {
      const double angle = 2 * M_PI * static_cast<double>(i) / static_cast<double>(sides);
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
    }
  }
  points.emplace_back(0, 0, last_apex);
  const auto at = [&](std::size_t ring, std::size_t i) { return 1 + ring * sides + i % sides; };
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < sides; ++i) {
    triangles.push_back(corners(0, at(0, i), at(0, i + 1)));
    for (std::size_t ring = 1; ring < rings.size(); ++ring) {
      triangles.push_back(corners(at(ring - 1, i), at(ring, i), at(ring, i + 1)));
      triangles.push_back(corners(at(ring - 1, i), at(ring, i + 1), at(ring - 1, i + 1)));
    }
    triangles.push_back(
        corners(points.size() - 1, at(rings.size() - 1, i + 1), at(rings.size() - 1, i)));
  }
  return {points, triangles};
}

/// The first vertex as two, joined by an edge: the triangles of the second half have the other.
TriangleMesh withTipSplit(const TriangleMesh& mesh, std::size_t sides, double apart) {
  Points points = mesh.positions();
  std::vector<Corners> triangles = mesh.triangles();
  const std::size_t other = points.size();
  points.push_back(points[0] - Eigen::Vector3d(0, apart, 0));
  std::vector<std::size_t> around;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (triangles[i][0] == VertexId{0}) around.push_back(i);
  const std::size_t start = index(triangles[around[sides / 2]][1]);
  for (std::size_t i = sides / 2; i < sides; ++i)
    triangles[around[i]][0] = static_cast<VertexId>(other);
  triangles.push_back(corners(0, start, other));
  triangles.push_back(corners(other, index(triangles[around[0]][1]), 0));
  return {points, triangles};
}

/// The side of such tips that a search and a tracker tell.
void expectTheWindingNumbersSign(const CollisionMesh& organ, const Eigen::Vector3d& around) {
  ASSERT_TRUE(organ.health().isSolid());
  std::mt19937 generator(81);
  Tracker tracker;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d tip = around + test::randomPoint(generator, 0.9);
    const bool is_inside = windingNumber(organ, tip) != 0;
    for (const NearestTriangle& nearest :
         {nearestTriangle(organ, tip), tracker.nearestTriangle(organ, 0.0, tip)}) {
      ASSERT_TRUE(nearest.distance_signed);
      ASSERT_EQ(nearest.distance < 0.0, is_inside) << tip.transpose();
    }
  }
}

/// A pin in a cup. Rounding tells the ends of its tip's edge as equally near.
TEST(Sign, HoldsAboveAnEdgeThatIsShorterThanRounding) {
  const std::size_t sides = 6;
  const TriangleMesh pin =
      turnedOnALathe({{0.1, 0}, {1.2, -0.2}, {1.2, 2}, {1.5, 2}, {1.5, -1}}, sides, 1.0, -1.0);
  for (const double apart : {1e-17, 1e-16, 1e-12}) {
    const CollisionMesh organ(withTipSplit(pin, sides, apart));
    EXPECT_TRUE(organ.topology().isOnePiece());
    expectTheWindingNumbersSign(organ, {0, 0, 1});
  }
}

/// The hollow of a bell reaches up to its peak, or all but does.
TEST(Sign, HoldsWhereTwoVerticesOfOneSurfaceAreAsNear) {
  const TriangleMesh bell =
      turnedOnALathe({{1, 0.2}, {1.2, 3}, {1.5, 3}, {1.5, -1}, {0.7, -1}, {0.5, 0}}, 12, 1.0, 0.5);
  for (const double apex : {1.0, std::nextafter(1.0, 0.0)}) {
    CollisionMesh organ(bell);
    organ.refit({static_cast<VertexId>(bell.positions().size() - 1)}, {{0, 0, apex}});
    expectTheWindingNumbersSign(organ, {0, 0, 1});
  }
}

}  // namespace
}  // namespace organ_collision::core
