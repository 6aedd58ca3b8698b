#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::io {

/// A mesh while it is being read: its numbers are the file's.
struct MeshDraft {
  /// Of four corners or more; meanwhile a fan from the first one.
  struct Polygon {
    std::size_t first_triangle, corner_count;
  };

  core::Points positions;
  std::vector<core::Corners> triangles;
  std::vector<Polygon> polygons;
};

/// Throws std::invalid_argument with the vertex's number if a coordinate is not finite or exceeds a
/// 32-bit float.
void addVertex(MeshDraft& draft, const Eigen::Vector3d& position);

/// The vertex that face `face` names by `number`. Throws std::invalid_argument unless it is one of
/// `count`.
core::VertexId vertexOf(std::int64_t face, double number, std::int64_t count);

/// Throws std::invalid_argument if there are fewer than three corners.
void addPolygon(MeshDraft& draft, const std::vector<core::VertexId>& corners);

/// The mesh when all is read. Each polygon is a fan from its first corner or, where that would
/// leave it, as from some corners of those that are not convex, from the next that fills it. Throws
/// std::invalid_argument naming the triangles of one that no fan fills.
core::TriangleMesh meshOf(MeshDraft draft);

}  // namespace organ_collision::io
