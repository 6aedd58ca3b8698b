#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace organ_collision::core {

using Points = std::vector<Eigen::Vector3d>;

/// Corner positions [m].
struct Triangle {
  Eigen::Vector3d a, b, c;
};

inline std::array<Eigen::Vector3d, 3> cornersOf(const Triangle& triangle) {
  return {triangle.a, triangle.b, triangle.c};
}

/// The largest magnitude of a coordinate.
inline double largestCoordinate(const Eigen::Vector3d& v) { return v.cwiseAbs().maxCoeff(); }
inline double largestCoordinate(const Triangle& t) {
  return t.a.cwiseAbs().cwiseMax(t.b.cwiseAbs()).cwiseMax(t.c.cwiseAbs()).maxCoeff();
}

/// x^2 + y^2 + z^2, evaluated in one fixed order: never less than the same sum over smaller
/// magnitudes.
inline double squaredLength(const Eigen::Vector3d& v) {
  return (v.x() * v.x() + v.y() * v.y()) + v.z() * v.z();
}

}  // namespace organ_collision::core
