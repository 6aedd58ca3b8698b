#pragma once

#include "core/kernels/lane_vector.h"

// Vectors from a tip, eight at a time: the shortest of several, and those that separate it from
// bodies.
namespace organ_collision::core {
namespace {

/// Shorter directions tell nothing: their squares underflow in single precision.
constexpr float kShortestSquare = 0x1p-100F;

template <class Real>
inline LaneVector<Real> select(const Truth<Real>& truth, const LaneVector<Real>& a,
                               const LaneVector<Real>& b) {
  return {select(truth, a.x, b.x), select(truth, a.y, b.y), select(truth, a.z, b.z)};
}

/// The shortest vector found so far from the tip to each triangle.
template <class Real>
struct Shortest {
  LaneVector<Real> offset;
  Lanes<Real> squared;

  explicit Shortest(const LaneVector<Real>& first) : offset(first), squared(dot(first, first)) {}

  void consider(const LaneVector<Real>& other, const Truth<Real>& valid) {
    const Lanes<Real> squared_other = dot(other, other);
    const Truth<Real> shorter = (squared_other <= squared) & valid;
    offset = select(shorter, other, offset);
    squared = select(shorter, squared_other, squared);
  }
  /// What is not a number is not shorter.
  void consider(const LaneVector<Real>& other) {
    const Lanes<Real> squared_other = dot(other, other);
    offset = select(squared_other <= squared, other, offset);
    squared = smaller(squared_other, squared);  // the second where the first is not a number
  }
};

/// Separating axes from a tip, of whatever lengths, and how far they keep what lies there from it.
template <class Real>
struct SeparatingAxes {
  LaneVector<Real> axis;
  Lanes<Real> gap;
};

/// Planes that keep bodies from a tip: unit vectors towards the tip, and how far they are from it;
/// the vectors mean nothing unless that is above 0.
template <class Real>
struct Planes {
  LaneVector<Real> direction;
  Lanes<Real> gap;
};

/// A gap along a direction that is `length` long times that length, as a distance.
template <class Real>
inline Lanes<Real> distanceOfGap(const Lanes<Real>& gap, const Lanes<Real>& squared_length) {
  const Lanes<Real> none{};
  return select(Lanes<Real>::all(Real{kShortestSquare}) <= squared_length,
                larger(gap, none) / root(squared_length), none);
}

}  // namespace
}  // namespace organ_collision::core
