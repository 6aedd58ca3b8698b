#include "organ_collision/core/nearest_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/kernels.h"
#include "core/nearest_search.h"
#include "organ_collision/core/sign.h"
#include "organ_collision/core/triangle_distance.h"

namespace organ_collision::core {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Leaf = FarthestPairTree::Leaf;

/// How far a matrix is from a rotation: it changes squared lengths by this part of them at most.
double stretchOf(const Matrix3d& linear) {
  return (linear.transpose() * linear - Matrix3d::Identity()).norm();
}

void requireRigid(const Isometry3d& pose) {
  constexpr double kMost = 0x1p-4;  // more than tf lets pass
  const double stretch = stretchOf(pose.linear());
  if (stretch <= kMost && pose.translation().allFinite()) return;
  throw std::invalid_argument("a pose stretches squared lengths by " + std::to_string(stretch) +
                              " or is not finite: it must be rigid");
}

AffineMap mapOf(const Matrix3d& linear, const Vector3d& offset) {
  AffineMap map = {};
  for (int row = 0; row < 3; ++row) {
    map.offset[row] = offset[row];
    for (int column = 0; column < 3; ++column) map.linear[row][column] = linear(row, column);
  }
  return map;
}

std::vector<WaitingPair>& stackFor(std::size_t levels) {
  thread_local std::vector<WaitingPair> stack;
  // Opening a pair takes it from the stack and puts up to 64 there.
  const std::size_t room = 1 + (kLaneCount * kLaneCount - 1) * levels;
  if (stack.size() < room) stack.resize(room);
  return stack;
}

/// Farther than this many sizes apart, all triangles are equally far but for rounding of
/// 4*u*extent: any two will do.
constexpr double kTooFar = 0x1p60;

class PairNearest : private PairSearch {
 public:
  PairNearest(const CollisionMesh& first_surface, const Isometry3d& pose,
              const CollisionMesh& second_surface, const Accuracy& accuracy)
      : PairSearch(),
        first_(first_surface),
        second_(second_surface),
        pose_(pose),
        is_limited_(accuracy.max_leaves != 0) {
    first = {first_.wideTree().nodes().data(), first_.wideTree().packets().data()};
    second = {second_.wideTree().nodes().data(), second_.wideTree().packets().data()};
    placeFrames();
    pairs_left = is_limited_ ? accuracy.max_leaves : std::numeric_limits<std::uint32_t>::max();
    // A packet is a level too.
    stack = stackFor(first_.wideTree().depth() + second_.wideTree().depth() + 2).data();
    PairSearch::measure = [](PairSearch& search, Leaf leaf_of_first, Leaf leaf_of_second) {
      static_cast<PairNearest&>(search).measure(leaf_of_first, leaf_of_second);
    };
    share = 1.0 / (1.0 + accuracy.max_relative_error);
    allowance = accuracy.max_absolute_error * second_.wideTree().frame().scale;
    best = unopened = std::numeric_limits<double>::infinity();
  }

  NearestPair run() {
    measureGreedily();
    const bool beyond = !(largestCoordinate(second_from_first.offset) < kTooFar) ||
                        !(largestCoordinate(first_from_second.offset) < kTooFar);
    if (!beyond && !is_limited_) measureToAndFro();
    if (!beyond) kernels().walkPairs(*this);
    return answer();
  }

 private:
  static double largestCoordinate(const std::array<double, 3>& v) {
    return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  }

  void placeFrames() {
    const UnitFrame& from = first_.wideTree().frame();
    const UnitFrame& to = second_.wideTree().frame();
    const double ratio = to.scale / from.scale;
    const Matrix3d linear = pose_.linear();
    const Matrix3d inverse = linear.inverse();
    const Vector3d between = to.center - pose_.translation();
    second_from_first = mapOf(ratio * linear, to.scale * (linear * from.center - between));
    first_from_second = mapOf(inverse / ratio, from.scale * (inverse * between - from.center));
    const double stretch = stretchOf(linear);
    least_scale = ratio * std::sqrt(1.0 - stretch) * (1.0 - 0x1p-20);
    largest_scale = ratio * std::sqrt(1.0 + stretch);
    constexpr double kRounding = 0x1p-47;  // of coordinates: 3 products and sums, there and back
    const double coordinates = from.center.lpNorm<1>() + to.center.lpNorm<1>() +
                               pose_.translation().lpNorm<1>() + 8.0 / from.scale + 8.0 / to.scale;
    rounding = kRounding * to.scale * coordinates;
  }

  Triangle ofFirst(Leaf leaf) const {
    const auto [a, b, c] = first_.mesh().triangle(first_.tree().triangle(leaf));
    return {pose_ * a, pose_ * b, pose_ * c};
  }
  Triangle ofSecond(Leaf leaf) const {
    return second_.mesh().triangle(second_.tree().triangle(leaf));
  }

  /// The triangle to which the paper's search leads from the other surface, and back.
  void measureGreedily() {
    const Box& box = first_.health().box;
    const Vector3d middle = pose_ * (box.low + 0.5 * (box.high - box.low));
    const auto there = second_.tree().greedySearch(second_.mesh(), middle);
    const Vector3d target = pose_.inverse(Eigen::Affine) * centroid(ofSecond(there.end));
    const auto back = first_.tree().greedySearch(first_.mesh(), target);
    bounds += there.nodes + back.nodes;
    measure(back.end, there.end);
    ++triangles;
    --pairs_left;
  }

  /// From a point of one surface to the nearest of the other, and back: where that leads, a search
  /// has little left to do.
  void measureToAndFro() {
    constexpr int kTurns = 3;
    const Isometry3d back(pose_.inverse(Eigen::Affine));
    double before = std::numeric_limits<double>::infinity();
    for (int turn = 0; turn < kTurns && best > 0.0 && best < before; ++turn) {
      before = best;
      const auto there = nearestTo(second_, pair_.point_on_first);
      const auto here = nearestTo(first_, back * there.closest.point);
      measure(first_.wideTree().leafOf(here.triangle), second_.wideTree().leafOf(there.triangle));
    }
  }

  NearestTriangle nearestTo(const CollisionMesh& surface, const Vector3d& point) {
    NearestTriangle nearest =
        NearestSearch<PointTip>(surface, PointTip(point), Accuracy::exact()).run();
    bounds += nearest.work.bounds;
    triangles += nearest.work.triangles;
    return nearest;
  }

  void measure(Leaf leaf_of_first, Leaf leaf_of_second) {
    const ClosestPair candidate = closestPoints(ofFirst(leaf_of_first), ofSecond(leaf_of_second));
    const double squared_distance = candidate.on_second.squared_distance;
    const std::pair<Leaf, Leaf> leaves = {leaf_of_first, leaf_of_second};
    if (squared_distance > squared_best_ ||
        (squared_distance == squared_best_ && leaves > best_leaves_))
      return;
    pair_ = candidate;
    best_leaves_ = leaves;
    squared_best_ = squared_distance;
    best = std::min(best, std::sqrt(squared_distance) * second_.wideTree().frame().scale);
    const Vector3d along = candidate.on_second.offset.stableNormalized();
    way = {along.x(), along.y(), along.z()};
  }

  NearestPair answer() const {
    const double distance = std::sqrt(squared_best_);
    const TriangleId triangle = second_.tree().triangle(best_leaves_.second);
    const double lower_bound =
        std::max(0.0, std::min(distance, unopened / second_.wideTree().frame().scale));
    return {first_.tree().triangle(best_leaves_.first),
            {triangle,
             pair_.on_second,
             pair_.point_on_first,
             pseudonormal(second_, triangle, pair_.on_second.feature),
             distance,
             lower_bound,
             distance,
             false,
             {bounds, triangles}}};
  }

  const CollisionMesh& first_;
  const CollisionMesh& second_;
  const Isometry3d& pose_;
  const bool is_limited_;
  ClosestPair pair_ = {};
  std::pair<Leaf, Leaf> best_leaves_ = {};
  double squared_best_ = std::numeric_limits<double>::infinity();
};

bool holds(const CollisionMesh& solid, const Eigen::Vector3d& point) {
  return solid.health().isSolid() && windingNumber(solid, point) != 0;
}

/// For surfaces that do not meet: one is wholly inside the other's solid.
bool isOneInsideTheOther(const CollisionMesh& first, const Eigen::Isometry3d& second_from_first,
                         const CollisionMesh& second) {
  const Eigen::Vector3d of_first = first.mesh().triangle(TriangleId{0}).a;
  const Eigen::Vector3d of_second = second.mesh().triangle(TriangleId{0}).a;
  return holds(second, second_from_first * of_first) ||
         holds(first, second_from_first.inverse() * of_second);
}

NearestTriangle withSign(NearestTriangle nearest, bool inside) {
  nearest.distance_signed = true;
  if (!inside) return nearest;
  nearest.distance = -nearest.distance;
  nearest.upper_bound = -nearest.lower_bound;
  nearest.lower_bound = nearest.distance;
  return nearest;
}

}  // namespace

NearestPair nearestPair(const CollisionMesh& first, const Eigen::Isometry3d& second_from_first,
                        const CollisionMesh& second, const Accuracy& accuracy) {
  requireUsable(accuracy);
  requireRigid(second_from_first);
  NearestPair pair = PairNearest(first, second_from_first, second, accuracy).run();
  const bool may_hold = first.health().isSolid() || second.health().isSolid();
  const bool apart = pair.nearest.lower_bound > 0.0;
  if (may_hold && (apart || pair.nearest.isExact())) {
    const bool inside = apart && isOneInsideTheOther(first, second_from_first, second);
    pair.nearest = withSign(pair.nearest, inside);
  }
  return pair;
}

}  // namespace organ_collision::core
