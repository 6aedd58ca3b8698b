#pragma once

#include <Eigen/Core>
#include <optional>

namespace organ_collision::core {

/// v x w, each coordinate with a relative error of at most 1.5 * 2^-52, however nearly parallel
/// they are. Source: W. Kahan, "Mathematics written in sand" (1983), for the difference of
/// products.
Eigen::Vector3d accurateCross(const Eigen::Vector3d& v, const Eigen::Vector3d& w);

/// The (s, t) for which s*e1 + t*e2 is the projection of `v` on the plane along `e1` and `e2`;
/// nothing where these are parallel, as far as rounding can tell. Accurate for every angle between
/// them; corrected once where little of v is left over, so that what is left is right.
std::optional<Eigen::Vector2d> planeCoordinates(const Eigen::Vector3d& v, const Eigen::Vector3d& e1,
                                                const Eigen::Vector3d& e2);

}  // namespace organ_collision::core
