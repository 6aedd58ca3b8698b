#pragma once

#include "core/kernels/lane_vector.h"

// Lower bounds of distances, and what rounding takes from them.
//
// Rounding. A bound must not exceed the distance that the exact measurement would give. Everything
// is relative to an origin: let r be the radius around it, d the sum of the tip's coordinates'
// magnitudes there, u the unit roundoff of Real, v that of single precision, in which boxes and
// triangles are kept. Rounding moves the tip by u*d, turning it adds 3*u*d; stored corners are off
// by 24*v*r; a point of an edge is found, along it, to 3*u*(d + r) + 8*u*r, and its distance to
// 3*u*(d + 4*r). Together below 16*u*d + 64*(u + v)*r, which every bound gives away; that also
// covers the 4*u*extent of the exact measurement, and the u*d by which the tip is rounded itself.
// Boxes of nodes are widened by what concerns r (node_boxes.h): there 16*u*d is enough, 4*r being a
// part of d. What is told of points and the triangles of packets is in packet_range.h.
// No length of a packet's triangle is below 2^-29 (fill.h), for which corners move by less than
// 2^-28. With a tip's edges, products of four edges, or of two and the square of a distance,
// underflow in single precision where edges are shorter than 2^-29 or edge times distance is below
// 2^-63; a point may then be taken to lie beside a face, which is wrong by less than the edge, or
// the face's normal be off by a third, which is wrong by less than 2^-27 (a normal that is not lost
// has edges of 2^-38 or more). Together below kTiny, which is given away too.
namespace organ_collision::core {
namespace {

constexpr double kInfinity = __builtin_huge_val();
constexpr float kFloatInfinity = __builtin_huge_valf();

template <class Real>
constexpr Real kRoundoff = sizeof(Real) == sizeof(float) ? Real{0x1p-24} : Real{0x1p-53};

constexpr float kTiny = 0x1p-26F;

/// Rounding a place to single precision moves it by less, as no coordinate is above 2.
constexpr float kPlaceRounding = 0x1p-23F;

/// Of a radius from squares: they are off by less.
constexpr float kRadiusRounding = 1.0F + 0x1p-16F;

/// A corner of the tip, relative to an origin.
template <class Real>
inline Vector<Real> relative(const Vector<Real>& tip, const std::array<float, 3>& origin) {
  return {tip.x - Real{origin[0]}, tip.y - Real{origin[1]}, tip.z - Real{origin[2]}};
}

/// The sum of the coordinates' magnitudes.
template <class Number>
inline Number reachOf(const Vector<Number>& v) {
  return magnitudeOf(v.x) + magnitudeOf(v.y) + magnitudeOf(v.z);
}

/// What a bound gives away; see above.
template <class Real>
inline Real roundingOf(Real tip_reach, float radius) {
  return 16 * kRoundoff<Real> * tip_reach +
         64 * (kRoundoff<Real> + Real{kRoundoff<float>}) * Real{radius} + Real{kTiny};
}

/// The gaps between lanes' boxes and a box, axis by axis, as one distance.
template <class Real>
[[gnu::always_inline]] inline Lanes<Real> squaredDistanceOf(const LaneVector<Real>& low,
                                                            const LaneVector<Real>& high,
                                                            const Vector<Real>& tip_low,
                                                            const Vector<Real>& tip_high) {
  const Lanes<Real> none{};
  const auto gap = [&none](const Lanes<Real>& lows, const Lanes<Real>& highs, Real from, Real to) {
    return larger(larger(lows - Lanes<Real>::all(to), Lanes<Real>::all(from) - highs), none);
  };
  const LaneVector<Real> gaps = {gap(low.x, high.x, tip_low.x, tip_high.x),
                                 gap(low.y, high.y, tip_low.y, tip_high.y),
                                 gap(low.z, high.z, tip_low.z, tip_high.z)};
  return dot(gaps, gaps);
}

template <class Real>
inline Lanes<Real> infinite() {
  return Lanes<Real>::all(Real{kFloatInfinity});
}

/// Squares of what is within a reach are not larger, whatever rounding does to them; within one
/// below zero there is nothing.
template <class Real>
inline Real squareOf(Real reach) {
  return reach > 0 ? reach * reach * (1 + 16 * kRoundoff<Real>) : Real{-1};
}

/// What is farther than this cannot improve on `best` by more than is allowed. `best` and the
/// allowance may both be infinite: then nothing is too far.
template <class Real>
inline Real allowedReach(Real best, Real share, Real allowance) {
  const Real less = best - allowance;
  const Real shared = best * share;
  return less < shared ? less : shared;
}

/// A bound in single precision that is not larger, and not below zero.
inline float inFloat(float bound) { return bound > 0.0F ? bound : 0.0F; }
inline float inFloat(double bound) {
  constexpr double kLargest = 0x1p127;
  return bound > 0.0 ? static_cast<float>((bound < kLargest ? bound : kLargest) * (1.0 - 0x1p-22))
                     : 0.0F;
}

}  // namespace
}  // namespace organ_collision::core
