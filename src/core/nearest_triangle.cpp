#include "organ_collision/core/nearest_triangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/kernels.h"
#include "organ_collision/core/sign.h"
#include "organ_collision/core/triangle_distance.h"

namespace organ_collision::core {
namespace {

using Leaf = FarthestPairTree::Leaf;

/// What the search asks of a tip: its corners, where to route it, how near a triangle is.
class PointTip {
 public:
  explicit PointTip(const Eigen::Vector3d& point) : point_(point) {}
  std::array<Eigen::Vector3d, 1> corners() const { return {point_}; }
  const Eigen::Vector3d& routingPoint() const { return point_; }
  double squaredDistanceTo(const Box& box) const { return squaredDistance(box, point_); }
  ClosestPair measure(const Triangle& triangle) const {
    return {point_, closestPointOnTriangle(point_, triangle)};
  }

 private:
  const Eigen::Vector3d& point_;
};

class TriangleTip {
 public:
  explicit TriangleTip(const Triangle& tip) : tip_(tip), centroid_(centroid(tip)) {}
  std::array<Eigen::Vector3d, 3> corners() const { return {tip_.a, tip_.b, tip_.c}; }
  const Eigen::Vector3d& routingPoint() const { return centroid_; }
  double squaredDistanceTo(const Box& box) const { return squaredDistance(box, boxOf(tip_)); }
  ClosestPair measure(const Triangle& triangle) const { return closestPoints(tip_, triangle); }

 private:
  const Triangle& tip_;
  Eigen::Vector3d centroid_;
};

std::vector<Waiting>& scratch(std::size_t depth) {
  thread_local std::vector<Waiting> stack;
  // Opening a node takes one set from the stack, puts up to eight there and writes past them.
  const std::size_t room = 2 + (kLaneCount - 1) * depth;
  if (stack.size() < room) stack.resize(room);
  return stack;
}

/// Beyond this many sizes of the organ squares could overflow: there all triangles are measured.
constexpr double kBeyond = 0x1p400;

template <class Tip>
class NearestSearch : private Search {
 public:
  NearestSearch(const CollisionMesh& organ, const Tip& tip, const Accuracy& accuracy)
      : Search(),
        organ_(organ),
        tip_(tip),
        accuracy_(accuracy),
        scale_(organ.wideTree().frame().scale) {
    const WideTree& tree = organ.wideTree();
    nodes = tree.nodes().data();
    packets = tree.packets().data();
    Eigen::Vector3d last = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    for (const Eigen::Vector3d& corner : tip.corners()) {
      if (corner == last) continue;  // a segment or a point
      last = corner;
      const Eigen::Vector3d unit = tree.frame()(corner);
      corners[corner_count++] = {unit.x(), unit.y(), unit.z()};
      beyond_ = beyond_ || !(unit.cwiseAbs().maxCoeff() < kBeyond);
    }
    leaves_left =
        accuracy.max_leaves == 0 ? std::numeric_limits<std::uint32_t>::max() : accuracy.max_leaves;
    stack = scratch(tree.depth()).data();
    Search::measure = [](Search& search, Leaf leaf) {
      static_cast<NearestSearch&>(search).measure(leaf);
    };
    share = 1.0 / (1.0 + accuracy.max_relative_error);
    allowance = accuracy.max_absolute_error * scale_;
    best = unopened = std::numeric_limits<double>::infinity();
  }

  NearestTriangle run() {
    if (accuracy_.max_leaves != 0) {
      const auto [leaf, splits] = organ_.tree().greedySearch(organ_.mesh(), tip_.routingPoint());
      measure(leaf);
      bounds += splits;
      --leaves_left;
      ++triangles;
    }
    if (beyond_) {
      measureAll();
    } else {
      kernels().walk(*this);
    }
    return answer();
  }

 private:
  void measure(Leaf leaf) {
    const ClosestPair candidate =
        tip_.measure(organ_.mesh().triangle(organ_.tree().triangle(leaf)));
    const double squared_distance = candidate.on_second.squared_distance;
    if (squared_distance > squared_best_ ||
        (squared_distance == squared_best_ && leaf > best_leaf_))
      return;
    pair_ = candidate;
    best_leaf_ = leaf;
    squared_best_ = squared_distance;
    best = std::min(best, std::sqrt(squared_distance) * scale_);
  }

  void measureAll() {
    for (Leaf leaf = 0; leaf < organ_.tree().root().size(); ++leaf) {
      if (leaves_left == 0) {
        unopened = 0.0;
        return;
      }
      measure(leaf);
      --leaves_left;
      ++triangles;
    }
  }

  NearestTriangle answer() const {
    const double distance = std::sqrt(squared_best_);
    const double to_box = std::sqrt(tip_.squaredDistanceTo(organ_.health().box));
    return {organ_.tree().triangle(best_leaf_),
            pair_.on_second,
            pair_.point_on_first,
            Eigen::Vector3d::Zero(),
            distance,
            std::min(distance, std::max(to_box, unopened / scale_)),
            distance,
            false,
            {bounds, triangles}};
  }

  const CollisionMesh& organ_;
  const Tip& tip_;
  const Accuracy& accuracy_;
  const double scale_;
  bool beyond_ = false;
  ClosestPair pair_ = {};
  Leaf best_leaf_ = 0;
  double squared_best_ = std::numeric_limits<double>::infinity();
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
  return withSign(organ, NearestSearch<PointTip>(organ, PointTip(tip), accuracy).run());
}

NearestTriangle nearestTriangle(const CollisionMesh& organ, const Triangle& tip,
                                const Accuracy& accuracy) {
  for (const Eigen::Vector3d* corner : {&tip.a, &tip.b, &tip.c}) requireUsable(*corner, "tip", 0);
  requireUsable(accuracy);
  return withSign(organ, NearestSearch<TriangleTip>(organ, TriangleTip(tip), accuracy).run());
}

}  // namespace organ_collision::core
