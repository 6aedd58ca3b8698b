#pragma once

#include <cstddef>
#include <memory>

#include "organ_collision/core/farthest_pair_tree.h"
#include "organ_collision/core/mesh_health.h"
#include "organ_collision/core/mesh_topology.h"
#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::core {

/// The only owner of a mesh with its hierarchy and its topology: they move together.
class CollisionMesh {
 public:
  /// Builds the hierarchy. O(n log n).
  explicit CollisionMesh(TriangleMesh mesh);

  const TriangleMesh& mesh() const { return mesh_; }
  const MeshTopology& topology() const { return *topology_; }
  const FarthestPairTree& tree() const { return tree_; }
  const MeshHealth& health() const { return health_; }

  /// Moves all vertices [m] and the hierarchy's bounds with them; the splits stay. O(n). Throws
  /// std::invalid_argument and changes nothing if the positions do not fit the mesh (see
  /// TriangleMesh::setPositions()).
  void refit(Points positions);

  /// Splits anew for the positions as they are. O(n log n).
  void rebuild() { tree_ = FarthestPairTree(mesh_); }

  std::size_t memory() const;  ///< [bytes] of mesh, hierarchy and topology

 private:
  TriangleMesh mesh_;
  std::shared_ptr<const MeshTopology>
      topology_;  // the same for every copy: refitting changes positions only
  FarthestPairTree tree_;
  MeshHealth health_;
};

}  // namespace organ_collision::core
