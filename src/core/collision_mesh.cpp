#include "organ_collision/core/collision_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace organ_collision::core {
namespace {

/// Beyond this the unit frame does not fit any more.
constexpr double kLargestUnit = 2.0;

bool fits(const Box& box, const UnitFrame& frame) {
  return frame(box.low).cwiseAbs().maxCoeff() <= kLargestUnit &&
         frame(box.high).cwiseAbs().maxCoeff() <= kLargestUnit;
}

bool isOnFace(const Eigen::Vector3d& point, const Box& box) {
  return (point.array() == box.low.array() || point.array() == box.high.array()).any();
}

}  // namespace

CollisionMesh::CollisionMesh(TriangleMesh mesh)
    : mesh_(std::move(mesh)),
      topology_(std::make_shared<const MeshTopology>(mesh_)),
      frame_(unitFrame(boxOf(mesh_))),
      tally_(core::tallyOf(mesh_, *topology_, frame_)),
      health_(healthOf(*topology_, boxOf(mesh_), tally_)),
      tree_(mesh_, frame_),
      wide_tree_(tree_, mesh_, frame_) {}

void CollisionMesh::refitAll() {
  const Box box = boxOf(mesh_);
  frame_ = unitFrame(box);
  tree_.refit(mesh_, frame_);
  tally_ = wide_tree_.refit(tree_, mesh_, frame_);
  tally_.parted_corners = partedCorners(mesh_, *topology_);
  health_ = healthOf(*topology_, box, tally_);
}

void CollisionMesh::refit(Points positions) {
  mesh_.setPositions(std::move(positions));
  refitAll();
}

HealthTally CollisionMesh::tallyOf(const std::vector<TriangleId>& triangles) const {
  HealthTally tally;
  for (const TriangleId triangle : triangles)
    tally.add(core::tallyOf(triangle, mesh_, *topology_, frame_));
  return tally;
}

std::vector<TriangleId> CollisionMesh::trianglesAt(const std::vector<VertexId>& vertices) const {
  std::vector<TriangleId> triangles;
  for (const VertexId vertex : vertices) {
    // All of the weld: whether it holds matters to each of them.
    const auto around = topology_->trianglesAt(topology_->weld(vertex));
    triangles.insert(triangles.end(), around.begin(), around.end());
  }
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

void CollisionMesh::refit(const std::vector<VertexId>& moved, const Points& positions) {
  mesh_.requireFitting(moved, positions);
  const std::vector<TriangleId> touched = trianglesAt(moved);
  const HealthTally before = tallyOf(touched);
  const bool on_face = std::any_of(moved.begin(), moved.end(), [this](VertexId vertex) {
    return isOnFace(mesh_.position(vertex), health_.box);
  });
  mesh_.setPositions(moved, positions);

  Box box = on_face ? boxOf(mesh_) : health_.box;
  for (const TriangleId triangle : touched) box.add(boxOf(mesh_.triangle(triangle)));
  tally_.remove(before);
  tally_.add(tallyOf(touched));
  const bool volume_is_doubtful = topology_->closed() && topology_->consistentlyWound() &&
                                  std::abs(tally_.volume) <= tally_.rounding;
  if (!fits(box, frame_) || volume_is_doubtful) {
    refitAll();
    return;
  }
  health_ = healthOf(*topology_, box, tally_);
  std::vector<FarthestPairTree::Leaf> leaves;
  leaves.reserve(touched.size());
  for (const TriangleId triangle : touched) leaves.push_back(wide_tree_.leafOf(triangle));
  std::sort(leaves.begin(), leaves.end());
  tree_.refit(mesh_, leaves);
  wide_tree_.refit(tree_, mesh_, leaves);
}

void CollisionMesh::rebuild() {
  tree_ = FarthestPairTree(mesh_, frame_);
  wide_tree_ = WideTree(tree_, mesh_, frame_);
}

std::size_t CollisionMesh::memory() const {
  return mesh_.positions().capacity() * sizeof(Eigen::Vector3d) +
         mesh_.triangles().capacity() * sizeof(Corners) + topology_->memory() + tree_.memory() +
         wide_tree_.memory();
}

}  // namespace organ_collision::core
