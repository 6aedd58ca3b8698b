#include "primitive_mesh.h"

#include <cmath>
#include <utility>
#include <vector>

namespace organ_collision::io {
namespace {

core::Corners corners(unsigned a, unsigned b, unsigned c) {
  return {core::VertexId{a}, core::VertexId{b}, core::VertexId{c}};
}

}  // namespace

core::TriangleMesh boxMesh(const Eigen::Vector3d& size) {
  core::Points points;
  for (unsigned i = 0; i < 8; ++i) {
    const Eigen::Vector3d side((i & 1U) != 0 ? 0.5 : -0.5, (i & 2U) != 0 ? 0.5 : -0.5,
                               (i & 4U) != 0 ? 0.5 : -0.5);
    points.emplace_back(side.cwiseProduct(size));
  }
  return {std::move(points),
          {corners(0, 2, 1), corners(1, 2, 3), corners(4, 5, 6), corners(5, 7, 6), corners(0, 1, 4),
           corners(1, 5, 4), corners(2, 6, 3), corners(3, 6, 7), corners(0, 4, 2), corners(2, 4, 6),
           corners(1, 3, 5), corners(3, 7, 5)}};
}

core::TriangleMesh prismMesh(double radius, double length, int sides) {
  constexpr unsigned kBottom = 0;  // middle of the lower face
  constexpr unsigned kTop = 1;
  const double half = 0.5 * length;
  core::Points points = {{0.0, 0.0, -half}, {0.0, 0.0, half}};
  std::vector<core::Corners> triangles;
  const auto count = static_cast<unsigned>(sides);
  for (unsigned i = 0; i < count; ++i) {
    const double angle = 2.0 * M_PI * i / sides;
    const double x = radius * std::cos(angle);
    const double y = radius * std::sin(angle);
    points.insert(points.end(), {{x, y, -half}, {x, y, half}});
    const unsigned low = 2 + 2 * i;
    const unsigned next_low = 2 + 2 * ((i + 1) % count);
    triangles.insert(triangles.end(),
                     {corners(low, next_low, next_low + 1), corners(low, next_low + 1, low + 1),
                      corners(kBottom, next_low, low), corners(kTop, low + 1, next_low + 1)});
  }
  return {std::move(points), std::move(triangles)};
}

}  // namespace organ_collision::io
