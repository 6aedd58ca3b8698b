#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::core {

constexpr double kUnit = 0x1p-53;  // u: half the relative distance of two doubles

/// The shapes that geometric kernels fail on.
enum class TriangleKind {
  kRandom,
  kNeedle,         ///< two corners nearly or wholly coincide
  kCap,            ///< three corners nearly or wholly on a line
  kFarFromOrigin,  ///< moved by 1e4
  kSmallAndFar,    ///< moved by 1e4, down to 1e-8 in size
  kMixedScale,     ///< each coordinate of its own magnitude, 1e-6 to 1e6
  kZeroArea,       ///< a point or a segment
  kLattice         ///< small integers: coplanar, collinear, shared corners
};

constexpr std::array<TriangleKind, 8> kTriangleKinds{
    TriangleKind::kRandom,        TriangleKind::kNeedle,      TriangleKind::kCap,
    TriangleKind::kFarFromOrigin, TriangleKind::kSmallAndFar, TriangleKind::kMixedScale,
    TriangleKind::kZeroArea,      TriangleKind::kLattice};

inline const char* name(TriangleKind kind) {
  constexpr std::array<const char*, 8> kNames{
      "random",        "needle",      "cap",       "far from the origin",
      "small and far", "mixed scale", "zero area", "lattice"};
  return kNames[static_cast<std::size_t>(kind)];
}

struct Sample {
  Eigen::Vector3d query;
  Triangle triangle;
};

/// A seeded stream of hard triangles, the query anywhere near or down to a rounding error away from
/// the surface.
class HardTriangles {
 public:
  explicit HardTriangles(std::uint64_t seed) : random_(seed) {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  /// In [10^low, 10^high].
  double magnitude(double low, double high) { return std::pow(10.0, uniform(low, high)); }
  bool oneIn(int n) { return uniform(0, n) < 1; }
  Eigen::Vector3d inCube() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }
  Eigen::Vector3d pointOf(const Triangle& triangle) {
    const double s = uniform(0, 1);
    const double t = uniform(0, 1 - s);
    return (1 - s - t) * triangle.a + s * triangle.b + t * triangle.c;
  }

  Triangle triangle(TriangleKind kind) {
    const Eigen::Vector3d a = inCube();
    const Eigen::Vector3d b = inCube();
    const Eigen::Vector3d c = inCube();
    const double along = uniform(-0.2, 1.2);
    const double size = magnitude(-8, 0);
    const Eigen::Vector3d step = inLattice();
    switch (kind) {
      case TriangleKind::kRandom:
        return {a, b, c};
      case TriangleKind::kNeedle:
        return {a, b, b + magnitude(-17, -1) * c};
      case TriangleKind::kCap:
        return {a, b, (1 - along) * a + along * b + magnitude(-17, -1) * c};
      case TriangleKind::kFarFromOrigin:
        return {kFar + a, kFar + b, kFar + c};
      case TriangleKind::kSmallAndFar:
        return {kFar + size * a, kFar + size * b, kFar + size * c};
      case TriangleKind::kMixedScale:
        return {a.cwiseProduct(magnitudes()), b.cwiseProduct(magnitudes()),
                c.cwiseProduct(magnitudes())};
      case TriangleKind::kZeroArea:
        if (oneIn(4)) return {a, a, a};
        if (oneIn(3)) return {a, b, a};
        if (oneIn(2)) return {-a, a, 0.5 * a};
        return {2 * step, std::floor(4 * along) * step, -3 * step};
      case TriangleKind::kLattice:
        return {inLattice(), inLattice(), inLattice()};
    }
    return {};
  }

  Sample sample(TriangleKind kind) {
    const Triangle triangle = this->triangle(kind);
    const double size = (triangle.b - triangle.a).norm();
    switch (static_cast<int>(uniform(0, 4))) {
      case 0:
        return {pointOf(triangle) + size * magnitude(-17, 0) * inCube(), triangle};
      case 1:
        return {triangle.a + uniform(0, 1) * (triangle.c - triangle.a) +
                    size * magnitude(-17, 0) * inCube(),
                triangle};
      case 2:
        return {triangle.a + magnitude(-8, 2) * inCube(), triangle};
      default:
        return {this->triangle(kind).a, triangle};
    }
  }

 private:
  inline static const Eigen::Vector3d kFar{7123.4, -1e4, 9876.5};

  Eigen::Vector3d magnitudes() { return {magnitude(-6, 6), magnitude(-6, 6), magnitude(-6, 6)}; }
  Eigen::Vector3d inLattice() {
    return {std::floor(uniform(-2, 3)), std::floor(uniform(-2, 3)), 0};
  }

  std::mt19937_64 random_;
};

inline Triangle scaled(const Triangle& t, double factor) {
  return {factor * t.a, factor * t.b, factor * t.c};
}

/// The triangle with its corners in order number 0 to 5.
inline Triangle reordered(const Triangle& t, int order) {
  const Triangle turned =
      order % 3 == 0 ? t : (order % 3 == 1 ? Triangle{t.b, t.c, t.a} : Triangle{t.c, t.a, t.b});
  return order < 3 ? turned : Triangle{turned.b, turned.a, turned.c};
}

}  // namespace organ_collision::core
