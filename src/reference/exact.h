#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "organ_collision/core/box.h"
#include "organ_collision/core/triangle_mesh.h"

/// What the library should answer, in exact rational arithmetic: slow, and as plain as can be. For
/// tests and for measuring.
namespace organ_collision::core::exact {

using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<>,
                                              boost::multiprecision::et_off>;
using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>,
                                           boost::multiprecision::et_off>;

/// A rational number; never reduced.
struct Fraction {
  Integer numerator = 0;
  Integer denominator = 1;  ///< > 0
};

inline bool operator<(const Fraction& left, const Fraction& right) {
  return left.numerator * right.denominator < right.numerator * left.denominator;
}

struct Vector {
  Integer x, y, z;
};

inline Vector operator-(const Vector& v, const Vector& w) {
  return {v.x - w.x, v.y - w.y, v.z - w.z};
}
inline Vector operator+(const Vector& v, const Vector& w) {
  return {v.x + w.x, v.y + w.y, v.z + w.z};
}
inline Vector operator*(const Integer& s, const Vector& v) { return {s * v.x, s * v.y, s * v.z}; }
inline Integer dot(const Vector& v, const Vector& w) { return v.x * w.x + v.y * w.y + v.z * w.z; }
inline Vector cross(const Vector& v, const Vector& w) {
  return {v.y * w.z - v.z * w.y, v.z * w.x - v.x * w.z, v.x * w.y - v.y * w.x};
}
inline bool isZero(const Vector& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

using Corners3 = std::array<Vector, 3>;

/// The multiples of a power of two: coarse enough for small numbers, fine enough for all points
/// given.
class Lattice {
 public:
  explicit Lattice(const std::vector<Eigen::Vector3d>& points) {
    for (const Eigen::Vector3d& point : points) {
      for (const double x : {point.x(), point.y(), point.z()}) {
        if (x != 0) exponent_ = std::min(exponent_, std::ilogb(x) - 52);
      }
    }
    if (exponent_ == std::numeric_limits<int>::max()) exponent_ = 0;
  }

  Vector operator()(const Eigen::Vector3d& point) const {
    return {integer(point.x()), integer(point.y()), integer(point.z())};
  }
  Corners3 operator()(const Triangle& triangle) const {
    return {(*this)(triangle.a), (*this)(triangle.b), (*this)(triangle.c)};
  }
  /// The square root of a squared length, in metres.
  Real length(const Fraction& squared) const {
    return ldexp(sqrt(Real(squared.numerator) / Real(squared.denominator)), exponent_);
  }

 private:
  Integer integer(double x) const {
    if (x == 0) return 0;
    const int lowest_bit = std::ilogb(x) - 52;
    const auto mantissa = static_cast<long long>(std::ldexp(std::ldexp(x, -std::ilogb(x)), 52));
    return Integer(mantissa) * (Integer(1) << (lowest_bit - exponent_));
  }

  int exponent_ = std::numeric_limits<int>::max();  ///< of the lattice's step [m]
};

inline Fraction squaredDistanceToSegment(const Vector& query, const Vector& p, const Vector& q) {
  const Vector edge = q - p;
  const Vector v = query - p;
  const Integer along = dot(v, edge);
  const Integer squared = dot(edge, edge);
  if (along <= 0) return {dot(v, v), 1};
  if (along >= squared) return {dot(query - q, query - q), 1};
  return {dot(v, v) * squared - along * along, squared};
}

inline Fraction squaredDistanceToTriangle(const Vector& query, const Corners3& t) {
  Fraction best = squaredDistanceToSegment(query, t[0], t[1]);
  best = std::min(best, squaredDistanceToSegment(query, t[1], t[2]));
  best = std::min(best, squaredDistanceToSegment(query, t[2], t[0]));
  const Vector normal = cross(t[1] - t[0], t[2] - t[0]);
  if (isZero(normal)) return best;
  for (int i = 0; i < 3; ++i) {
    const Vector& from = t[static_cast<std::size_t>(i)];
    const Vector& to = t[static_cast<std::size_t>((i + 1) % 3)];
    if (dot(cross(to - from, query - from), normal) < 0) return best;
  }
  const Integer height = dot(query - t[0], normal);
  return {height * height, dot(normal, normal)};
}

/// Where the closest points of the two lines lie inside both segments: their squared distance.
inline std::optional<Fraction> squaredDistanceInsideSegments(const Vector& p, const Vector& q,
                                                             const Vector& r, const Vector& s) {
  const Vector d = q - p;
  const Vector e = s - r;
  const Vector v = r - p;
  const Vector normal = cross(d, e);
  if (isZero(normal)) return std::nullopt;
  const Integer squared = dot(normal, normal);
  const Integer on_first = dot(cross(v, e), normal);
  const Integer on_second = dot(cross(v, d), normal);
  if (on_first < 0 || on_first > squared || on_second < 0 || on_second > squared)
    return std::nullopt;
  const Integer height = dot(v, normal);
  return Fraction{height * height, squared};
}

/// True where segment pq passes strictly through the triangle's plane at a point of the triangle.
inline bool pierces(const Vector& p, const Vector& q, const Corners3& t) {
  const Vector normal = cross(t[1] - t[0], t[2] - t[0]);
  const Integer height_p = dot(p - t[0], normal);
  const Integer height_q = dot(q - t[0], normal);
  if (!((height_p < 0 && height_q > 0) || (height_p > 0 && height_q < 0))) return false;
  // p + (q - p) * height_p / (height_p - height_q), everything times the denominator
  const Integer denominator = height_p - height_q;
  const Vector x = denominator * p + height_p * (q - p);
  return squaredDistanceToTriangle(x, {denominator * t[0], denominator * t[1], denominator * t[2]})
             .numerator == 0;
}

inline Fraction squaredDistance(const Corners3& first, const Corners3& second) {
  Fraction best = squaredDistanceToTriangle(first[0], second);
  for (std::size_t i = 0; i < 3; ++i) {
    best = std::min(best, squaredDistanceToTriangle(first[i], second));
    best = std::min(best, squaredDistanceToTriangle(second[i], first));
    const Vector& p = first[i];
    const Vector& q = first[(i + 1) % 3];
    if (pierces(p, q, second) || pierces(second[i], second[(i + 1) % 3], first)) return {0, 1};
    for (std::size_t j = 0; j < 3; ++j) {
      const auto inside = squaredDistanceInsideSegments(p, q, second[j], second[(j + 1) % 3]);
      if (inside) best = std::min(best, *inside);
    }
  }
  return best;
}

/// [m]
inline Real distance(const Eigen::Vector3d& query, const Triangle& triangle) {
  const Lattice lattice({query, triangle.a, triangle.b, triangle.c});
  return lattice.length(squaredDistanceToTriangle(lattice(query), lattice(triangle)));
}

/// [m] 0 exactly where they intersect.
inline Real distance(const Triangle& first, const Triangle& second) {
  const Lattice lattice({first.a, first.b, first.c, second.a, second.b, second.c});
  return lattice.length(squaredDistance(lattice(first), lattice(second)));
}

inline bool intersect(const Triangle& first, const Triangle& second) {
  return distance(first, second) == 0;
}

inline int sign(const Integer& x) { return x < 0 ? -1 : (x > 0 ? 1 : 0); }

inline int orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                       const Eigen::Vector3d& d) {
  const Lattice lattice({a, b, c, d});
  const Vector origin = lattice(a);
  return sign(dot(cross(lattice(b) - origin, lattice(c) - origin), lattice(d) - origin));
}

inline bool collinear(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                      const Eigen::Vector3d& c) {
  const Lattice lattice({a, b, c});
  return isZero(cross(lattice(b) - lattice(a), lattice(c) - lattice(a)));
}

/// The triangle of a mesh that is nearest to a point.
struct Nearest {
  TriangleId triangle;
  Real distance;  ///< [m]
};

/// Those triangles whose boxes are not farther from `point` than some corner is: the nearest is
/// among them.
inline std::vector<TriangleId> candidates(const TriangleMesh& mesh, const Eigen::Vector3d& point) {
  constexpr double kRounding = 1 + 0x1p-48;  // of squared lengths: twice six roundings are less
  double reach = std::numeric_limits<double>::infinity();  // [m^2]
  for (const Corners& corners : mesh.triangles()) {
    reach = std::min(reach, squaredLength(mesh.position(corners[0]) - point));
  }
  std::vector<TriangleId> result;
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const auto id = static_cast<TriangleId>(i);
    if (squaredDistance(boxOf(mesh.triangle(id)), point) <= kRounding * reach) result.push_back(id);
  }
  return result;
}

inline Nearest nearest(const TriangleMesh& mesh, const Eigen::Vector3d& point) {
  const std::vector<TriangleId> near = candidates(mesh, point);
  std::vector<Eigen::Vector3d> points = {point};
  for (const TriangleId id : near) {
    const Triangle triangle = mesh.triangle(id);
    points.insert(points.end(), {triangle.a, triangle.b, triangle.c});
  }
  const Lattice lattice(points);
  TriangleId best = near.front();
  Fraction least = squaredDistanceToTriangle(lattice(point), lattice(mesh.triangle(best)));
  for (const TriangleId id : near) {
    const Fraction squared = squaredDistanceToTriangle(lattice(point), lattice(mesh.triangle(id)));
    if (!(squared < least)) continue;
    best = id;
    least = squared;
  }
  return {best, lattice.length(least)};
}

/// How a ray from the origin meets a triangle: +1 or -1 where it leaves through it with or against
/// its normal, 0 where it misses it, nothing where it meets an edge or runs in the plane.
/// REQUIRES: the triangle has an area, and the origin is not on it.
inline std::optional<int> crossing(const Vector& ray, const Corners3& t) {
  const std::array<int, 3> sides = {sign(dot(ray, cross(t[0], t[1]))),
                                    sign(dot(ray, cross(t[1], t[2]))),
                                    sign(dot(ray, cross(t[2], t[0])))};
  const auto [least, most] = std::minmax_element(sides.begin(), sides.end());
  if (*least < 0 && *most > 0) return 0;
  if (*least == 0 || *most == 0) return std::nullopt;
  return sides[0] == sign(dot(t[0], cross(t[1], t[2]))) ? sides[0] : 0;
}

/// How often a closed surface winds around `point`, which is not on it: what a ray that meets no
/// edge crosses.
inline int windingNumber(const TriangleMesh& mesh, const Eigen::Vector3d& point) {
  std::vector<Eigen::Vector3d> points = mesh.positions();
  points.push_back(point);
  const Lattice lattice(points);
  const Vector origin = lattice(point);
  std::vector<Corners3> triangles;
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const Corners3 t = lattice(mesh.triangle(static_cast<TriangleId>(i)));
    if (isZero(cross(t[1] - t[0], t[2] - t[0]))) continue;
    triangles.push_back({t[0] - origin, t[1] - origin, t[2] - origin});
  }
  std::mt19937 generator(1);
  const auto coordinate = [&generator] { return Integer(generator()) - 0x80000000LL; };
  for (;;) {
    const Vector ray = {coordinate(), coordinate(), coordinate()};
    int winding = 0;
    const bool is_clear = std::all_of(triangles.begin(), triangles.end(), [&](const auto& t) {
      const std::optional<int> turns = crossing(ray, t);
      winding += turns.value_or(0);
      return turns.has_value();
    });
    if (is_clear) return winding;
  }
}

}  // namespace organ_collision::core::exact
