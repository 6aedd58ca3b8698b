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
