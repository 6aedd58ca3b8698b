#pragma once

#include <Eigen/Core>
#include <optional>

namespace organ_collision::core {

/// v x w, each coordinate with a relative error of at most 1.5 * 2^-52, however nearly parallel
/// they are. Source: W. Kahan, "Mathematics written in sand" (1983), for the difference of
/// products.
Eigen::Vector3d accurateCross(const Eigen::Vector3d& v, const Eigen::Vector3d& w);

/// The t for which t*e is the projection of `v` on the line along `e`; NaN or infinite where the
/// square of e is 0. What is left of v is right to the last bits even where it nearly vanishes:
/// then t is corrected once.
double lineCoordinate(const Eigen::Vector3d& v, const Eigen::Vector3d& e);

/// The (s, t) for which s*e1 + t*e2 is the projection of `v` on the plane along `e1` and `e2`;
/// nothing where these are parallel, as far as rounding can tell. Corrected like lineCoordinate(),
/// accurate for every angle between e1 and e2.
std::optional<Eigen::Vector2d> planeCoordinates(const Eigen::Vector3d& v, const Eigen::Vector3d& e1,
                                                const Eigen::Vector3d& e2);

}  // namespace organ_collision::core
