#include "organ_collision/core/farthest_pair.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "core/kernels/kernels.h"
#include "organ_collision/core/box.h"
#include "organ_collision/core/huge_pages.h"

namespace organ_collision::core {
namespace {

constexpr std::size_t kFewPoints = 32;  // are compared with all there are: sweeps cost more

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

using Indices = HugePageVector<std::uint32_t>;

/// Some of a set's points, in order.
class Members {
 public:
  Members(const PointColumns& points, Indices indices)
      : indices_(std::move(indices)),
        stride_(std::max<std::size_t>(size(), kLaneCount)),
        coordinates_(3 * stride_) {
    if (indices_.empty()) return;
    for (std::size_t i = 0; i < stride_; ++i) {  // the last one again, to make eight of them
      const std::uint32_t member = indices_[std::min(i, size() - 1)];
      coordinates_[i] = points.x[member];
      coordinates_[stride_ + i] = points.y[member];
      coordinates_[2 * stride_ + i] = points.z[member];
    }
  }

  std::size_t size() const { return indices_.size(); }
  PointColumns points() const {
    return {coordinates_.data(), coordinates_.data() + stride_, coordinates_.data() + 2 * stride_};
  }
  std::uint32_t index(std::size_t i) const { return indices_[i]; }

  /// Whether one of them is at least so far from a place.
  bool reach(const Eigen::Vector3d& place, double least) const {
    return kernels().reach(points(), stride_, plain(place), least);
  }

  /// The first of those that are farthest from a place.
  FarPoint farthestFrom(const Eigen::Vector3d& place) const {
    const FarPoint farthest = kernels().farthestFrom(points(), stride_, plain(place));
    return {indices_[farthest.index], farthest.squared_distance};
  }

  /// Those whose squared distance from the box's farthest corner is at least `least`.
  /// REQUIRES: eight of them.
  Members farFrom(const Box& box, double least) const {
    Indices far(size());
    far.resize(kernels().listFarFrom(points(), size(), plain(box.low), plain(box.high), least,
                                     far.data()));
    Members found(points(), std::move(far));
    for (std::uint32_t& index : found.indices_) index = indices_[index];
    return found;
  }

 private:
  Indices indices_;
  std::size_t stride_;
  HugePageVector<double> coordinates_;
};

/// A set of points and the best pair found so far.
class Diameter {
 public:
  Diameter(const PointColumns& points, std::size_t count) : points_(points), count_(count) {}

  FarthestPair find() {
    walkFrom(0);
    if (best_.squared_distance == 0.0) return best_;  // all coincide
    while (true) {
      std::vector<End> ends = endsOutsideBall();
      if (ends.empty()) return best_;
      const End farthest_out = *std::max_element(
          ends.begin(), ends.end(),
          [this](const End& a, const End& b) { return power(a.place) < power(b.place); });
      if (walkFrom(farthest_out.index)) continue;  // there are others outside its ball
      pairUp({ends.begin(), ends.end()}, farEnoughFor(power(farthest_out.place)));
      return best_;
    }
  }

 private:
  struct End {
    Eigen::Vector3d place;
    std::size_t index;
  };
  struct Range {
    std::vector<End>::iterator first, last;
    std::vector<End>::iterator begin() const { return first; }
    std::vector<End>::iterator end() const { return last; }
    std::size_t size() const { return static_cast<std::size_t>(last - first); }
  };

  Eigen::Vector3d at(std::size_t i) const { return {points_.x[i], points_.y[i], points_.z[i]}; }

  void note(const FarthestPair& pair) {
    if (isBetter(pair, best_)) best_ = pair;
  }

  /// Goes from a point to its farthest, from there to its farthest, while that makes the best pair
  /// longer; returns whether another pair is the best now, be it as long.
  bool walkFrom(std::size_t start) {
    const FarthestPair before = best_;
    for (std::size_t from = start;;) {
      const double reached = best_.squared_distance;
      const FarPoint farthest = kernels().farthestFrom(points_, count_, plain(at(from)));
      note(pairOf(from, farthest.index, farthest.squared_distance));
      if (farthest.squared_distance <= reached) return isBetter(best_, before);
      from = farthest.index;
    }
  }

  /// With respect to the ball whose diameter is the best pair.
  double power(const Eigen::Vector3d& place) const {
    return (place - at(best_.first)).dot(place - at(best_.second));
  }

  /// More than rounding takes from a power, or from a square as long as the best pair's: ties must
  /// not fall through.
  double slack() const {
    using Limits = std::numeric_limits<double>;
    return 64.0 * (Limits::epsilon() * best_.squared_distance + Limits::denorm_min());
  }

  /// Those of a power of at least `least`.
  Indices pointsOfPower(double least) const {
    Indices all(count_);
    all.resize(kernels().listByPower(points_, count_, plain(at(best_.first)),
                                     plain(at(best_.second)), least, all.data()));
    return all;
  }

  /// The points other than the best pair's that can be an end of a pair as long as the best or
  /// longer: those not inside the ball.
  std::vector<End> endsOutsideBall() const {
    const Indices outside = pointsOfPower(-slack());
    std::vector<End> ends;
    ends.reserve(outside.size());
    for (const std::uint32_t i : outside) {
      if (i != best_.first && i != best_.second) ends.push_back({at(i), i});
    }
    return ends;
  }

  /// The points that can be the other end of such a pair: they are as far from the ball's middle as
  /// the pair is long, less how far the one end is, which has at most that power.
  Members farEnoughFor(double largest_power) const {
    const double squared_radius = best_.squared_distance / 4.0;
    const double reach = std::sqrt(squared_radius + largest_power + slack());
    const double rest = std::sqrt(best_.squared_distance) - reach;
    return {points_, pointsOfPower(rest * rest - squared_radius - slack())};
  }

  /// Compares each end with all others that may be as far from it as the best pair is long.
  /// Recursion is safe, as it takes the smaller part.
  void pairUp(Range ends, const Members& all) {
    std::optional<Members> left;
    const Members* others = &all;
    while (ends.size() > kFewPoints && others->size() >= kLaneCount) {
      Box box;
      std::size_t lowest = count_;
      for (const End& end : ends) {
        box.add(end.place);
        lowest = std::min(lowest, end.index);
      }
      const double best = best_.squared_distance;
      const bool tie_may_win = isBetter(pairOf(lowest, others->index(0), best), best_);
      left = others->farFrom(
          box, tie_may_win ? best : std::nextafter(best, std::numeric_limits<double>::infinity()));
      others = &*left;
      const auto middle = halve(ends, box);
      Range smaller = {ends.begin(), middle};
      Range larger = {middle, ends.end()};
      if (smaller.size() > larger.size()) std::swap(smaller, larger);
      pairUp(smaller, *others);
      ends = larger;
    }
    compare(ends, *others);
  }

  /// In the middle of their box; where that leaves few on one side, by number.
  static std::vector<End>::iterator halve(const Range& ends, const Box& box) {
    Eigen::Index axis = 0;
    (box.high - box.low).maxCoeff(&axis);
    const double middle = 0.5 * box.low[axis] + 0.5 * box.high[axis];
    const auto cut = std::partition(ends.begin(), ends.end(), [axis, middle](const End& end) {
      return end.place[axis] < middle;
    });
    const std::ptrdiff_t few = static_cast<std::ptrdiff_t>(ends.size() / 4);
    if (cut - ends.begin() > few && ends.end() - cut > few) return cut;
    const auto half = ends.begin() + (ends.end() - ends.begin()) / 2;
    std::nth_element(ends.begin(), half, ends.end(), [axis](const End& a, const End& b) {
      return std::tie(a.place[axis], a.index) < std::tie(b.place[axis], b.index);
    });
    return half;
  }

  void compare(const Range& ends, const Members& others) {
    if (others.size() == 0) return;
    for (const End& end : ends) {
      if (!others.reach(end.place, best_.squared_distance)) continue;
      const FarPoint farthest = others.farthestFrom(end.place);
      note(pairOf(end.index, farthest.index, farthest.squared_distance));
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
