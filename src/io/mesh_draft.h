#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::io {

/// A mesh while it is being read: its numbers are the file's.
struct MeshDraft {
  core::Points positions;
  std::vector<core::Corners> triangles;
};

/// Throws std::invalid_argument with the vertex's number if a coordinate is not finite or exceeds a
/// 32-bit float.
void addVertex(MeshDraft& draft, const Eigen::Vector3d& position);

/// The vertex that face `face` names by `number`. Throws std::invalid_argument unless it is one of
/// `count`.
core::VertexId vertexOf(std::int64_t face, double number, std::int64_t count);

/// Adds the fan of triangles from the first corner. Throws std::invalid_argument if there are fewer
/// than three corners.
void addPolygon(MeshDraft& draft, const std::vector<core::VertexId>& corners);

}  // namespace organ_collision::io
