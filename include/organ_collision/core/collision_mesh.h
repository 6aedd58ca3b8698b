#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "organ_collision/core/farthest_pair_tree.h"
#include "organ_collision/core/mesh_health.h"
#include "organ_collision/core/mesh_topology.h"
#include "organ_collision/core/triangle_mesh.h"
#include "organ_collision/core/wide_tree.h"

namespace organ_collision::core {

/// The only owner of a mesh with its hierarchy and its topology: they move together. Any threads
/// may ask it at the same time, while none changes it: to go on asking meanwhile, change a copy.
/// One to which another could not be assigned, for want of memory, is fit for nothing but to be
/// assigned to again.
class CollisionMesh {
 public:
  /// Builds the hierarchy. O(n log n) for organs; where nearly all centroids lie on one sphere,
  /// O(n^1.5); more where farthestPair() takes more. Triangles whose sizes span many powers of two
  /// make it as many levels deeper.
  explicit CollisionMesh(TriangleMesh mesh);

  const TriangleMesh& mesh() const { return mesh_; }
  const MeshTopology& topology() const { return *topology_; }
  const FarthestPairTree& tree() const { return tree_; }
  const WideTree& wideTree() const { return wide_tree_; }
  const MeshHealth& health() const { return health_; }

  /// Whether what was welded when the topology was made still is: no refit has torn it.
  bool holdsTogether() const { return parted_corners_ == 0; }

  /// Closed, and so flat that rounding may have made all of its volume: faces of both sides are
  /// equally near then, and no normal tells which is the outer one.
  bool isPerhapsFlat() const;

  /// Whether the pseudonormals of a triangle tell inside from outside, of a surface that does not
  /// cross itself: those of all if it is one piece; of what touches itself, those of the piece that
  /// is outermost, where nothing else touches that.
  bool tellsSide(TriangleId triangle) const {
    return topology_->isOnePiece() || (outermost_ && outermost_->inverted == health_.inverted &&
                                       topology_->isOf(outermost_->piece, mesh_.corners(triangle)));
  }

  /// Moves all vertices [m] and the hierarchy's bounds with them; the splits stay. O(n). Throws
  /// std::invalid_argument and changes nothing if the positions do not fit the mesh (see
  /// TriangleMesh::setPositions()). After std::bad_alloc, also of the other refit, it must be
  /// refitted again, by either, before it is asked.
  void refit(Points positions);

  /// The same for some vertices: only what hangs on them is touched, the bounds above it and what
  /// they add to the health. `positions` [m] are those of `moved`, in its order; of a vertex that
  /// is there twice the last counts. O(k log n) for k vertices; O(n) where they leave the unit
  /// frame, where one of them was on a face of the mesh's box that none of them reaches any more,
  /// for surfaces of pieces that touch or that are perhaps flat, and after a refit that failed.
  void refit(const std::vector<VertexId>& moved, const Points& positions);

  /// Splits anew for the positions as they are, or throws std::bad_alloc and changes nothing. Costs
  /// what it costs to build.
  void rebuild();

  std::size_t memory() const;  ///< [bytes] of mesh, hierarchy and topology

  /// Numbers that only copies have in common, never 0: of the splits, another one after rebuild(),
  /// and of the positions, another one after refit().
  std::uint64_t splitsNumber() const { return splits_number_; }
  std::uint64_t positionsNumber() const { return positions_number_; }

 private:
  struct Parts;

  explicit CollisionMesh(Parts parts);

  std::vector<TriangleId> trianglesAt(const std::vector<VertexId>& vertices) const;
  void refitAll(const Box& box);
  void refitSome(const std::vector<VertexId>& moved, const Points& positions);
  void updateHealth(const Box& box);

  TriangleMesh mesh_;
  // The same for every copy: refitting changes positions only.
  std::shared_ptr<const MeshTopology> topology_;
  FarthestPairTree tree_;
  WideTree wide_tree_;
  std::size_t parted_corners_ = 0;
  MeshHealth health_;
  std::optional<MeshTopology::Outermost> outermost_;
  bool is_half_refitted_ = false;  // the last refit threw
  std::uint64_t splits_number_, positions_number_;
};

}  // namespace organ_collision::core
