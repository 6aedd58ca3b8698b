#include "core/plane_coordinates.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace organ_collision::core {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// x*y - z*w with a relative error of at most 1.5 * 2^-52.
double differenceOfProducts(double x, double y, double z, double w) {
  const double zw = z * w;
  return std::fma(x, y, -zw) + std::fma(-z, w, zw);
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

double normalisingFactor(double largest) {
  return std::ldexp(1.0, std::clamp(-std::ilogb(largest), -1000, 1000));
}

Vector3d accurateCross(const Vector3d& v, const Vector3d& w) {
  return {differenceOfProducts(v.y(), w.z(), v.z(), w.y()),
          differenceOfProducts(v.z(), w.x(), v.x(), w.z()),
          differenceOfProducts(v.x(), w.y(), v.y(), w.x())};
}

std::optional<Vector2d> accuratePlaneCoordinates(const Vector3d& v, const Vector3d& e1,
                                                 const Vector3d& e2) {
  const double longest = std::max(squaredLength(e1), squaredLength(e2));
  if (longest < kShortestSafe || longest > kLongestSafe) {
    if (e1.isZero(0) && e2.isZero(0)) return std::nullopt;
    const double factor = normalisingFactor(std::max(largestCoordinate(e1), largestCoordinate(e2)));
    return accuratePlaneCoordinates(factor * v, factor * e1, factor * e2);
  }
  const Plane plane = planeOf(e1, e2);
  if (plane.squared_normal == 0) return std::nullopt;
  const Vector2d weights = plane.coordinates(v);
  const Vector3d rest = v - (weights.x() * e1 + weights.y() * e2);
  if (squaredLength(rest) > kNearlyNothing * squaredLength(v)) return weights;
  return weights + plane.coordinates(rest);
}

}  // namespace organ_collision::core
