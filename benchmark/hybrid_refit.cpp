// Does it pay to refit the lower half of a hierarchy only where queries come, as T. Larsson and T.
// Akenine-Moeller propose ("Collision detection for continuously deforming bodies", 2001)? The
// farthest-pair hierarchy with plain boxes, refitted as a whole (bottom-up) and by halves:
// bottom-up above a middle level, whose boxes are drawn around their triangles; top-down below,
// when a query opens a set for the first time.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "node/stopwatch.h"
#include "organ_collision/core/closest_point.h"
#include "organ_collision/core/collision_mesh.h"
#include "organs.h"
#include "test_meshes.h"
#include "tools/arguments.h"
#include "tools/program.h"

namespace organ_collision {
namespace {

using Set = core::FarthestPairTree::Set;

/// One box for each split of the hierarchy, in its order.
class Boxes {
 public:
  Boxes(const core::FarthestPairTree& tree, const core::TriangleMesh& mesh)
      : tree_(tree), mesh_(mesh), boxes_(tree.root().size()), updates_(boxes_.size(), 0) {
    std::vector<std::pair<Set, std::size_t>> pending = {{tree.root(), 0}};
    while (!pending.empty()) {
      const auto [set, depth] = pending.back();
      pending.pop_back();
      if (set.isLeaf()) continue;
      sets_.push_back({set, depth == tree.depth() / 2, depth < tree.depth() / 2});
      for (const Set& child : tree.children(set)) pending.emplace_back(child, depth + 1);
    }
  }

  void refitAll() {
    ++update_;
    for (auto set = sets_.rbegin(); set != sets_.rend(); ++set) enclose(set->set);
  }

  void refitUpperHalf() {
    ++update_;
    for (auto set = sets_.rbegin(); set != sets_.rend(); ++set) {
      if (set->is_middle) draw(set->set);
      if (set->is_above) enclose(set->set);
    }
  }

  double squaredDistance(const Eigen::Vector3d& tip) {
    double best = std::numeric_limits<double>::infinity();
    pending_.clear();
    pending_.emplace_back(0.0, tree_.root());
    while (!pending_.empty()) {
      const auto [bound, set] = pending_.back();
      pending_.pop_back();
      if (bound > best) continue;
      if (set.isLeaf()) {
        best = std::min(best, closestPointOnTriangle(tip, triangle(set)).squared_distance);
        continue;
      }
      auto [near, far] = tree_.children(set);
      double to_near = core::squaredDistance(boxOf(near), tip);
      double to_far = core::squaredDistance(boxOf(far), tip);
      if (to_far < to_near) {
        std::swap(near, far);
        std::swap(to_near, to_far);
      }
      pending_.emplace_back(to_far, far);
      pending_.emplace_back(to_near, near);
    }
    return best;
  }

 private:
  struct Split {
    Set set;
    bool is_middle, is_above;
  };

  core::Triangle triangle(const Set& leaf) const {
    return mesh_.triangle(tree_.triangle(leaf.begin));
  }

  /// Draws it first where that was left for later.
  core::Box boxOf(const Set& set) {
    if (set.isLeaf()) return core::boxOf(triangle(set));
    if (updates_[set.node] != update_) draw(set);
    return boxes_[set.node];
  }

  void draw(const Set& set) {
    core::Box box;
    for (auto leaf = set.begin; leaf < set.end; ++leaf)
      box.add(core::boxOf(triangle({leaf, leaf + 1, 0})));
    keep(set, box);
  }

  void enclose(const Set& set) {
    core::Box box;
    for (const Set& child : tree_.children(set)) box.add(boxOf(child));
    keep(set, box);
  }

  void keep(const Set& set, const core::Box& box) {
    boxes_[set.node] = box;
    updates_[set.node] = update_;
  }

  const core::FarthestPairTree& tree_;
  const core::TriangleMesh& mesh_;
  std::vector<Split> sets_;  // parents before children
  std::vector<core::Box> boxes_;
  std::vector<std::uint32_t> updates_;  // that a box is of
  std::uint32_t update_ = 0;
  std::vector<std::pair<double, Set>> pending_;
};

/// [s] of an update and so many queries after it, the least of some times; adds up the distances.
template <class Refit>
double costOf(Boxes& boxes, const core::Points& tips, std::size_t queries, double& sum,
              const Refit& refit) {
  constexpr int kRepeats = 20;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kRepeats; ++i) {
    const node::CostStopwatch watch;
    refit(boxes);
    for (std::size_t query = 0; query < queries; ++query)
      sum += std::sqrt(boxes.squaredDistance(tips[query]));
    least = std::min(least, watch.elapsed());
  }
  return least;
}

void run(const std::vector<std::string>& words) {
  const tools::Arguments arguments(words, {"--organ"});
  arguments.requireNoWords();
  const std::string name = arguments.option("--organ").value_or("liver");
  const core::TriangleMesh mesh = bench::organNamed(name);
  const core::FarthestPairTree tree(mesh);
  Boxes boxes(tree, mesh);
  std::mt19937 generator(1);
  std::printf("%s, %zu triangles: an update and the queries after it [us]\n", name.c_str(),
              mesh.triangleCount());
  for (const std::size_t queries : {0, 1, 10, 100, 1000, 10000}) {
    core::Points tips;
    for (std::size_t i = 0; i < queries; ++i)
      tips.push_back(mesh.positions()[generator() % mesh.positions().size()] +
                     test::randomPoint(generator, 0.01));
    double whole_sum = 0.0;
    double half_sum = 0.0;
    const double whole = costOf(boxes, tips, queries, whole_sum, [](auto& b) { b.refitAll(); });
    const double half = costOf(boxes, tips, queries, half_sum, [](auto& b) { b.refitUpperHalf(); });
    if (whole_sum != half_sum) throw std::runtime_error("the two give different distances");
    std::printf("%6zu queries: bottom-up %8.0f, hybrid %8.0f\n", queries, 1e6 * whole, 1e6 * half);
  }
}

}  // namespace
}  // namespace organ_collision

int main(int count, char** words) {
  using namespace organ_collision;
  return tools::runProgram({"hybrid_refit", "usage: hybrid_refit [--organ ORGAN]\n"},
                           {words + 1, words + count}, std::cout, std::cerr, run);
}
