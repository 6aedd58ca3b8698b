#pragma once

#include "core/lanes.h"
#include "organ_collision/core/wide_node.h"

// Vectors of numbers, and of eight numbers at a time.
namespace organ_collision::core {
namespace {

template <class Real>
struct Vector {
  Real x, y, z;
};
template <class Real>
using LaneVector = Vector<Lanes<Real>>;

template <class T>
inline Vector<T> operator+(const Vector<T>& a, const Vector<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
inline Vector<T> operator-(const Vector<T>& a, const Vector<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
inline Vector<T> operator*(const T& t, const Vector<T>& a) {
  return {t * a.x, t * a.y, t * a.z};
}
template <class T>
inline T dot(const Vector<T>& a, const Vector<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
inline Vector<T> cross(const Vector<T>& a, const Vector<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class Real>
inline LaneVector<Real> load(const LanePoints& points) {
  return {Lanes<Real>::load(&points[0][0]), Lanes<Real>::load(&points[1][0]),
          Lanes<Real>::load(&points[2][0])};
}
template <class Real>
inline LaneVector<Real> everywhere(const Vector<Real>& v) {
  return {Lanes<Real>::all(v.x), Lanes<Real>::all(v.y), Lanes<Real>::all(v.z)};
}

/// Eight points that are anywhere in memory, at point(0), ... point(7), x, y, z after one another.
template <class Point>
inline LaneVector<double> gather(const Point& point) {
  LaneVector<double> lanes;
#if defined(__AVX__)
  using Four __attribute__((vector_size(32))) = double;
  using Mask __attribute__((vector_size(32))) = long long;
  const auto at = [&point](std::uint32_t i) -> Four {  // of the fourth, memory may have none
    return __builtin_ia32_maskloadpd256(reinterpret_cast<const Four*>(point(i)),
                                        Mask{-1, -1, -1, 0});
  };
#if defined(__AVX512F__)
  const auto pair = [&at](std::uint32_t i) {
    return __builtin_shufflevector(at(i), at(i + 4), 0, 1, 2, 3, 4, 5, 6, 7);
  };
  const auto xz = [](auto p, auto q) {
    return __builtin_shufflevector(p, q, 0, 8, 2, 10, 4, 12, 6, 14);
  };
  const auto y = [](auto p, auto q) {
    return __builtin_shufflevector(p, q, 1, 9, 3, 11, 5, 13, 7, 15);
  };
  const auto p0 = pair(0), p1 = pair(1), p2 = pair(2), p3 = pair(3);
  const auto xz0 = xz(p0, p1), xz2 = xz(p2, p3);
  lanes.x.part[0] = __builtin_shufflevector(xz0, xz2, 0, 1, 8, 9, 4, 5, 12, 13);
  lanes.y.part[0] = __builtin_shufflevector(y(p0, p1), y(p2, p3), 0, 1, 8, 9, 4, 5, 12, 13);
  lanes.z.part[0] = __builtin_shufflevector(xz0, xz2, 2, 3, 10, 11, 6, 7, 14, 15);
#else
  for (std::uint32_t i = 0; i < 2; ++i) {
    const Four p0 = at(4 * i), p1 = at(4 * i + 1), p2 = at(4 * i + 2), p3 = at(4 * i + 3);
    const Four xz0 = __builtin_shufflevector(p0, p1, 0, 4, 2, 6);
    const Four xz2 = __builtin_shufflevector(p2, p3, 0, 4, 2, 6);
    lanes.x.part[i] = __builtin_shufflevector(xz0, xz2, 0, 1, 4, 5);
    lanes.y.part[i] =
        __builtin_shufflevector(__builtin_shufflevector(p0, p1, 1, 5, 3, 7),
                                __builtin_shufflevector(p2, p3, 1, 5, 3, 7), 0, 1, 4, 5);
    lanes.z.part[i] = __builtin_shufflevector(xz0, xz2, 2, 3, 6, 7);
  }
#endif
#else
  constexpr std::uint32_t kPartLanes = Lanes<double>::kPartLanes;
  for (std::uint32_t i = 0; i < kLaneCount; ++i) {
    lanes.x.part[i / kPartLanes][i % kPartLanes] = point(i)[0];
    lanes.y.part[i / kPartLanes][i % kPartLanes] = point(i)[1];
    lanes.z.part[i / kPartLanes][i % kPartLanes] = point(i)[2];
  }
#endif
  return lanes;
}

/// Turned to a node's axes.
template <class Real>
inline Vector<Real> turned(const WideNode& node, const Vector<Real>& v) {
  const auto along = [&v](const std::array<float, 3>& axis) {
    return Real{axis[0]} * v.x + Real{axis[1]} * v.y + Real{axis[2]} * v.z;
  };
  return {along(node.axes[0]), along(node.axes[1]), along(node.axes[2])};
}

}  // namespace
}  // namespace organ_collision::core
