#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>

#include "organ_collision/core/triangle.h"

namespace organ_collision::core {

/// Axis-aligned box [m]. Empty until something is added.
struct Box {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;

  void add(const Eigen::Vector3d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  void add(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  bool contains(const Eigen::Vector3d& point) const {
    return (low - point).cwiseMax(point - high).maxCoeff() <= 0.0;
  }
};

/// Around three points, and around a triangle.
inline Box boxOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return {a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
}
inline Box boxOf(const Triangle& triangle) { return boxOf(triangle.a, triangle.b, triangle.c); }

inline std::array<Eigen::Vector3d, 8> cornersOf(const Box& box) {
  std::array<Eigen::Vector3d, 8> corners;
  for (unsigned corner = 0; corner < corners.size(); ++corner)
    corners[corner] = {(corner & 1U) != 0 ? box.high.x() : box.low.x(),
                       (corner & 2U) != 0 ? box.high.y() : box.low.y(),
                       (corner & 4U) != 0 ? box.high.z() : box.low.z()};
  return corners;
}

/// Whether they have a point in common.
inline bool meet(const Box& first, const Box& second) {
  return (first.low.array() <= second.high.array()).all() &&
         (second.low.array() <= first.high.array()).all();
}

/// A bound [m^2] that no squared distance between points of the two boxes falls below, in computed
/// arithmetic too: every step is monotone under rounding.
inline double squaredDistance(const Box& first, const Box& second) {
  const Eigen::Vector3d gap =
      (second.low - first.high).cwiseMax(first.low - second.high).cwiseMax(Eigen::Vector3d::Zero());
  return squaredLength(gap);
}

inline double squaredDistance(const Box& box, const Eigen::Vector3d& point) {
  const Eigen::Vector3d gap =
      (box.low - point).cwiseMax(point - box.high).cwiseMax(Eigen::Vector3d::Zero());
  return squaredLength(gap);
}

}  // namespace organ_collision::core
