#include "organ_collision/core/nearest_triangle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "organ_collision/core/sign.h"
#include "organ_collision/core/triangle_distance.h"

namespace organ_collision::core {
namespace {

using Child = FarthestPairTree::Child;
using Leaf = FarthestPairTree::Leaf;

/// What the search asks of a tip: where to route it, how near a box can be, how near a triangle is.
class PointTip {
 public:
  explicit PointTip(const Eigen::Vector3d& point) : point_(point) {}
  const Eigen::Vector3d& routingPoint() const { return point_; }
  double bound(const Box& box) const { return squaredDistance(box, point_); }
  ClosestPair measure(const Triangle& triangle) const {
    return {point_, closestPointOnTriangle(point_, triangle)};
  }

 private:
  const Eigen::Vector3d& point_;
};

class TriangleTip {
 public:
  explicit TriangleTip(const Triangle& tip)
      : tip_(tip), centroid_(centroid(tip)), box_(boxOf(tip)) {}
  const Eigen::Vector3d& routingPoint() const { return centroid_; }
  double bound(const Box& box) const { return squaredDistance(box, box_); }
  ClosestPair measure(const Triangle& triangle) const { return closestPoints(tip_, triangle); }

 private:
  const Triangle& tip_;
  Eigen::Vector3d centroid_;
  Box box_;
};

/// Best first: the greedy path to a first triangle, then always the set whose box is nearest, until
/// no set left can hold a nearer triangle than the accuracy asks for.
template <class Tip>
class Search {
 public:
  Search(const CollisionMesh& organ, const Tip& tip, const Accuracy& accuracy)
      : mesh_(organ.mesh()),
        tree_(organ.tree()),
        tip_(tip),
        accuracy_(accuracy),
        queue_(scratch()) {
    queue_.clear();
  }

  NearestTriangle run() {
    descendGreedily();
    while (!queue_.empty() && !isGoodEnough(queue_.front().bound) && !isBudgetSpent())
      expandNearest();
    return answer();
  }

 private:
  static constexpr double kAnything = -1.0;  // below every bound

  struct Entry {
    double bound;  // [m^2]
    Child set;
    bool operator<(const Entry& other) const {
      return bound > other.bound;
    }  // the nearest on top of the heap
  };

  static std::vector<Entry>& scratch() {
    thread_local std::vector<Entry> queue;
    return queue;
  }

  double bound(Child set) {
    ++work_.bounds;
    return tip_.bound(set.isLeaf() ? boxOf(mesh_.triangle(tree_.triangle(set.leaf())))
                                   : tree_.box(set.node()));
  }

  void push(Child set) {
    const double nearest_possible = bound(set);
    if (nearest_possible > best_.on_second.squared_distance) return;
    queue_.push_back({nearest_possible, set});
    std::push_heap(queue_.begin(), queue_.end());
  }

  void measure(Leaf leaf) {
    ++work_.triangles;
    const ClosestPair candidate = tip_.measure(mesh_.triangle(tree_.triangle(leaf)));
    const double distance = candidate.on_second.squared_distance;
    const double best = best_.on_second.squared_distance;
    if (distance > best || (distance == best && leaf > best_leaf_)) return;
    best_ = candidate;
    best_leaf_ = leaf;
    good_enough_ = goodEnough();
  }

  void descendGreedily() {
    Child set = tree_.root();
    while (!set.isLeaf()) {
      const FarthestPairTree::Node& node = tree_.node(set.node());
      const std::size_t side = FarthestPairTree::nearerChild(node, tip_.routingPoint());
      push(node.children[1 - side]);
      set = node.children[side];
    }
    measure(set.leaf());
  }

  void expandNearest() {
    std::pop_heap(queue_.begin(), queue_.end());
    const Child set = queue_.back().set;
    queue_.pop_back();
    if (set.isLeaf()) {
      measure(set.leaf());
      return;
    }
    for (const Child child : tree_.node(set.node()).children) push(child);
  }

  bool isBudgetSpent() const {
    return accuracy_.max_leaves != 0 && work_.triangles >= accuracy_.max_leaves;
  }

  /// A set whose bound [m^2] is larger cannot hold a triangle that matters. Zero errors: the best
  /// distance itself, so that what ties with it is still looked at.
  double goodEnough() const {
    if (accuracy_.max_relative_error == 0.0 && accuracy_.max_absolute_error == 0.0) {
      return best_.on_second.squared_distance;
    }
    const double distance = std::sqrt(best_.on_second.squared_distance);
    const double nearest_that_matters = std::min(distance / (1.0 + accuracy_.max_relative_error),
                                                 distance - accuracy_.max_absolute_error);
    return nearest_that_matters < 0.0 ? kAnything : nearest_that_matters * nearest_that_matters;
  }

  bool isGoodEnough(double bound) const { return bound > good_enough_; }

  NearestTriangle answer() const {
    const double distance = std::sqrt(best_.on_second.squared_distance);
    const double unopened = queue_.empty() ? distance : std::sqrt(queue_.front().bound);
    return {tree_.triangle(best_leaf_),
            best_.on_second,
            best_.point_on_first,
            Eigen::Vector3d::Zero(),
            distance,
            std::min(distance, unopened),
            distance,
            false,
            work_};
  }

  const TriangleMesh& mesh_;
  const FarthestPairTree& tree_;
  const Tip& tip_;
  const Accuracy& accuracy_;
  std::vector<Entry>& queue_;  // a heap
  ClosestPair best_ = farAway();
  Leaf best_leaf_ = std::numeric_limits<Leaf>::max();
  double good_enough_ = kAnything;
  SearchWork work_;

  static ClosestPair farAway() {
    ClosestPair pair;
    pair.on_second.squared_distance = std::numeric_limits<double>::infinity();
    return pair;
  }
};

/// Adds what the surface around the nearest point tells: the normal, and the sign where it is
/// proven.
NearestTriangle withSign(const CollisionMesh& organ, NearestTriangle nearest) {
  nearest.normal = pseudonormal(organ, nearest.triangle, nearest.closest.feature);
  if (!nearest.isExact() && organ.health().box.contains(nearest.tip_point)) return nearest;
  const std::optional<Side> side =
      sideOf(organ, nearest.tip_point, nearest.triangle, nearest.closest);
  nearest.distance_signed = side.has_value();
  if (side == Side::kInside) {
    nearest.distance = -nearest.distance;
    nearest.upper_bound = -nearest.lower_bound;
    nearest.lower_bound = nearest.distance;
  }
  return nearest;
}

}  // namespace

void requireUsable(const Accuracy& accuracy) {
  const auto require = [](double value, const char* name) {
    if (std::isfinite(value) && value >= 0.0) return;
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) +
                                ": it must be finite and >= 0");
  };
  require(accuracy.max_relative_error, "max_relative_error");
  require(accuracy.max_absolute_error, "max_absolute_error");
}

NearestTriangle nearestTriangle(const CollisionMesh& organ, const Eigen::Vector3d& tip,
                                const Accuracy& accuracy) {
  requireUsable(tip, "tip", 0);
  requireUsable(accuracy);
  return withSign(organ, Search<PointTip>(organ, PointTip(tip), accuracy).run());
}

NearestTriangle nearestTriangle(const CollisionMesh& organ, const Triangle& tip,
                                const Accuracy& accuracy) {
  for (const Eigen::Vector3d* corner : {&tip.a, &tip.b, &tip.c}) requireUsable(*corner, "tip", 0);
  requireUsable(accuracy);
  return withSign(organ, Search<TriangleTip>(organ, TriangleTip(tip), accuracy).run());
}

}  // namespace organ_collision::core
