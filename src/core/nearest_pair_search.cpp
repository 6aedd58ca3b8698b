#include "core/nearest_pair_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/greedy_search.h"
#include "core/kernels/kernels.h"
#include "core/nearest_search.h"
#include "core/rigid_pose.h"
#include "core/unit_vector.h"
#include "organ_collision/core/sign.h"

namespace organ_collision::core {
namespace {

/// Sizes of a surface: where the other's middle is farther, its boxes are not to be told apart.
constexpr double kTooFar = 0x1p60;
/// Sizes of a surface that is so much larger cannot be squared beside those of the other.
constexpr double kTooLarge = 0x1p500;
/// Sizes of a surface: where all of the other is farther, its triangles are equally far but for
/// rounding of 4*u*extent, and any of them will do.
constexpr double kAllAlike = 0x1p58;
/// Of a surface's size: how far single precision moves its corners.
constexpr double kPlaces = 0x1p-22;
/// Of the smaller surface: where rounding moves the other by more, hardly any pair of triangles can
/// be left out.
constexpr double kMuch = 0x1p-6;
/// Pairs that are looked at there, which takes some hundredths of a second.
constexpr std::uint32_t kMostBlurred = 1U << 16U;

double largestCoordinate(const std::array<double, 3>& v) {
  return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
}

AffineMap affineMap(const Eigen::Matrix3d& linear, const Eigen::Vector3d& offset) {
  AffineMap map = {};
  for (int row = 0; row < 3; ++row) {
    map.offset[row] = offset[row];
    for (int column = 0; column < 3; ++column) map.linear[row][column] = linear(row, column);
  }
  return map;
}

/// Of a distance that is the least before a pose: how much of it, at least, the least one is after.
double leftByStretch(const Eigen::Matrix3d& linear) {
  constexpr double kRotation = 0x1p-49;  // what rounding makes of one
  const double stretch = stretchOf(linear);
  return stretch > kRotation ? std::sqrt((1.0 - stretch) / (1.0 + stretch)) : 1.0;
}

/// Room for the pairs that wait while two trees of that many levels together are searched; the
/// calling thread's.
std::vector<WaitingPair>& pairScratch(std::size_t levels) {
  thread_local std::vector<WaitingPair> stack;
  // Opening a pair takes it from the stack and puts up to 64 there.
  const std::size_t room = 1 + (kLaneCount * kLaneCount - 1) * levels;
  if (stack.size() < room) stack.resize(room);
  return stack;
}

}  // namespace

double poseRounding(const CollisionMesh& first, const Eigen::Isometry3d& second_from_first,
                    const CollisionMesh& second) {
  constexpr double kRounding = 0x1p-47;  // of coordinates: 3 products and sums, there and back
  const UnitFrame& from = first.wideTree().frame();
  const UnitFrame& to = second.wideTree().frame();
  return kRounding *
         (from.centre.lpNorm<1>() + to.centre.lpNorm<1>() +
          second_from_first.translation().lpNorm<1>() + 8.0 / from.scale + 8.0 / to.scale);
}

NearestPairSearch::NearestPairSearch(const CollisionMesh& first_surface,
                                     const Eigen::Isometry3d& pose,
                                     const CollisionMesh& second_surface, const Accuracy& accuracy)
    : PairSearch(),
      first_(first_surface),
      second_(second_surface),
      pose_(pose),
      is_limited_(accuracy.max_leaves != 0) {
  first = {first_.wideTree().nodes().data(), first_.wideTree().packets().data()};
  second = {second_.wideTree().nodes().data(), second_.wideTree().packets().data()};
  placeFrames();
  pairs_left = is_limited_   ? accuracy.max_leaves
               : isBlurred() ? kMostBlurred
                             : std::numeric_limits<std::uint32_t>::max();
  // A packet is a level too.
  stack = pairScratch(first_.wideTree().depth() + second_.wideTree().depth() + 2).data();
  PairSearch::measure = [](PairSearch& search, FarthestPairTree::Leaf leaf_of_first,
                           FarthestPairTree::Leaf leaf_of_second) {
    static_cast<NearestPairSearch&>(search).measure(leaf_of_first, leaf_of_second);
  };
  share = 1.0 / (1.0 + accuracy.max_relative_error);
  allowance = accuracy.max_absolute_error * second_.wideTree().frame().scale;
  best = unopened = std::numeric_limits<double>::infinity();
}

NearestPair NearestPairSearch::run() {
  measureGreedily();
  if (areAllAlike()) {
    measure(0, 0);
    return answer();
  }
  if (!is_limited_) measureToAndFro();
  if (!isTooFar()) {
    kernels().walkPairs(*this);
  } else {
    unopened = is_limited_ || !areFarApart() ? 0.0 : best * leftByStretch(pose_.linear());
  }
  return answer();
}

bool NearestPairSearch::isTooFar() const {
  return !(largestCoordinate(second_from_first.offset) < kTooFar) ||
         !(largestCoordinate(first_from_second.offset) < kTooFar) || largest_scale > kTooLarge ||
         least_scale < 1.0 / kTooLarge;
}

bool NearestPairSearch::isBlurred() const {
  return rounding + kPlaces * (1.0 + largest_scale) > kMuch * std::min(1.0, least_scale);
}

/// Not so of a surface that is huge beside the other and about it, as with one vertex astray.
bool NearestPairSearch::areFarApart() const {
  Box moved;
  for (const Eigen::Vector3d& corner : cornersOf(first_.health().box)) moved.add(pose_ * corner);
  const double scale = std::max(first_.wideTree().frame().scale, second_.wideTree().frame().scale);
  return std::sqrt(squaredDistance(moved, second_.health().box)) * scale > kAllAlike;
}

bool NearestPairSearch::areAllAlike() const {
  const auto is_point = [](const Box& box) { return box.low == box.high; };
  return is_point(first_.health().box) && is_point(second_.health().box);
}

void NearestPairSearch::placeFrames() {
  const UnitFrame& from = first_.wideTree().frame();
  const UnitFrame& to = second_.wideTree().frame();
  const double ratio = to.scale / from.scale;
  const Eigen::Matrix3d linear = pose_.linear();
  const Eigen::Matrix3d inverse = linear.inverse();
  const Eigen::Vector3d between = to.centre - pose_.translation();
  second_from_first = affineMap(ratio * linear, to.scale * (linear * from.centre - between));
  first_from_second = affineMap(inverse / ratio, from.scale * (inverse * between - from.centre));
  const double stretch = stretchOf(linear);
  least_scale = ratio * std::sqrt(1.0 - stretch) * (1.0 - 0x1p-20);
  largest_scale = ratio * std::sqrt(1.0 + stretch);
  rounding = to.scale * poseRounding(first_, pose_, second_);
}

Triangle NearestPairSearch::ofFirst(FarthestPairTree::Leaf leaf) const {
  const auto [a, b, c] = first_.mesh().triangle(first_.wideTree().corners()[leaf]);
  return {pose_ * a, pose_ * b, pose_ * c};
}

Triangle NearestPairSearch::ofSecond(FarthestPairTree::Leaf leaf) const {
  return second_.mesh().triangle(second_.wideTree().corners()[leaf]);
}

void NearestPairSearch::measureGreedily() {
  const Box& box = first_.health().box;
  const Eigen::Vector3d middle = pose_ * (box.low + 0.5 * (box.high - box.low));
  const GreedyPath there = greedySearch(second_, middle);
  const Eigen::Vector3d target = pose_.inverse(Eigen::Affine) * centroid(ofSecond(there.end));
  const GreedyPath back = greedySearch(first_, target);
  bounds += there.splits + back.splits;
  measure(back.end, there.end);
  ++triangles;
  --pairs_left;
}

void NearestPairSearch::measureToAndFro() {
  constexpr int kTurns = 3;
  const Eigen::Isometry3d back(pose_.inverse(Eigen::Affine));
  double before = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < kTurns && best > 0.0 && best < before; ++turn) {
    before = best;
    const auto there = nearestTo(second_, pair_.point_on_first);
    const auto here = nearestTo(first_, back * there.closest.point);
    measure(first_.wideTree().leafOf(here.triangle), second_.wideTree().leafOf(there.triangle));
  }
}

NearestTriangle NearestPairSearch::nearestTo(const CollisionMesh& surface,
                                             const Eigen::Vector3d& point) {
  NearestTriangle nearest;
  NearestSearch<PointTip>(surface, PointTip(point), Accuracy::exact(), Sign::kNone, nearest).run();
  bounds += nearest.work.bounds;
  triangles += nearest.work.triangles;
  return nearest;
}

void NearestPairSearch::measure(FarthestPairTree::Leaf leaf_of_first,
                                FarthestPairTree::Leaf leaf_of_second) {
  const ClosestPair candidate = closestPoints(ofFirst(leaf_of_first), ofSecond(leaf_of_second));
  const double squared_distance = candidate.on_second.squared_distance;
  const std::pair<FarthestPairTree::Leaf, FarthestPairTree::Leaf> leaves = {leaf_of_first,
                                                                            leaf_of_second};
  if (squared_distance > squared_best_ ||
      (squared_distance == squared_best_ && leaves > best_leaves_))
    return;
  pair_ = candidate;
  best_leaves_ = leaves;
  squared_best_ = squared_distance;
  best = std::min(best, std::sqrt(squared_distance) * second_.wideTree().frame().scale);
  const Eigen::Vector3d along = unit(candidate.on_second.offset);
  axis = {along.x(), along.y(), along.z()};
}

NearestPair NearestPairSearch::answer() const {
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

}  // namespace organ_collision::core
