// The paper's search written down plainly, for speed: a binary tree, in each node the plane between
// its poles, all in float, with no proof of anything. Where a tip is as near to both poles but for
// rounding, it may go the other way. Source: Muñoz, Diaz León, Trefftz, Quid 19 (2012),
// algorithm 2.
#include <array>
#include <cmath>
#include <cstdint>

#include "contender.h"
#include "float_closest_point.h"
#include "organ_collision/core/farthest_pair_tree.h"

namespace organ_collision::bench {
namespace {

using core::FarthestPairTree;
using in_float::toFloat;
using in_float::Vector;

class PlainTree {
 public:
  explicit PlainTree(const core::TriangleMesh& mesh)
      : tree_(mesh), nodes_(mesh.triangleCount() - 1), root_(childOf(tree_.root())) {
    const auto pole = [&](FarthestPairTree::Leaf leaf) {
      return core::centroid(mesh.triangle(tree_.triangle(leaf)));
    };
    std::vector<FarthestPairTree::Set> open = {tree_.root()};
    while (!open.empty()) {
      const FarthestPairTree::Set set = open.back();
      open.pop_back();
      if (set.isLeaf()) continue;
      const auto [first, second] = tree_.poles(set);
      const Eigen::Vector3d apart = pole(second) - pole(first);
      const auto children = tree_.children(set);
      nodes_[set.node] = {toFloat(apart),
                          static_cast<float>(0.5 * apart.dot(pole(first) + pole(second))),
                          {childOf(children[0]), childOf(children[1])}};
      open.insert(open.end(), children.begin(), children.end());
    }
  }

  FarthestPairTree::Leaf leafFor(const Vector& tip) const {
    std::int32_t child = root_;
    while (child >= 0) {
      const Node& node = nodes_[static_cast<std::size_t>(child)];
      child = node.children[dot(node.apart, tip) < node.middle ? 0 : 1];
    }
    return static_cast<FarthestPairTree::Leaf>(-1 - child);
  }
  core::TriangleId triangle(FarthestPairTree::Leaf leaf) const { return tree_.triangle(leaf); }

 private:
  struct Node {
    Vector apart;                          // from the first pole to the second
    float middle;                          // along that
    std::array<std::int32_t, 2> children;  // nodes, or leaves below 0
  };

  static std::int32_t childOf(const FarthestPairTree::Set& set) {
    return set.isLeaf() ? -1 - static_cast<std::int32_t>(set.begin)
                        : static_cast<std::int32_t>(set.node);
  }

  FarthestPairTree tree_;
  std::vector<Node> nodes_;
  std::int32_t root_;
};

/// Triangles alone.
class PlainSearch : public Contender {
 public:
  explicit PlainSearch(const core::TriangleMesh& mesh) : mesh_(mesh), tree_(mesh) {}

  void answer(const core::Points& tips, std::vector<double>& /*distances*/) override {
    triangles_.clear();
    for (const Eigen::Vector3d& tip : tips)
      triangles_.push_back(tree_.triangle(tree_.leafFor(toFloat(tip))));
  }
  void measure(const core::Points& tips, std::vector<double>& distances) override {
    measureEach(mesh_, triangles_, tips, distances);
  }

 private:
  const core::TriangleMesh& mesh_;
  PlainTree tree_;
  std::vector<core::TriangleId> triangles_;
};

/// Measures them in float.
class MeasuringPlainSearch : public Contender {
 public:
  explicit MeasuringPlainSearch(const core::TriangleMesh& mesh) : tree_(mesh) {
    for (std::uint32_t leaf = 0; leaf < mesh.triangleCount(); ++leaf) {
      const core::Triangle triangle = mesh.triangle(tree_.triangle(leaf));
      triangles_.push_back({toFloat(triangle.a), toFloat(triangle.b), toFloat(triangle.c)});
    }
  }

  void answer(const core::Points& tips, std::vector<double>& distances) override {
    distances.clear();
    for (const Eigen::Vector3d& point : tips) {
      const Vector tip = toFloat(point);
      const auto& [a, b, c] = triangles_[tree_.leafFor(tip)];
      const Vector offset = closestPoint(tip, a, b, c) - tip;
      distances.push_back(std::sqrt(dot(offset, offset)));
    }
  }

 private:
  PlainTree tree_;
  std::vector<std::array<Vector, 3>> triangles_;
};

}  // namespace

std::vector<Entrant> paperEntrants(const core::TriangleMesh& mesh) {
  const std::vector<Task> singly = {Task::kPoints, Task::kPath};
  return {
      {"plain search, unmeasured", singly, std::nullopt, kAll, std::make_shared<PlainSearch>(mesh)},
      {"plain search, float", singly, std::nullopt, kAll,
       std::make_shared<MeasuringPlainSearch>(mesh), kFloatTolerance}};
}

}  // namespace organ_collision::bench
