#include "plane_coordinates.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "organ_collision/core/closest_point.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Between these squared lengths [m^2] the products of four lengths neither overflow nor underflow.
constexpr double kShortestSafe = 0x1p-200;
constexpr double kLongestSafe = 0x1p+200;
// sin^2 of 30 degrees: plain products are accurate enough for edges further from parallel.
constexpr double kWellShaped = 0.25;
// Where 2^-20 of a vector or less is left over, rounding errors along the plane are not lost in it.
constexpr double kNearlyNothing = 0x1p-40;

/// x*y - z*w with a relative error of at most 1.5 * 2^-52.
double differenceOfProducts(double x, double y, double z, double w) {
  const double zw = z * w;
  return std::fma(x, y, -zw) + std::fma(-z, w, zw);
}

/// A power of two that brings the largest coordinate near 1. REQUIRES: not all are 0.
double normalisingFactor(const Vector3d& e1, const Vector3d& e2) {
  const double largest = std::max(e1.lpNorm<Eigen::Infinity>(), e2.lpNorm<Eigen::Infinity>());
  return std::ldexp(1.0, std::clamp(-std::ilogb(largest), -1000, 1000));
}

/// The plane that two edges span.
struct Plane {
  const Vector3d& e1;
  const Vector3d& e2;
  Vector3d normal;
  double squared_normal;
  bool well_shaped;

  Vector2d coordinates(const Vector3d& v) const {
    const Vector3d s = well_shaped ? v.cross(e2) : accurateCross(v, e2);
    const Vector3d t = well_shaped ? e1.cross(v) : accurateCross(e1, v);
    return Vector2d{s.dot(normal), t.dot(normal)} / squared_normal;
  }
};

/// REQUIRES: the squares of the squared lengths of the edges neither overflow nor underflow.
Plane planeOf(const Vector3d& e1, const Vector3d& e2) {
  const Vector3d plain = e1.cross(e2);
  const double squared = squaredLength(plain);
  if (squared > kWellShaped * squaredLength(e1) * squaredLength(e2))
    return {e1, e2, plain, squared, true};
  const Vector3d accurate = accurateCross(e1, e2);
  return {e1, e2, accurate, squaredLength(accurate), false};
}

}  // namespace

Vector3d accurateCross(const Vector3d& v, const Vector3d& w) {
  return {differenceOfProducts(v.y(), w.z(), v.z(), w.y()),
          differenceOfProducts(v.z(), w.x(), v.x(), w.z()),
          differenceOfProducts(v.x(), w.y(), v.y(), w.x())};
}

std::optional<Vector2d> planeCoordinates(const Vector3d& v, const Vector3d& e1,
                                         const Vector3d& e2) {
  const double longest = std::max(squaredLength(e1), squaredLength(e2));
  if (longest < kShortestSafe || longest > kLongestSafe) {
    if (e1.isZero(0) && e2.isZero(0)) return std::nullopt;
    const double factor = normalisingFactor(e1, e2);
    return planeCoordinates(factor * v, factor * e1, factor * e2);
  }
  const Plane plane = planeOf(e1, e2);
  if (plane.squared_normal == 0) return std::nullopt;
  const Vector2d weights = plane.coordinates(v);
  const Vector3d rest = v - (weights.x() * e1 + weights.y() * e2);
  if (squaredLength(rest) > kNearlyNothing * squaredLength(v)) return weights;
  return weights + plane.coordinates(rest);
}

}  // namespace organ_collision::core
