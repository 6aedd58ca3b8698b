#pragma once

#include "core/kernels/lanes.h"
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

template <class T>
inline Vector<T> smaller(const Vector<T>& a, const Vector<T>& b) {
  return {smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z)};
}
template <class T>
inline Vector<T> larger(const Vector<T>& a, const Vector<T>& b) {
  return {larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z)};
}
template <class T>
inline Vector<T> magnitudesOf(const Vector<T>& v) {
  return {magnitudeOf(v.x), magnitudeOf(v.y), magnitudeOf(v.z)};
}

template <class Real, class Stored>
inline Vector<Real> vectorOf(const std::array<Stored, 3>& v) {
  return {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
}
template <class Real>
inline Vector<Real> laneOf(const LaneVector<Real>& v, std::uint32_t lane) {
  return {v.x[lane], v.y[lane], v.z[lane]};
}

template <class Real>
inline LaneVector<Real> load(const LanePoints& points) {
  return {Lanes<Real>::load(&points[0][0]), Lanes<Real>::load(&points[1][0]),
          Lanes<Real>::load(&points[2][0])};
}
inline void store(const LaneVector<float>& v, LanePoints& points) {
  v.x.store(points[0].data());
  v.y.store(points[1].data());
  v.z.store(points[2].data());
}
template <class Real>
inline LaneVector<Real> everywhere(const Vector<Real>& v) {
  return {Lanes<Real>::all(v.x), Lanes<Real>::all(v.y), Lanes<Real>::all(v.z)};
}

template <class Real>
inline Truth<Real> lanesInUse(const TrianglePacket& packet) {
  return Lanes<Real>::numbers() <= Lanes<Real>::all(static_cast<Real>(packet.lane_count) - 1);
}

/// Eight points, each aligned like four numbers, that are anywhere behind the first, by how many
/// bytes.
inline LaneVector<float> gather(const float* points,
                                const std::array<std::uint16_t, kLaneCount>& offsets) {
  using Four __attribute__((vector_size(16))) = float;
  const auto at = [first = reinterpret_cast<const char*>(points), &offsets](std::uint32_t i) {
    return *reinterpret_cast<const Four*>(first + offsets[i]);
  };
  LaneVector<float> lanes;
#if defined(__AVX__)
  const auto pair = [&at](std::uint32_t i) {  // by name: else gcc takes a dearer instruction
    const Four first = at(i);
    return __builtin_ia32_vinsertf128_ps256(
        __builtin_shufflevector(first, first, 0, 1, 2, 3, -1, -1, -1, -1), at(i + 4), 1);
  };
  const auto p0 = pair(0), p1 = pair(1), p2 = pair(2), p3 = pair(3);
  const auto xy0 = __builtin_shufflevector(p0, p1, 0, 8, 1, 9, 4, 12, 5, 13);
  const auto xy2 = __builtin_shufflevector(p2, p3, 0, 8, 1, 9, 4, 12, 5, 13);
  const auto z0 = __builtin_shufflevector(p0, p1, 2, 10, 3, 11, 6, 14, 7, 15);
  const auto z2 = __builtin_shufflevector(p2, p3, 2, 10, 3, 11, 6, 14, 7, 15);
  lanes.x.part[0] = __builtin_shufflevector(xy0, xy2, 0, 1, 8, 9, 4, 5, 12, 13);
  lanes.y.part[0] = __builtin_shufflevector(xy0, xy2, 2, 3, 10, 11, 6, 7, 14, 15);
  lanes.z.part[0] = __builtin_shufflevector(z0, z2, 0, 1, 8, 9, 4, 5, 12, 13);
#else
  for (std::uint32_t i = 0; i < 2; ++i) {
    const Four p0 = at(4 * i), p1 = at(4 * i + 1), p2 = at(4 * i + 2), p3 = at(4 * i + 3);
    const Four xy0 = __builtin_shufflevector(p0, p1, 0, 4, 1, 5);
    const Four xy2 = __builtin_shufflevector(p2, p3, 0, 4, 1, 5);
    const Four z0 = __builtin_shufflevector(p0, p1, 2, 6, 3, 7);
    const Four z2 = __builtin_shufflevector(p2, p3, 2, 6, 3, 7);
    lanes.x.part[i] = __builtin_shufflevector(xy0, xy2, 0, 1, 4, 5);
    lanes.y.part[i] = __builtin_shufflevector(xy0, xy2, 2, 3, 6, 7);
    lanes.z.part[i] = __builtin_shufflevector(z0, z2, 0, 1, 4, 5);
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

/// And back, but for the axes' being shorter than 1.
template <class Real>
inline LaneVector<Real> turnedBack(const WideNode& node, const LaneVector<Real>& v) {
  const auto along = [&](std::size_t i) {
    return Lanes<Real>::all(Real{node.axes[0][i]}) * v.x +
           Lanes<Real>::all(Real{node.axes[1][i]}) * v.y +
           Lanes<Real>::all(Real{node.axes[2][i]}) * v.z;
  };
  return {along(0), along(1), along(2)};
}

}  // namespace
}  // namespace organ_collision::core
