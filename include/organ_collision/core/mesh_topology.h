#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::core {

/// Which triangles meet where: vertices at exactly the same position when this is made are welded,
/// whatever their numbers. What moves apart later stays welded, what falls together later is not:
/// welds change with the topology only.
class MeshTopology {
 public:
  /// Vertices welded into one.
  using Weld = std::uint32_t;
  struct TriangleRange {
    const TriangleId *first, *last;
    const TriangleId* begin() const { return first; }
    const TriangleId* end() const { return last; }
  };

  /// O(n), but where very many triangles meet.
  explicit MeshTopology(const TriangleMesh& mesh);

  Weld weld(VertexId vertex) const {
    return hasWelds() ? welds_[index(vertex)] : static_cast<Weld>(index(vertex));
  }
  TriangleRange trianglesAt(Weld weld) const {
    return {triangles_at_.data() + offsets_[weld], triangles_at_.data() + offsets_[weld + 1]};
  }

  /// Some vertices were at the same position.
  bool hasWelds() const { return !welds_.empty(); }
  /// Every edge has an even number of triangles.
  bool closed() const { return closed_; }
  /// Neighbours run along their edge in opposite senses.
  bool consistentlyWound() const { return consistently_wound_; }
  /// It is closed and consistently wound, and all of it hangs together across edges of two
  /// triangles each, rather than by touching itself at vertices or edges.
  bool isOnePiece() const { return one_piece_; }
  /// Of a surface that is several pieces which touch, the one that is outermost, and whether that
  /// is inverted.
  struct Outermost {
    std::uint32_t piece;
    bool inverted;
  };
  /// Where the vertices are now; nothing where that is not clear, or there are no such pieces. O(n)
  /// if there are.
  std::optional<Outermost> outermost(const TriangleMesh& mesh) const;
  /// Whether all that meets the triangle with these corners is of that piece.
  bool isOf(std::uint32_t piece, const Corners& corners) const;
  /// A vertex of each part of the surface that hangs together. Vertices without a triangle aside.
  const std::vector<VertexId>& parts() const { return parts_; }
  /// With the same corners as an earlier one.
  std::size_t duplicateTriangles() const { return duplicate_triangles_; }

  /// Whether a vertex is where the first of its weld is.
  bool isAtWeld(VertexId vertex, const TriangleMesh& mesh) const {
    return !hasWelds() || mesh.position(vertex) == mesh.position(representatives_[weld(vertex)]);
  }

  std::size_t memory() const;  ///< [bytes]

 private:
  using ClosedFans = std::vector<std::uint8_t>;  // whether the triangles around each weld are one
  struct Findings;
  class Inspector;
  class Joiner;

  void weldVertices(const TriangleMesh& mesh);
  void listTriangles(const TriangleMesh& mesh);
  ClosedFans inspect(const TriangleMesh& mesh);
  void listParts(const TriangleMesh& mesh, const ClosedFans& closed_fans);
  bool isOf(std::uint32_t piece, Weld weld) const;

  std::vector<Weld> welds_;                // of each vertex; none if each has its own
  std::vector<VertexId> representatives_;  // of each weld: its first vertex
  std::vector<std::uint32_t> offsets_;     // of each weld into triangles_at_, one more at the end
  std::vector<TriangleId> triangles_at_;
  std::vector<VertexId> parts_;
  bool closed_ = true;
  bool consistently_wound_ = true;
  bool one_piece_ = false;
  std::vector<std::uint32_t> pieces_;  // of each triangle, where several pieces touch; else none
  std::size_t duplicate_triangles_ = 0;
};

}  // namespace organ_collision::core
