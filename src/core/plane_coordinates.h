#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "organ_collision/core/triangle.h"

namespace organ_collision::core {

/// A power of two that brings the largest coordinate, which must not be 0, near 1.
double normalisingFactor(double largest);

/// v x w, each coordinate with a relative error of at most 1.5 * 2^-52, however nearly parallel
/// they are. Source: W. Kahan, "Mathematics written in sand" (1983), for the difference of
/// products.
Eigen::Vector3d accurateCross(const Eigen::Vector3d& v, const Eigen::Vector3d& w);

/// Between these squared lengths products of four lengths neither overflow nor underflow.
constexpr double kShortestSafe = 0x1p-200;
constexpr double kLongestSafe = 0x1p+200;
/// sin^2 of 30 degrees: plain products are accurate enough for edges further from parallel.
constexpr double kWellShaped = 0.25;
/// Where 2^-20 of a vector or less is left over, rounding errors along the plane are not lost in
/// it.
constexpr double kNearlyNothing = 0x1p-40;

inline bool isSafe(double squared_length) {
  return squared_length > kShortestSafe && squared_length < kLongestSafe;
}

/// planeCoordinates() where that is so simple that plain products are accurate enough; else
/// nothing.
inline std::optional<Eigen::Vector2d> plainPlaneCoordinates(const Eigen::Vector3d& v,
                                                            const Eigen::Vector3d& e1,
                                                            const Eigen::Vector3d& e2) {
  const double squared1 = squaredLength(e1);
  const double squared2 = squaredLength(e2);
  const Eigen::Vector3d normal = e1.cross(e2);
  const double squared_normal = squaredLength(normal);
  if (!isSafe(squared1) || !isSafe(squared2) ||
      !(squared_normal > kWellShaped * squared1 * squared2))
    return std::nullopt;
  const Eigen::Vector2d weights =
      Eigen::Vector2d{v.cross(e2).dot(normal), e1.cross(v).dot(normal)} / squared_normal;
  const Eigen::Vector3d rest = v - (weights.x() * e1 + weights.y() * e2);
  if (!(squaredLength(rest) > kNearlyNothing * squaredLength(v))) return std::nullopt;
  return weights;
}

/// planeCoordinates() of whatever edges.
std::optional<Eigen::Vector2d> accuratePlaneCoordinates(const Eigen::Vector3d& v,
                                                        const Eigen::Vector3d& e1,
                                                        const Eigen::Vector3d& e2);

/// The (s, t) for which s*e1 + t*e2 is the projection of `v` on the plane along `e1` and `e2`;
/// nothing where these are parallel, as far as rounding can tell. Accurate for every angle between
/// them; corrected once where little of v is left over, so that what is left is right.
inline std::optional<Eigen::Vector2d> planeCoordinates(const Eigen::Vector3d& v,
                                                       const Eigen::Vector3d& e1,
                                                       const Eigen::Vector3d& e2) {
  const std::optional<Eigen::Vector2d> plain = plainPlaneCoordinates(v, e1, e2);
  return plain ? plain : accuratePlaneCoordinates(v, e1, e2);
}

}  // namespace organ_collision::core
