#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <vector>

#include "organ_collision/core/closest_point.h"
#include "organ_collision/core/collision_mesh.h"

namespace organ_collision::bench {

/// Triangles that stay together, and the parts that they are split into.
struct Set {
  core::FarthestPairTree::Set source;
  Eigen::Vector3d pole, other_pole;              ///< [m] its own, and that it was split from
  std::size_t first_child = 0, child_count = 0;  ///< no children: a single triangle
  std::size_t first = 0, count = 1;              ///< triangles, in the order of the leaves
};

/// The farthest-pair hierarchy, with up to `width` children in a set: 2 is the tree itself. Set 0
/// has all triangles; a set's children follow one another and come after it.
class Hierarchy {
 public:
  Hierarchy(const core::CollisionMesh& organ, std::size_t width) {
    const core::FarthestPairTree& tree = organ.tree();
    for (std::size_t i = 0; i < organ.mesh().triangleCount(); ++i)
      triangles_.push_back(organ.mesh().triangle(tree.triangle(static_cast<Leaf>(i))));
    sets_.push_back({tree.root(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
    for (std::size_t i = 0; i < sets_.size(); ++i) {
      if (sets_[i].source.isLeaf()) continue;
      const std::vector<Set> children = split(tree, sets_[i], width);
      sets_[i].first_child = sets_.size();
      sets_[i].child_count = children.size();
      sets_.insert(sets_.end(), children.begin(), children.end());
    }
    for (auto set = sets_.rbegin(); set != sets_.rend(); ++set) countTriangles(*set);
  }

  const std::vector<Set>& sets() const { return sets_; }
  const core::Triangle& triangle(const Set& leaf) const { return triangles_[leaf.first]; }

  /// The corners [m] of all triangles of a set, in columns.
  Eigen::Matrix3Xd corners(const Set& set) const {
    Eigen::Matrix3Xd corners(3, 3 * set.count);
    for (std::size_t i = 0; i < set.count; ++i) {
      const core::Triangle& triangle = triangles_[set.first + i];
      corners.middleCols<3>(3 * i) << triangle.a, triangle.b, triangle.c;
    }
    return corners;
  }

 private:
  using Leaf = core::FarthestPairTree::Leaf;

  /// Splits the part with the largest box again and again, until there are `width`.
  std::vector<Set> split(const core::FarthestPairTree& tree, const Set& whole,
                         std::size_t width) const {
    const auto size = [&](const Set& part) {
      if (part.source.isLeaf()) return -1.0;
      core::Box box;
      for (Leaf leaf = part.source.begin; leaf < part.source.end; ++leaf)
        box.add(core::boxOf(triangles_[leaf]));
      return (box.high - box.low).squaredNorm();
    };
    std::vector<Set> parts = {whole};
    while (parts.size() < width) {
      const auto largest = std::max_element(parts.begin(), parts.end(),
                                            [&](auto& a, auto& b) { return size(a) < size(b); });
      if (largest->source.isLeaf()) break;
      const auto [first, second] = tree.children(largest->source);
      const auto [first_pole, second_pole] = tree.poles(largest->source);
      const auto pole = [&](Leaf leaf) { return core::centroid(triangles_[leaf]); };
      *largest = {first, pole(first_pole), pole(second_pole)};
      parts.push_back({second, pole(second_pole), pole(first_pole)});
    }
    return parts;
  }

  void countTriangles(Set& set) const {
    if (set.child_count == 0) {
      set.first = set.source.begin;
      return;
    }
    const auto children = sets_.begin() + static_cast<std::ptrdiff_t>(set.first_child);
    set.first = children->first;
    set.count = 0;
    for (std::size_t i = 0; i < set.child_count; ++i) set.count += children[i].count;
  }

  std::vector<Set> sets_;
  std::vector<core::Triangle> triangles_;
};

/// An exact answer and what it cost.
struct Answer {
  double squared_distance = std::numeric_limits<double>::infinity();  ///< [m^2]
  std::size_t bounds = 0, triangles = 0;                              ///< measured
  std::size_t opened = 0;  ///< sets whose children were looked at
};

/// Always opens the set whose bound is least, until no set left can hold a nearer triangle: no
/// search with the same bounds opens fewer.
template <class Volumes, class Tip>
class BestFirst {
 public:
  explicit BestFirst(const Hierarchy& hierarchy) : hierarchy_(hierarchy), volumes_(hierarchy) {}

  Answer nearest(const Tip& tip) {
    Answer answer;
    queue_ = {{0.0, 0}};
    while (!queue_.empty() && queue_.front().bound <= answer.squared_distance) {
      std::pop_heap(queue_.begin(), queue_.end());
      const Entry entry = queue_.back();
      queue_.pop_back();
      const Set& set = hierarchy_.sets()[entry.set];
      if (set.child_count == 0) {
        ++answer.triangles;
        const auto closest = core::closestPointOnTriangle(tip.point, hierarchy_.triangle(set));
        answer.squared_distance = std::min(answer.squared_distance, closest.squared_distance);
        continue;
      }
      ++answer.opened;
      answer.bounds += set.child_count;
      const auto& seen = volumes_.seenFrom(entry.set, tip);
      for (std::size_t i = set.first_child; i < set.first_child + set.child_count; ++i) {
        const double bound = std::max(entry.bound, volumes_.bound(seen, i));  // also its parent's
        if (bound > answer.squared_distance) continue;
        queue_.push_back({bound, i});
        std::push_heap(queue_.begin(), queue_.end());
      }
    }
    return answer;
  }

 private:
  struct Entry {
    double bound;  // [m^2]
    std::size_t set;
    bool operator<(const Entry& other) const { return bound > other.bound; }
  };

  const Hierarchy& hierarchy_;
  Volumes volumes_;
  std::vector<Entry> queue_;  // a heap
};

}  // namespace organ_collision::bench
