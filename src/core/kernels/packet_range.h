#pragma once

#include "core/kernels/bounds.h"
#include "core/kernels/lane_triangles.h"
#include "core/kernels/separation.h"

// The triangles of a packet: their boxes, and distances of points to them.
namespace organ_collision::core {
namespace {

/// The boxes of a packet's triangles, relative to its origin.
template <class Real>
inline void boxTriangles(const TrianglePacket& packet, LaneVector<Real>& low,
                         LaneVector<Real>& high) {
  const auto [a, ab, ac] = trianglesOf<Real>(packet);
  const LaneVector<Real> b = a + ab;
  const LaneVector<Real> c = a + ac;
  low = smaller(smaller(a, b), c);
  high = larger(larger(a, b), c);
}

/// Between which distances, squared, a tip's distances to the triangles of a packet lie, but for
/// what rounding takes.
template <class Real>
struct SquaredRange {
  Lanes<Real> low, high;
};

// Rounding, in the terms of bounds.h, for points. Of a triangle of size s <= r corners are off by
// 12*v*s (fill.h). Let d be how far the point is from the centroid: at most its distance and 2/3*s
// more. Its coordinates are off by 24*u*d, the axes being unit vectors but for 6*u and
// perpendicular but for 3*u; what is nearest in the plane by 14*u*d + 10*u*s. So distances are off
// by 38*u of themselves, and by 26*u*s + 10*u*s + 12*v*s. The exact measurement is, by 4*u of both.
// Together below 48*u of the distance and 64*v*r.

/// Of the squares of distances.
template <class Real>
constexpr Real kRangeRounding = 96 * kRoundoff<Real>;

/// Of distances, besides: to the triangles of a packet.
inline float roundingOf(const TrianglePacket& packet) {
  return 64 * kRoundoff<float> * packet.radius + kTiny;
}

/// Of eight triangles the points that are nearest to a point, in their frames.
template <class Real>
struct NearestInFrames {
  Lanes<Real> x, y;         ///< where the point is: along and up, from the foot
  LaneVector<Real> offset;  ///< from the point to the nearest: along, up, and along the normal
  Lanes<Real> squared;      ///< how long that is

  SquaredRange<Real> range() const {
    return {Lanes<Real>::all(1 - kRangeRounding<Real>) * squared,
            Lanes<Real>::all(1 + kRangeRounding<Real>) * squared};
  }

  /// Planes perpendicular to the offsets, which keep the triangles from the point; where none does,
  /// no gap.
  Planes<Real> planes(const LaneFrames<Real>& frames) const {
    const Lanes<Real> none{};
    const Lanes<Real> to_nearest_corner =
        smaller(smaller(none - offset.x * frames.before, offset.x * frames.beyond),
                offset.y * frames.height);
    const Lanes<Real> gap = to_nearest_corner -
                            (offset.x * x + offset.y * y - offset.z * offset.z) -
                            Lanes<Real>::all(kRangeRounding<Real>) * squared;
    const Lanes<Real> inverse = Lanes<Real>::all(1) / root(squared);
    const LaneVector<Real> direction = (none - inverse) * offset;
    return {direction.x * frames.along + direction.y * frames.up + direction.z * frames.normal(),
            select(Lanes<Real>::all(Real{kShortestSquare}) <= squared, inverse * gap, none)};
  }
};

/// On both sides of the foot a triangle has a right angle there. Of the two it is the one on the
/// point's side that is nearest to it: the same for both, as if they lay beyond the foot.
/// REQUIRES: orthonormal frames.
template <class Real>
[[gnu::always_inline]] inline NearestInFrames<Real> nearestInFrames(const LaneFrames<Real>& frames,
                                                                    const Vector<Real>& point) {
  const Lanes<Real> none{};
  const Lanes<Real> one = Lanes<Real>::all(1);
  const LaneVector<Real> offset = everywhere(point) - frames.centroid;
  const auto sum = [&offset](const Lanes<Real>& start, const LaneVector<Real>& axis) {
    return (start + offset.x * axis.x) + (offset.y * axis.y + offset.z * axis.z);
  };
  const Lanes<Real> x = sum(frames.xOfCentroid(), frames.along);
  const Lanes<Real> y = sum(frames.yOfCentroid(), frames.up);
  const Lanes<Real> z = dot(offset, frames.normal());
  const Truth<Real> is_before = x <= none;
  const Lanes<Real> width = select(is_before, frames.before, frames.beyond);
  const Lanes<Real>& height = frames.height;
  const Lanes<Real> beside = magnitudeOf(x) - width;  // of the end of the base
  const Lanes<Real> part =                            // of the slope, from there
      smaller(larger((y * height - beside * width) / (width * width + height * height), none), one);
  const Truth<Real> is_over_slope = (none <= y) & (none <= beside * height + y * width);
  const Lanes<Real> along =
      select(is_over_slope, beside + part * width, select(y <= none, larger(beside, none), none));
  const Lanes<Real> up = select(is_over_slope, y - part * height, smaller(y, none));
  return {x,
          y,
          {select(is_before, along, none - along), none - up, none - z},
          along * along + up * up + z * z};
}

}  // namespace
}  // namespace organ_collision::core
