#pragma once

#include <cstddef>
#include <cstdint>
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

  /// O(n), but where very many triangles meet; on all cores.
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
  /// Whether the pseudonormals of a triangle tell inside from outside, of a surface that does not
  /// cross itself and is inverted or not: those of all if it is one piece; of what touches itself,
  /// those of the piece that is outermost, where nothing else touches that.
  bool tellsSide(TriangleId triangle, bool inverted) const {
    return one_piece_ ||
           (!outermost_.empty() && outermost_[index(triangle)] && inverted == outermost_inverted_);
  }
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
  struct Findings;
  class Inspector;

  void weldVertices(const TriangleMesh& mesh);
  void listTriangles(const TriangleMesh& mesh);
  void listParts(const TriangleMesh& mesh);
  void inspect(const TriangleMesh& mesh);
  void findOutermost(const TriangleMesh& mesh);
  std::vector<std::uint32_t> pieces(const TriangleMesh& mesh) const;

  std::vector<Weld> welds_;                // of each vertex; none if each has its own
  std::vector<VertexId> representatives_;  // of each weld: its first vertex
  std::vector<std::uint32_t> offsets_;     // of each weld into triangles_at_, one more at the end
  std::vector<TriangleId> triangles_at_;
  std::vector<VertexId> parts_;
  bool closed_ = true;
  bool consistently_wound_ = true;
  bool one_piece_ = false;
  std::vector<bool> outermost_;  // triangles; none if that is not known, or it is one piece
  bool outermost_inverted_ = false;
  std::size_t duplicate_triangles_ = 0;
};

}  // namespace organ_collision::core
