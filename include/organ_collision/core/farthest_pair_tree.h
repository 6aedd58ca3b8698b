#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "organ_collision/core/box.h"
#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::core {

/// The paper's binary hierarchy: a set of triangles, each stood for by its centroid, is split by
/// its two farthest members, the poles; who is nearer to the first pole goes with it, all others
/// (ties too) with the second. Fixed where the paper is silent, so that renumbering the triangles
/// changes nothing: the first pole is the lexicographically smaller; of pairs that tie the
/// lexicographically smallest is taken; a set whose centroids coincide is ordered by its triangles'
/// sorted corners and split in halves. Beyond the paper, every set has a box that contains its
/// triangles, for the exact search. Invariants: every triangle is in exactly one leaf; a child's
/// box lies in its parent's; children come after parents. Source: Muñoz, Diaz León, Trefftz,
/// "Development of a hierarchy collision detection algorithm in order to implement a laparoscopic
/// surgical simulator", Quid 19 (2012).
class FarthestPairTree {
 public:
  /// Position of a triangle in the order of the leaves, which does not depend on the triangles'
  /// numbers.
  using Leaf = std::uint32_t;

  /// A subset: another node, or a single triangle.
  class Child {
   public:
    static Child node(std::size_t node) { return Child(static_cast<std::uint32_t>(node)); }
    static Child leaf(Leaf leaf) { return Child(leaf | kLeafBit); }
    bool isLeaf() const { return (bits_ & kLeafBit) != 0; }
    std::size_t node() const { return bits_; }
    Leaf leaf() const { return bits_ & ~kLeafBit; }

   private:
    static constexpr std::uint32_t kLeafBit = 0x80000000U;
    explicit Child(std::uint32_t bits) : bits_(bits) {}
    std::uint32_t bits_;
  };

  /// A set of two or more triangles, split by its poles.
  struct Node {
    std::array<Eigen::Vector3d, 2> poles;      ///< [m] centroids of the pole triangles
    std::array<TriangleId, 2> pole_triangles;  ///< they move with the mesh
    std::array<Child, 2> children;
  };

  /// O(n log n) for organs: see farthestPair().
  explicit FarthestPairTree(const TriangleMesh& mesh);

  /// Takes over the positions of `mesh`, which must have the topology that the tree was built from:
  /// boxes and poles move, the splits stay. O(n). Source: G. van den Bergen, "Efficient collision
  /// detection of complex deformable models using AABB trees" (1997).
  void refit(const TriangleMesh& mesh);

  /// The whole set.
  Child root() const { return nodes_.empty() ? Child::leaf(0) : Child::node(0); }
  const Node& node(std::size_t i) const { return nodes_[i]; }
  const Box& box(std::size_t i) const { return boxes_[i]; }
  TriangleId triangle(Leaf leaf) const { return leaves_[leaf]; }

  /// The child whose pole is nearer to `point` [m]; of equally near ones the second, as when
  /// building.
  static std::size_t nearerChild(const Node& node, const Eigen::Vector3d& point) {
    return squaredLength(point - node.poles[0]) < squaredLength(point - node.poles[1]) ? 0 : 1;
  }

  std::size_t nodeCount() const { return nodes_.size(); }
  std::size_t depth() const { return depth_; }  ///< nodes on the longest path to a leaf
  std::size_t memory() const;                   ///< [bytes]

 private:
  std::vector<Node> nodes_;
  std::vector<Box> boxes_;  // of the nodes
  std::vector<TriangleId> leaves_;
  std::size_t depth_ = 0;
};

}  // namespace organ_collision::core
