#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "organ_collision/core/triangle_mesh.h"

// Meshes that tests ask about.
namespace organ_collision::test {

using core::Corners;
using core::Points;
using core::TriangleMesh;
using core::VertexId;

inline Corners corners(std::size_t a, std::size_t b, std::size_t c) {
  return {static_cast<VertexId>(a), static_cast<VertexId>(b), static_cast<VertexId>(c)};
}

inline Eigen::Vector3d randomPoint(std::mt19937& generator, double reach) {
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  const double x = coordinate(generator);
  const double y = coordinate(generator);
  return {x, y, coordinate(generator)};
}

/// Turned anyhow, and moved by at most `reach` [m] along each axis.
inline Eigen::Isometry3d randomPose(std::mt19937& generator, double reach) {
  const Eigen::Vector3d axis = randomPoint(generator, 1.0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(randomPoint(generator, reach))
      .rotate(Eigen::AngleAxisd(3.2 * axis.x(), axis.normalized()));
  return pose;
}

/// The box [0, size]^3, wound outwards.
inline TriangleMesh cube(double size = 1.0) {
  Points points;
  for (const int i : {0, 1, 2, 3, 4, 5, 6, 7})
    points.emplace_back(size * (i & 1), size * (i >> 1 & 1), size * (i >> 2));
  return {points,
          {corners(0, 2, 1), corners(1, 2, 3), corners(4, 5, 6), corners(5, 7, 6), corners(0, 1, 4),
           corners(1, 5, 4), corners(2, 6, 3), corners(3, 6, 7), corners(0, 4, 2), corners(2, 4, 6),
           corners(1, 3, 5), corners(3, 7, 5)}};
}

/// Of `scale` times the size, then moved.
inline TriangleMesh placed(const TriangleMesh& mesh, double scale, const Eigen::Vector3d& offset) {
  Points points = mesh.positions();
  for (Eigen::Vector3d& point : points) point = scale * point + offset;
  return {points, mesh.triangles()};
}

/// Inside out.
inline TriangleMesh turned(const TriangleMesh& mesh) {
  std::vector<Corners> triangles = mesh.triangles();
  for (Corners& triangle : triangles) std::swap(triangle[1], triangle[2]);
  return {mesh.positions(), triangles};
}

/// Both as one mesh.
inline TriangleMesh joined(const TriangleMesh& one, const TriangleMesh& other) {
  Points points = one.positions();
  points.insert(points.end(), other.positions().begin(), other.positions().end());
  std::vector<Corners> triangles = one.triangles();
  const std::size_t first = one.positions().size();
  for (const Corners& c : other.triangles())
    triangles.push_back(corners(first + index(c[0]), first + index(c[1]), first + index(c[2])));
  return {points, triangles};
}

/// The paper's test mesh: an open, flat grid of columns x rows cells in z = 0, two triangles each.
/// Cells of side 3 have centroids without rounding: ties are exact.
inline TriangleMesh grid(std::size_t columns, std::size_t rows) {
  Points points;
  for (std::size_t y = 0; y <= rows; ++y) {
    for (std::size_t x = 0; x <= columns; ++x)
      points.emplace_back(3.0 * static_cast<double>(x), 3.0 * static_cast<double>(y), 0.0);
  }
  std::vector<Corners> triangles;
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t x = 0; x < columns; ++x) {
      const std::size_t corner = y * (columns + 1) + x;
      const std::size_t above = corner + columns + 1;
      triangles.push_back(corners(corner, corner + 1, above + 1));
      triangles.push_back(corners(corner, above + 1, above));
    }
  }
  return {points, triangles};
}

/// Separate triangles in a row, whose centroids are the integers on the x axis: ties wherever a set
/// is split.
inline TriangleMesh row(std::size_t count) {
  Points points;
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = static_cast<double>(i);
    points.insert(points.end(), {{x - 0.5, -1, 0}, {x + 0.5, -1, 0}, {x, 2, 0}});
    triangles.push_back(corners(3 * i, 3 * i + 1, 3 * i + 2));
  }
  return {points, triangles};
}

/// Every triangle split in four, the new vertices in the middle of the old edges.
inline TriangleMesh subdivided(const TriangleMesh& mesh) {
  Points points = mesh.positions();
  std::vector<Corners> triangles;
  std::map<std::pair<VertexId, VertexId>, VertexId> middles;
  const auto middle = [&](VertexId a, VertexId b) {
    const auto [found, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<VertexId>(points.size()));
    if (is_new) points.emplace_back(0.5 * (mesh.position(a) + mesh.position(b)));
    return found->second;
  };
  for (const auto& [a, b, c] : mesh.triangles()) {
    const VertexId ab = middle(a, b);
    const VertexId bc = middle(b, c);
    const VertexId ca = middle(c, a);
    for (const Corners& part :
         {Corners{a, ab, ca}, Corners{ab, b, bc}, Corners{ca, bc, c}, Corners{ab, bc, ca}}) {
      triangles.push_back(part);
    }
  }
  return {points, triangles};
}

/// A closed organ-like blob: an octahedron split `levels` times, pushed to a bumpy ellipsoid of
/// some decimetres.
inline TriangleMesh blob(std::size_t levels) {
  TriangleMesh sphere({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                      {corners(0, 2, 4), corners(2, 1, 4), corners(1, 3, 4), corners(3, 0, 4),
                       corners(2, 0, 5), corners(1, 2, 5), corners(3, 1, 5), corners(0, 3, 5)});
  Points points = sphere.positions();
  for (std::size_t level = 0; level < levels; ++level) {
    sphere = subdivided(sphere);
    points = sphere.positions();
    for (Eigen::Vector3d& point : points) point.normalize();
    sphere.setPositions(points);
  }
  for (Eigen::Vector3d& point : points) {
    const double radius =
        0.1 * (1.0 + 0.25 * std::sin(3.0 * point.x() + 1.0) * std::cos(4.0 * point.y()));
    point = radius * point.cwiseProduct(Eigen::Vector3d(1.2, 0.8, 0.5));
  }
  return {points, sphere.triangles()};
}

/// Closed tetrahedra in a row, each an eighth as large as its place on the x axis [m] says.
inline TriangleMesh tetrahedra(const std::vector<double>& places) {
  Points points;
  std::vector<Corners> triangles;
  for (const double x : places) {
    const double size = x / 8;
    const std::size_t a = points.size();
    points.insert(points.end(), {{x, 0, 0}, {x + size, 0, 0}, {x, size, 0}, {x, 0, size}});
    for (const Corners& face : {corners(a, a + 2, a + 1), corners(a, a + 1, a + 3),
                                corners(a, a + 3, a + 2), corners(a + 1, a + 2, a + 3)})
      triangles.push_back(face);
  }
  return {points, triangles};
}

/// Tetrahedra of all sizes: from 2^exponent m on, each is half as far and half as large as the one
/// before.
inline TriangleMesh halvings(std::size_t count, int exponent = 0) {
  std::vector<double> places;
  for (std::size_t i = 0; i < count; ++i)
    places.push_back(std::ldexp(1.0, exponent - static_cast<int>(i)));
  return tetrahedra(places);
}

/// Unconnected random triangles, among them needles, zero-area ones and duplicates.
inline TriangleMesh soup(std::size_t count, std::uint32_t seed) {
  std::mt19937 generator(seed);
  Points points;
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d a = randomPoint(generator, 1.0);
    Eigen::Vector3d b = a + randomPoint(generator, 0.2);
    Eigen::Vector3d c = a + randomPoint(generator, 0.2);
    if (i % 7 == 1) c = a + (b - a) * 0.5 + randomPoint(generator, 1e-9);
    if (i % 7 == 2) c = b;
    if (i % 7 == 3) b = c = a;
    points.insert(points.end(), {a, b, c});
    triangles.push_back(corners(3 * i, 3 * i + 1, 3 * i + 2));
    if (i % 7 == 4) triangles.push_back(corners(3 * i + 1, 3 * i + 2, 3 * i));
  }
  return {points, triangles};
}

/// The same triangles in another order.
inline TriangleMesh shuffled(const TriangleMesh& mesh, std::uint32_t seed) {
  std::vector<Corners> triangles = mesh.triangles();
  std::mt19937 generator(seed);
  std::shuffle(triangles.begin(), triangles.end(), generator);
  return {mesh.positions(), triangles};
}

}  // namespace organ_collision::test
