#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <unordered_map>

#include "mesh_draft.h"

namespace organ_collision::io {

/// A mesh that is read from a file whose triangles bring their corners' positions: vertices of
/// exactly one position are one, numbered in the order of first appearance.
class WeldedMesh {
 public:
  /// Throws as addVertex() does.
  core::VertexId vertex(const Eigen::Vector3d& position) {
    const core::VertexId next{static_cast<std::uint32_t>(draft_.positions.size())};
    const auto [known, is_new] =
        vertices_.try_emplace({position.x(), position.y(), position.z()}, next);
    if (is_new) addVertex(draft_, position);
    return known->second;
  }
  void addTriangle(const std::vector<core::VertexId>& corners) { addPolygon(draft_, corners); }

  std::size_t triangleCount() const { return draft_.triangles.size(); }
  core::TriangleMesh mesh() && { return meshOf(std::move(draft_)); }

 private:
  using Position = std::array<double, 3>;
  struct Hash {
    std::size_t operator()(const Position& position) const {
      const std::hash<double> hash;  // the same for 0 and -0, which are equal
      std::size_t sum = 0;
      for (const double coordinate : position) sum = sum * 1'000'003 + hash(coordinate);
      return sum;
    }
  };

  MeshDraft draft_;
  std::unordered_map<Position, core::VertexId, Hash> vertices_;
};

}  // namespace organ_collision::io
