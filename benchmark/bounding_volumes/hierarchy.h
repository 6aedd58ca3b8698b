#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "organ_collision/core/collision_mesh.h"

namespace organ_collision::bench {

/// Triangles that stay together, and the parts that they are split into.
struct Set {
  std::size_t first, count;              ///< triangles, in the hierarchy's order
  std::size_t first_child, child_count;  ///< no children: a single triangle
  Eigen::Vector3d pole, other_pole;      ///< [m] its own, and that of the part it was split from
};

/// The farthest-pair hierarchy, so that each split has up to `width` parts: 2 is the tree itself.
/// Set 0 has all triangles; a set's children follow one another and come after it.
class Hierarchy {
 public:
  Hierarchy(const core::CollisionMesh& organ, std::size_t width);

  const std::vector<Set>& sets() const { return sets_; }
  const core::Triangle& triangle(const Set& set) const { return triangles_[set.first]; }
  /// The corners [m] of all its triangles, in columns.
  auto corners(const Set& set) const { return corners_.middleCols(3 * set.first, 3 * set.count); }

 private:
  std::vector<Set> sets_;
  std::vector<core::Triangle> triangles_;
  Eigen::Matrix3Xd corners_;
};

namespace detail {

using Child = core::FarthestPairTree::Child;

/// A set that has not found its children yet.
struct Part {
  Child child;
  Eigen::Vector3d pole, other_pole;
};

/// The first leaf below each node, and one past the last.
struct Leaves {
  explicit Leaves(const core::FarthestPairTree& tree) : begin(tree.nodeCount()), end(begin) {
    for (std::size_t i = begin.size(); i-- > 0;) {
      begin[i] = beginOf(tree.node(i).children[0]);
      end[i] = endOf(tree.node(i).children[1]);
    }
  }
  std::size_t beginOf(Child child) const {
    return child.isLeaf() ? child.leaf() : begin[child.node()];
  }
  std::size_t endOf(Child child) const {
    return child.isLeaf() ? child.leaf() + 1 : end[child.node()];
  }
  std::size_t count(Child child) const { return endOf(child) - beginOf(child); }

  std::vector<std::size_t> begin, end;
};

/// Splits the largest part again and again, until there are `width`.
inline std::vector<Part> split(const core::FarthestPairTree& tree, const Leaves& leaves,
                               const Part& whole, std::size_t width) {
  std::vector<Part> parts = {whole};
  while (parts.size() < width) {
    const auto largest = std::max_element(parts.begin(), parts.end(), [&](auto& a, auto& b) {
      return leaves.count(a.child) < leaves.count(b.child);
    });
    if (largest->child.isLeaf()) break;
    const auto& node = tree.node(largest->child.node());
    *largest = {node.children[0], node.poles[0], node.poles[1]};
    parts.push_back({node.children[1], node.poles[1], node.poles[0]});
  }
  return parts;
}

}  // namespace detail

inline Hierarchy::Hierarchy(const core::CollisionMesh& organ, std::size_t width)
    : triangles_(organ.mesh().triangleCount()), corners_(3, 3 * triangles_.size()) {
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const auto leaf = static_cast<core::FarthestPairTree::Leaf>(i);
    triangles_[i] = organ.mesh().triangle(organ.tree().triangle(leaf));
    corners_.middleCols<3>(3 * i) << triangles_[i].a, triangles_[i].b, triangles_[i].c;
  }
  const detail::Leaves leaves(organ.tree());
  std::vector<detail::Part> parts;
  const auto add = [&](const detail::Part& part) {
    parts.push_back(part);
    sets_.push_back(
        {leaves.beginOf(part.child), leaves.count(part.child), 0, 0, part.pole, part.other_pole});
  };
  const Eigen::Vector3d nowhere = Eigen::Vector3d::Zero();  // the root is nobody's part
  add({organ.tree().root(), nowhere, nowhere});
  for (std::size_t i = 0; i < sets_.size(); ++i) {
    if (parts[i].child.isLeaf()) continue;
    const auto children = detail::split(organ.tree(), leaves, parts[i], width);
    sets_[i].first_child = sets_.size();
    sets_[i].child_count = children.size();
    for (const detail::Part& child : children) add(child);
  }
}

}  // namespace organ_collision::bench
