#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "organ_collision/core/farthest_pair.h"
#include "organ_collision/core/triangle.h"

namespace organ_collision::core {

/// A few points and the distances between them, taken once, in an order that splits change.
class FewPoints {
 public:
  static constexpr std::uint32_t kMost = 8;
  struct Split {
    std::array<std::uint32_t, 2> poles;  ///< as numbered at first
    std::uint32_t first_size;
  };

  FewPoints(const PointColumns& points, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      order_[i] = i;
      for (std::uint32_t j = 0; j <= i; ++j) {
        const Eigen::Vector3d apart(points.x[i] - points.x[j], points.y[i] - points.y[j],
                                    points.z[i] - points.z[j]);
        squared_distances_[i][j] = squared_distances_[j][i] = squaredLength(apart);
      }
    }
  }

  std::uint32_t operator[](std::uint32_t place) const { return order_[place]; }

  /// Of those from one place to another, puts the ones that are nearer to the first of the two
  /// farthest in front; in halves, if all coincide. REQUIRES: two points or more.
  Split split(std::uint32_t begin, std::uint32_t end) {
    const std::uint32_t half = (end - begin) / 2;
    Split split = {{order_[begin], order_[begin + half]}, half};
    if (end - begin == 2) return split;
    double farthest = 0.0;
    for (std::uint32_t i = begin; i < end; ++i) {
      for (std::uint32_t j = i + 1; j < end; ++j) {
        const double squared_distance = squared_distances_[order_[i]][order_[j]];
        if (squared_distance <= farthest) continue;
        farthest = squared_distance;
        split.poles = {order_[i], order_[j]};
      }
    }
    if (farthest == 0.0) return split;
    const auto is_first = [&](std::uint32_t point) {
      return squared_distances_[point][split.poles[0]] < squared_distances_[point][split.poles[1]];
    };
    std::array<std::uint32_t, kMost> others;
    std::uint32_t next = begin;
    std::uint32_t other_count = 0;
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint32_t point = order_[i];
      const bool first = is_first(point);
      order_[next] = point;  // to both places, as no branch could be foreseen
      others[other_count] = point;
      next += first ? 1 : 0;
      other_count += first ? 0 : 1;
    }
    std::copy_n(others.begin(), other_count, order_.begin() + next);
    split.first_size = next - begin;
    return split;
  }

 private:
  std::array<std::uint32_t, kMost> order_ = {};
  std::array<std::array<double, kMost>, kMost> squared_distances_;
};

}  // namespace organ_collision::core
