#include "organ_collision/core/collision_mesh.h"

#include <utility>

namespace organ_collision::core {

CollisionMesh::CollisionMesh(TriangleMesh mesh)
    : mesh_(std::move(mesh)),
      topology_(std::make_shared<const MeshTopology>(mesh_)),
      tree_(mesh_),
      health_(inspect(mesh_, *topology_)) {}

void CollisionMesh::refit(Points positions) {
  mesh_.setPositions(std::move(positions));
  tree_.refit(mesh_);
  health_ = inspect(mesh_, *topology_);
}

std::size_t CollisionMesh::memory() const {
  return mesh_.positions().capacity() * sizeof(Eigen::Vector3d) +
         mesh_.triangles().capacity() * sizeof(Corners) + topology_->memory() + tree_.memory();
}

}  // namespace organ_collision::core
