#pragma once

#include <Eigen/Core>
#include <cmath>

#include "organ_collision/core/triangle.h"

// What rounding takes of differences and sums.
// Source: D. Knuth, "The Art of Computer Programming" 2 (1969), 4.2.2.
namespace organ_collision::core {

/// Of offset = end - start, exactly but for underflow.
inline Eigen::Vector3d lostOf(const Eigen::Vector3d& offset, const Eigen::Vector3d& end,
                              const Eigen::Vector3d& start) {
  const Eigen::Vector3d back = offset - end;
  return (end - (offset - back)) - (start + back);
}

/// The same, to be added to a step from there, whose squared length is about `squared_step` at
/// most. Nothing where that is long: all else that rounding takes is then less beside the extent,
/// and such a step leads to what is nearest from where rounding has put the offset.
inline Eigen::Vector3d lostOf(const Eigen::Vector3d& offset, const Eigen::Vector3d& end,
                              const Eigen::Vector3d& start, double squared_step) {
  const double share = squared_step < squaredLength(offset) ? 1.0 : 0.0;
  return share * lostOf(offset, end, start);
}

/// A sum of which hardly anything may be left, with what rounding takes of it.
class AccurateSum {
 public:
  /// end - start.
  AccurateSum(const Eigen::Vector3d& end, const Eigen::Vector3d& start)
      : sum_(end - start), lost_(lostOf(sum_, end, start)) {}

  /// weight * (end - start).
  void add(double weight, const Eigen::Vector3d& end, const Eigen::Vector3d& start) {
    const Eigen::Vector3d edge = end - start;
    const Eigen::Vector3d product = weight * edge;
    for (int i = 0; i < 3; ++i) lost_[i] += std::fma(weight, edge[i], -product[i]);
    lost_ += weight * lostOf(edge, end, start);
    const Eigen::Vector3d before = sum_;
    sum_ += product;
    lost_ += lostOf(sum_, before, -product);
  }

  Eigen::Vector3d value() const { return sum_ + lost_; }

 private:
  Eigen::Vector3d sum_, lost_;
};

}  // namespace organ_collision::core
