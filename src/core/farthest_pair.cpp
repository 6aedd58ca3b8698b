#include "organ_collision/core/farthest_pair.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "core/kernels.h"
#include "core/raw_vector.h"
#include "organ_collision/core/box.h"

namespace organ_collision::core {
namespace {

constexpr std::size_t kFewPoints = 32;       // all pairs of so many cost less than sweeps
constexpr std::size_t kFewToCompare = 4096;  // are compared rather than divided

bool isBetter(const FarthestPair& candidate, const FarthestPair& best) {
  if (candidate.squared_distance != best.squared_distance)
    return candidate.squared_distance > best.squared_distance;
  return std::tie(candidate.first, candidate.second) < std::tie(best.first, best.second);
}

FarthestPair pairOf(std::size_t i, std::size_t j, double squared_distance) {
  return {std::min(i, j), std::max(i, j), squared_distance};
}

std::array<double, 3> plain(const Eigen::Vector3d& point) {
  return {point.x(), point.y(), point.z()};
}

/// The distance of the farthest corner: no computed distance of a point in the box is larger, as
/// rounding is monotone.
double largestSquaredDistance(const Box& box, const Eigen::Vector3d& point) {
  return squaredLength((box.high - point).cwiseMax(point - box.low));
}

using PoweredPoints = RawVector<PoweredPoint>;

/// A set of points and the best pair found so far.
class Diameter {
 public:
  Diameter(const PointColumns& points, std::size_t count) : points_(points), count_(count) {}

  FarthestPair find() {
    walkFrom(0);
    if (best_.squared_distance == 0.0) return best_;  // all coincide
    while (true) {
      const PoweredPoints outside = pointsOutsideBall();
      if (outside.empty()) return best_;
      const PoweredPoint farthest_out = *std::max_element(
          outside.begin(), outside.end(),
          [](const PoweredPoint& a, const PoweredPoint& b) { return a.power < b.power; });
      if (walkFrom(farthest_out.index)) continue;  // its ball leaves fewer points outside
      Members ends = members(outside);
      pairUp({ends.begin(), ends.end()}, members(pointsFarEnoughFor(farthest_out)));
      return best_;
    }
  }

 private:
  struct Member {
    Eigen::Vector3d place;
    std::size_t index;
  };
  using Members = RawVector<Member>;
  struct Range {
    Members::iterator first, last;
    Members::iterator begin() const { return first; }
    Members::iterator end() const { return last; }
    std::size_t size() const { return static_cast<std::size_t>(last - first); }
  };

  Eigen::Vector3d at(std::size_t i) const { return {points_.x[i], points_.y[i], points_.z[i]}; }

  /// Compares point i with all others; the best pair of which it is a member.
  FarthestPair scan(std::size_t i) {
    const FarPoint farthest = kernels().farthestFrom(points_, count_, plain(at(i)));
    const FarthestPair pair = pairOf(i, farthest.index, farthest.squared_distance);
    if (isBetter(pair, best_)) best_ = pair;
    return pair;
  }

  /// Goes from a point to its farthest, from there to its farthest, while that makes the best pair
  /// longer; returns whether it did.
  bool walkFrom(std::size_t start) {
    const double before = best_.squared_distance;
    for (std::size_t from = start;;) {
      const double reached = best_.squared_distance;
      const FarthestPair pair = scan(from);
      if (pair.squared_distance <= reached) return reached > before;
      from = pair.first == from ? pair.second : pair.first;
    }
  }

  /// More than rounding takes from a power, or from a square as long as the best pair's: ties must
  /// not fall through.
  double slack() const {
    using Limits = std::numeric_limits<double>;
    return 64.0 * (Limits::epsilon() * best_.squared_distance + Limits::denorm_min());
  }

  /// Those of a power of at least `least` with respect to the ball whose diameter is the best pair.
  PoweredPoints pointsOfPower(double least) const {
    PoweredPoints all(count_);
    all.resize(kernels().listByPower(points_, count_, plain(at(best_.first)),
                                     plain(at(best_.second)), least, all.data()));
    return all;
  }

  /// The points other than the best pair's that can be an end of a pair as long as the best or
  /// longer: those not inside the ball.
  PoweredPoints pointsOutsideBall() const {
    PoweredPoints outside = pointsOfPower(-slack());
    const auto is_known = [this](const PoweredPoint& point) {
      return point.index == best_.first || point.index == best_.second;
    };
    outside.erase(std::remove_if(outside.begin(), outside.end(), is_known), outside.end());
    return outside;
  }

  /// The points that can be the other end of such a pair: they are as far from the ball's middle as
  /// the pair is long, less how far the one end is.
  PoweredPoints pointsFarEnoughFor(const PoweredPoint& farthest_out) const {
    const double squared_radius = best_.squared_distance / 4.0;
    const double reach = std::sqrt(squared_radius + farthest_out.power + slack());
    const double rest = std::sqrt(best_.squared_distance) - reach;
    return pointsOfPower(rest * rest - squared_radius - slack());
  }

  Members members(const PoweredPoints& points) const {
    Members all;
    all.reserve(points.size());
    for (const PoweredPoint& point : points) all.push_back({at(point.index), point.index});
    return all;
  }

  /// Compares each end with all others that may be as far from it as the best pair is long.
  /// REQUIRES: the others in order. Recursion is safe: halving keeps it as deep as the logarithm of
  /// the count, whatever the positions.
  void pairUp(const Range& ends, const Members& others) {
    if (ends.size() == 1 || ends.size() * others.size() <= kFewToCompare) {
      compare(ends, others);
      return;
    }
    Box box;
    std::size_t lowest = count_;
    for (const Member& end : ends) {
      box.add(end.place);
      lowest = std::min(lowest, end.index);
    }
    Members left(others.size());
    std::size_t count = 0;
    for (const Member& other : others) {  // without a branch, as none could be foreseen
      left[count] = other;
      const double bound = largestSquaredDistance(box, other.place);
      count += isBetter(pairOf(lowest, other.index, bound), best_) ? 1 : 0;
    }
    left.resize(count);
    Eigen::Index axis = 0;
    (box.high - box.low).maxCoeff(&axis);
    const auto middle = ends.begin() + (ends.end() - ends.begin()) / 2;
    std::nth_element(ends.begin(), middle, ends.end(), [axis](const Member& a, const Member& b) {
      return std::tie(a.place[axis], a.index) < std::tie(b.place[axis], b.index);
    });
    pairUp({ends.begin(), middle}, left);
    pairUp({middle, ends.end()}, left);
  }

  void compare(const Range& ends, const Members& others) {
    if (others.empty()) return;
    const std::size_t count = std::max<std::size_t>(others.size(), kLaneCount);
    RawVector<double> columns(3 * count);
    const PointColumns places = {&columns[0], &columns[count], &columns[2 * count]};
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3d& place = others[std::min(i, others.size() - 1)].place;
      columns[i] = place.x();
      columns[count + i] = place.y();
      columns[2 * count + i] = place.z();
    }
    for (const Member& end : ends) {
      const FarPoint farthest = kernels().farthestFrom(places, count, plain(end.place));
      const FarthestPair pair =
          pairOf(end.index, others[farthest.index].index, farthest.squared_distance);
      if (isBetter(pair, best_)) best_ = pair;
    }
  }

  PointColumns points_;
  std::size_t count_;
  FarthestPair best_ = {0, 0, 0.0};
};

}  // namespace

FarthestPair farthestPair(const PointColumns& points, std::size_t count) {
  assert(count >= 1);
  if (count < kLaneCount) return farthestPairBruteForce(points, count);
  if (count <= kFewPoints) return kernels().farthestOfAllPairs(points, count);
  return Diameter(points, count).find();
}

FarthestPair farthestPairBruteForce(const PointColumns& points, std::size_t count) {
  assert(count >= 1);
  FarthestPair best = {0, 0, 0.0};
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      const double x = points.x[j] - points.x[i];
      const double y = points.y[j] - points.y[i];
      const double z = points.z[j] - points.z[i];
      const double squared_distance = (x * x + y * y) + z * z;
      if (squared_distance > best.squared_distance) best = {i, j, squared_distance};
    }
  }
  return best;
}

}  // namespace organ_collision::core
