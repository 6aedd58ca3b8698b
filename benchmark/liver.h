#pragma once

#include <filesystem>
#include <vector>

#include "organ_collision/io/mesh_io.h"
#include "test_meshes.h"

namespace organ_collision::bench {

using core::Corners;
using core::Points;
using core::TriangleMesh;
using core::VertexId;

/// The shipped liver with 11,520 * 4^levels triangles.
inline TriangleMesh liver(std::size_t levels) {
  TriangleMesh mesh = io::loadMesh(std::filesystem::path(MESHES) / "liver.obj");
  for (std::size_t level = 0; level < levels; ++level) mesh = test::subdivided(mesh);
  return mesh;
}

/// A round organ-like body with exactly 2 * rows^2 triangles.
inline TriangleMesh roundOrgan(std::size_t rows) {
  Points points;
  std::vector<Corners> triangles;
  const std::size_t columns = rows;
  for (std::size_t i = 0; i <= rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      const double polar = M_PI * (static_cast<double>(i) + 0.5) / static_cast<double>(rows + 1);
      const double around = 2.0 * M_PI * static_cast<double>(j) / static_cast<double>(columns);
      const double radius = 0.1 * (1.0 + 0.3 * std::sin(3.0 * polar) * std::cos(2.0 * around) +
                                   0.05 * std::sin(9.0 * polar + 5.0 * around));
      points.emplace_back(1.3 * radius * std::sin(polar) * std::cos(around),
                          0.8 * radius * std::sin(polar) * std::sin(around),
                          0.5 * radius * std::cos(polar));
    }
  }
  const auto vertex = [&](std::size_t i, std::size_t j) {
    return static_cast<VertexId>(i * columns + j % columns);
  };
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  return {points, triangles};
}

}  // namespace organ_collision::bench
