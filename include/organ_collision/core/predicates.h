#pragma once

#include <Eigen/Core>

namespace organ_collision::core {

/// The signs below (-1, 0, +1) are exact for finite coordinates below kLargestCoordinate, whatever
/// cancels, as long as the coordinates do not span more than 2^300 among themselves.
/// Cost: some 5 ns; where rounding leaves a doubt, half a microsecond and more
/// (benchmark/triangle_benchmark).
/// Source: J. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
/// predicates" (1997).

/// Of the determinant |b-a, c-a, d-a|: positive where d is on the side of plane abc from which a,
/// b, c run anticlockwise.
int orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                const Eigen::Vector3d& d);

/// Of the determinant |b-a, c-a|: positive where a, b, c run anticlockwise.
int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

/// `v` as seen along coordinate axis 0, 1 or 2: the other two coordinates, right-handed.
inline Eigen::Vector2d alongAxis(const Eigen::Vector3d& v, int axis) {
  return {v[(axis + 1) % 3], v[(axis + 2) % 3]};
}

/// True where a, b and c lie on one line, coincide included; exact.
bool collinear(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace organ_collision::core
