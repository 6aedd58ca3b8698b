#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "organ_collision/core/collision_mesh.h"
#include "test_meshes.h"

// What is asked in random tests: about which surfaces, from where.
namespace organ_collision::test {

/// All kinds of surfaces: closed, open, flat with ties everywhere, broken, with parts of all sizes.
inline const std::vector<core::CollisionMesh>& organs() {
  static const std::vector<core::CollisionMesh> all = {
      core::CollisionMesh(cube()),
      core::CollisionMesh(grid(8, 8)),
      core::CollisionMesh(grid(38, 39)),
      core::CollisionMesh(row(101)),
      core::CollisionMesh(blob(4)),
      core::CollisionMesh(soup(500, 3)),
      core::CollisionMesh(halvings(40)),
      core::CollisionMesh(TriangleMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {corners(0, 1, 2)}))};
  return all;
}

/// The organ so far away that coordinates are coarse.
inline core::CollisionMesh farAway(const core::CollisionMesh& organ) {
  const Eigen::Vector3d size = organ.health().box.high - organ.health().box.low;
  Points positions = organ.mesh().positions();
  for (Eigen::Vector3d& position : positions)
    position += 0x1p45 * size.maxCoeff() * Eigen::Vector3d(1, -0.7, 0.3);
  return core::CollisionMesh(core::TriangleMesh(positions, organ.mesh().triangles()));
}

/// Near, on and far from the organ, some on its vertices and centroids, where ties are.
inline Eigen::Vector3d randomTip(std::mt19937& generator, const core::CollisionMesh& organ) {
  const core::Box& box = organ.health().box;
  const double size = (box.high - box.low).maxCoeff();
  const Points& positions = organ.mesh().positions();
  const Eigen::Vector3d vertex = positions[generator() % positions.size()];
  const core::Triangle corners = organ.mesh().triangle(
      static_cast<core::TriangleId>(generator() % organ.mesh().triangleCount()));
  switch (generator() % 7) {
    case 0:
      return vertex;
    case 1:
      return core::centroid(corners);
    case 2:
      return vertex + randomPoint(generator, 0.01 * size);
    case 3:
      return 0.5 * (box.low + box.high) + randomPoint(generator, size);
    case 4:  // as near as the triangle is large
      return corners.a + randomPoint(generator, (corners.b - corners.a).norm());
    case 5:
      return Eigen::Vector3d(std::round(vertex.x()), std::round(vertex.y()), 0.5 * size);
    default:
      return randomPoint(generator, 100.0 * size);
  }
}

/// One of four is a segment, as a shaft is.
inline core::Triangle randomTriangle(std::mt19937& generator, const core::CollisionMesh& organ) {
  const Eigen::Vector3d a = randomTip(generator, organ);
  const double size = (organ.health().box.high - organ.health().box.low).maxCoeff();
  if (generator() % 4 == 0) {
    const Eigen::Vector3d end = a + randomPoint(generator, size);
    return {a, end, end};
  }
  return {a, a + randomPoint(generator, 0.1 * size), a + randomPoint(generator, 0.1 * size)};
}

/// 4*u*extent [m]: what answers may differ by from the truth.
inline double rounding(const core::CollisionMesh& organ, const Eigen::Vector3d& tip) {
  const core::Box& box = organ.health().box;
  const double extent = (tip - box.low).cwiseAbs().cwiseMax((tip - box.high).cwiseAbs()).norm();
  return 4.0 * 0x1p-53 * extent;
}

/// How many queries a test makes: TEST_QUERIES in the environment (scripts/soak asks for many),
/// else `usual`, but no more than TEST_MOST_QUERIES (sanitized they take long).
inline std::size_t queryCount(std::size_t usual) {
  const char* const wanted = std::getenv("TEST_QUERIES");
  const char* const most = std::getenv("TEST_MOST_QUERIES");
  const std::size_t count = wanted == nullptr ? usual : std::stoul(wanted);
  return most == nullptr ? count : std::min<std::size_t>(count, std::stoul(most));
}

}  // namespace organ_collision::test
