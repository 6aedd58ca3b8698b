#pragma once

#include <Eigen/Core>
#include <vector>

#include "organ_collision/core/box.h"
#include "organ_collision/core/ids.h"
#include "organ_collision/core/triangle.h"

namespace organ_collision::core {

/// Positions and queries must stay below this in every coordinate [m]: their squares do not
/// overflow.
constexpr double kLargestCoordinate = 1e150;

/// All coordinates are finite and of a magnitude below kLargestCoordinate.
inline bool isUsable(const Eigen::Vector3d& position) {
  return (position.array().abs() < kLargestCoordinate).all();
}
/// Throws std::invalid_argument naming `what`, its `number` and the position.
[[noreturn]] void refuseUnusable(const Eigen::Vector3d& position, const char* what,
                                 std::size_t number);
/// The same, unless the position is usable; every query asks that.
inline void requireUsable(const Eigen::Vector3d& position, const char* what, std::size_t number) {
  if (!isUsable(position)) refuseUnusable(position, what, number);
}
/// The same of each corner of a tip.
inline void requireUsable(const Triangle& tip) {
  for (const Eigen::Vector3d* corner : {&tip.a, &tip.b, &tip.c}) requireUsable(*corner, "tip", 0);
}

/// Triangles over shared vertices, numbered as in the file that they came from.
/// Invariants: 1 to 2^27 triangles, as many vertices at most; every corner names a vertex; every
/// position is finite and below kLargestCoordinate. Zero-area and duplicate triangles are allowed:
/// indices must hold.
class TriangleMesh {
 public:
  /// `positions` [m]. Throws std::invalid_argument naming the offending element.
  TriangleMesh(Points positions, std::vector<Corners> triangles);

  const Points& positions() const { return positions_; }
  const std::vector<Corners>& triangles() const { return triangles_; }
  std::size_t triangleCount() const { return triangles_.size(); }
  /// Every vertex is a corner of a triangle.
  bool usesAllVertices() const { return uses_all_vertices_; }

  const Eigen::Vector3d& position(VertexId id) const { return positions_[index(id)]; }
  const Corners& corners(TriangleId id) const { return triangles_[index(id)]; }
  Triangle triangle(const Corners& corners) const {
    return {position(corners[0]), position(corners[1]), position(corners[2])};
  }
  Triangle triangle(TriangleId id) const { return triangle(corners(id)); }

  /// Moves all vertices [m]; returns their box. Throws std::invalid_argument and leaves the mesh as
  /// it was if the count differs or a position is not usable.
  Box setPositions(Points positions);
  /// Throws std::invalid_argument if the counts differ, a vertex is not there or a position is not
  /// usable.
  void requireFitting(const std::vector<VertexId>& moved, const Points& positions) const;
  /// Moves those of `moved` to `positions` [m], in its order. REQUIRES: requireFitting() lets them
  /// pass.
  void move(const std::vector<VertexId>& moved, const Points& positions);

 private:
  Points positions_;
  std::vector<Corners> triangles_;
  bool uses_all_vertices_;
};

/// The centroid (P1+P2+P3)/3 [m] that stands for a triangle (Muñoz et al. 2012), the same bits for
/// every order of the corners.
Eigen::Vector3d centroid(const Triangle& triangle);

}  // namespace organ_collision::core
