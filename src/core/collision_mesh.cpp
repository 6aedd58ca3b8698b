#include "organ_collision/core/collision_mesh.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

#include "core/for_each.h"

namespace organ_collision::core {
namespace {

/// A unit frame fits what stays within this,
constexpr double kLargestUnit = 1.0;
/// and reaches this far: of less, single precision would tell little.
constexpr double kSmallestReach = 0x1p-10;

bool fits(const Box& box, const UnitFrame& frame) {
  return largestCoordinate(frame(box.low)) <= kLargestUnit &&
         largestCoordinate(frame(box.high)) <= kLargestUnit &&
         0.5 * frame.scale * (box.high - box.low).maxCoeff() >= kSmallestReach;
}

/// Whether there is a face of `box` that some of what has moved was on, and that none of it reaches
/// now.
bool leavesFace(const Box& before, const Box& after, const Box& box) {
  return ((before.low.array() <= box.low.array() && after.low.array() > box.low.array()) ||
          (before.high.array() >= box.high.array() && after.high.array() < box.high.array()))
      .any();
}

/// Another one each time.
std::uint64_t freshNumber() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

/// What needs the mesh alone, made side by side.
struct CollisionMesh::Parts {
  explicit Parts(TriangleMesh whole) : mesh(std::move(whole)), box(boxOf(mesh)) {
    sideBySide([this] { topology = std::make_shared<const MeshTopology>(mesh); },
               [this] { tree.emplace(mesh); });
  }

  TriangleMesh mesh;
  Box box;
  std::shared_ptr<const MeshTopology> topology;
  std::optional<FarthestPairTree> tree;
};

CollisionMesh::CollisionMesh(TriangleMesh mesh) : CollisionMesh(Parts(std::move(mesh))) {}

CollisionMesh::CollisionMesh(Parts parts)
    : mesh_(std::move(parts.mesh)),
      topology_(std::move(parts.topology)),
      tree_(std::move(*parts.tree)),
      wide_tree_(tree_, mesh_, unitFrame(parts.box)),
      health_(),
      splits_number_(freshNumber()),
      positions_number_(freshNumber()) {
  updateHealth(parts.box);
}

void CollisionMesh::refitAll(const Box& box) {
  wide_tree_.refit(mesh_, unitFrame(box));
  parted_corners_ = partedCorners(mesh_, *topology_);
  updateHealth(box);
}

void CollisionMesh::refit(Points positions) {
  const Box box = mesh_.setPositions(std::move(positions));
  is_half_refitted_ = true;
  positions_number_ = freshNumber();
  refitAll(mesh_.usesAllVertices() ? box : boxOf(mesh_));
  is_half_refitted_ = false;
}

/// Those at vertices, each as often as it has welds there.
std::vector<TriangleId> CollisionMesh::trianglesAt(const std::vector<VertexId>& vertices) const {
  // All of their welds: whether these hold matters to each triangle.
  std::vector<MeshTopology::Weld> welds(vertices.size());
  std::transform(vertices.begin(), vertices.end(), welds.begin(),
                 [this](VertexId vertex) { return topology_->weld(vertex); });
  if (topology_->hasWelds()) {
    std::sort(welds.begin(), welds.end());
    welds.erase(std::unique(welds.begin(), welds.end()), welds.end());
  }
  std::vector<TriangleId> triangles;
  triangles.reserve(8 * welds.size());
  for (const MeshTopology::Weld weld : welds) {
    const auto around = topology_->trianglesAt(weld);
    triangles.insert(triangles.end(), around.begin(), around.end());
  }
  return triangles;
}

bool CollisionMesh::isPerhapsFlat() const {
  const HealthTally& tally = wide_tree_.tally();
  return topology_->closed() && topology_->consistentlyWound() &&
         std::abs(tally.volume) <= tally.rounding;
}

void CollisionMesh::updateHealth(const Box& box) {
  HealthTally tally = wide_tree_.tally();
  if (isPerhapsFlat()) tally.volume = volumeOf(mesh_, wide_tree_.frame());
  health_ = healthOf(*topology_, box, tally, parted_corners_);
  outermost_ = topology_->outermost(mesh_);
}

void CollisionMesh::refit(const std::vector<VertexId>& moved, const Points& positions) {
  mesh_.requireFitting(moved, positions);
  if (!std::exchange(is_half_refitted_, true)) {
    refitSome(moved, positions);
  } else {
    mesh_.move(moved, positions);
    positions_number_ = freshNumber();
    refitAll(boxOf(mesh_));
  }
  is_half_refitted_ = false;
}

void CollisionMesh::refitSome(const std::vector<VertexId>& moved, const Points& positions) {
  std::vector<TriangleId> touched = trianglesAt(moved);
  if (topology_->hasWelds()) {
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    parted_corners_ -= partedCorners(touched, mesh_, *topology_);
  }
  const auto box_of_moved = [&] {
    Box box;
    for (const VertexId vertex : moved) box.add(mesh_.position(vertex));
    return box;
  };
  const Box before = box_of_moved();
  mesh_.move(moved, positions);
  positions_number_ = freshNumber();
  // Of vertices without a triangle, none reaches a face.
  const Box after = mesh_.usesAllVertices() ? box_of_moved() : Box();
  if (topology_->hasWelds()) parted_corners_ += partedCorners(touched, mesh_, *topology_);

  Box box = leavesFace(before, after, health_.box) ? boxOf(mesh_) : health_.box;
  if (mesh_.usesAllVertices()) {
    box.add(after);
  } else {
    for (const TriangleId triangle : touched) box.add(boxOf(mesh_.triangle(triangle)));
  }
  if (!fits(box, wide_tree_.frame())) {
    refitAll(box);
    return;
  }
  wide_tree_.refit(mesh_, touched);
  updateHealth(box);
}

void CollisionMesh::rebuild() {
  FarthestPairTree tree(mesh_);
  wide_tree_ = WideTree(tree, mesh_, unitFrame(health_.box));
  tree_ = std::move(tree);
  splits_number_ = freshNumber();
}

std::size_t CollisionMesh::memory() const {
  return mesh_.positions().capacity() * sizeof(Eigen::Vector3d) +
         mesh_.triangles().capacity() * sizeof(Corners) + topology_->memory() + tree_.memory() +
         wide_tree_.memory();
}

}  // namespace organ_collision::core
