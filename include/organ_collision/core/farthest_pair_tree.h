#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "organ_collision/core/huge_pages.h"
#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::core {

/// The paper's binary hierarchy: a set of triangles, each stood for by its centroid, is split by
/// its two farthest members, the poles; who is nearer to the first pole goes with it, all others
/// (ties too) with the second. Fixed where the paper is silent, so that renumbering the triangles
/// changes nothing: the first pole is the lexicographically smaller; of pairs that tie the
/// lexicographically smallest is taken; a set whose centroids coincide is ordered by its triangles'
/// sorted corners and split in halves. Source: Muñoz, Diaz León, Trefftz, "Development of a
/// hierarchy collision detection algorithm in order to implement a laparoscopic surgical
/// simulator", Quid 19 (2012).
class FarthestPairTree {
 public:
  /// Position of a triangle in the order of the leaves, which does not depend on the triangles'
  /// numbers.
  using Leaf = std::uint32_t;

  /// The leaves [begin, end), which stay together; `node` splits them if they are more than one.
  struct Set {
    Leaf begin, end;
    std::uint32_t node;
    bool isLeaf() const { return end - begin == 1; }
    std::uint32_t size() const { return end - begin; }
  };

  /// O(n log n) for organs (see farthestPair()), on all cores.
  explicit FarthestPairTree(const TriangleMesh& mesh);

  Set root() const { return {0, static_cast<Leaf>(leaves_.size()), 0}; }
  /// REQUIRES: not a leaf.
  std::array<Set, 2> children(const Set& set) const {
    // A set of m leaves has m - 1 nodes; they follow its own, the first child's before the other's.
    const std::uint32_t first_size = nodes_[set.node].first_size;
    return {Set{set.begin, set.begin + first_size, set.node + 1},
            Set{set.begin + first_size, set.end, set.node + first_size}};
  }
  /// The poles of a set, as leaves. REQUIRES: not a leaf.
  const std::array<Leaf, 2>& poles(const Set& set) const { return nodes_[set.node].poles; }
  TriangleId triangle(Leaf leaf) const { return leaves_[leaf]; }

  std::size_t depth() const { return depth_; }  ///< nodes on the longest path to a leaf
  std::size_t memory() const;                   ///< [bytes]

 private:
  struct Node {
    std::array<Leaf, 2> poles;
    std::uint32_t first_size;  // leaves of the first child
  };

  class Builder;

  HugePageVector<Node> nodes_;
  std::vector<TriangleId> leaves_;
  std::size_t depth_ = 0;
};

}  // namespace organ_collision::core
