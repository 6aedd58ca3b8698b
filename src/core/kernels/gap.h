#pragma once

#include "core/kernels/lane_triangles.h"
#include "core/kernels/separation.h"
#include "organ_collision/core/wide_node.h"

// Gaps between a tip of several corners and boxes or triangles, eight at a time.
//
// Where nearest points are found in single precision, nothing is proven by how far they are apart;
// but whatever the direction between them, how far it keeps two convex bodies apart is a lower
// bound of their distance, and if the points are nearly the nearest, it is nearly the distance.
//
// Rounding, in the terms of bounds.h: extents along a direction are off by 3*u*(d + r),
// besides the u*d and r*u of the corners themselves; their difference by u*(d + r), the length of
// the direction by 3*u. Points of edges and faces are found to 8*u*(d + r). All that is below
// 16*u*d + 64*(u + v)*r; what is told is to be lessened by twice as much, which leaves room for the
// 4*u*extent of the exact measurement, where the extent may be twice the reach of the tip. In the
// frames of triangles a segment is off by 24*u*(d + 2*r) more, as points are (packet_range.h):
// there three times as much is given away.
namespace organ_collision::core {
namespace {

/// How many times roundingOf() the gaps to triangles are to be lessened by.
template <std::uint32_t kCorners>
constexpr int kGapRoundings = kCorners == 2 ? 3 : 2;

template <class Real>
inline Lanes<Real> clampedTo1(const Lanes<Real>& x) {
  return smaller(larger(x, Lanes<Real>{}), Lanes<Real>::all(1));  // 0 if it is not a number
}

template <class Real>
inline LaneVector<Real> clamped(const LaneVector<Real>& v, const LaneVector<Real>& low,
                                const LaneVector<Real>& high) {
  return {smaller(larger(v.x, low.x), high.x), smaller(larger(v.y, low.y), high.y),
          smaller(larger(v.z, low.z), high.z)};
}

/// How far a segment is from the lanes' boxes along a direction, times its length: the boxes are
/// where the direction comes from.
template <class Real>
inline Lanes<Real> gapAlong(const LaneVector<Real>& direction, const LaneVector<Real>& start,
                            const LaneVector<Real>& step, const LaneVector<Real>& middle,
                            const LaneVector<Real>& half) {
  const Lanes<Real> nearer_end = smaller(dot(direction, step), Lanes<Real>{});
  return dot(direction, start - middle) + nearer_end - dot(magnitudesOf(direction), half);
}

/// What keeps a segment from the lanes' boxes: a lower bound of the distances.
template <class Real>
inline SeparatingAxes<Real> separatingAxes(const Vector<Real>& start, const Vector<Real>& end,
                                           const LaneVector<Real>& low,
                                           const LaneVector<Real>& high) {
  const Vector<Real> along = end - start;
  const Lanes<Real> inverse = Lanes<Real>::all(1 / dot(along, along));
  const LaneVector<Real> from = everywhere(start);
  const LaneVector<Real> step = everywhere(along);
  const auto nearest_on_segment = [&](const LaneVector<Real>& point) {
    return from + clampedTo1(dot(point - from, step) * inverse) * step;
  };
  const Lanes<Real> half = Lanes<Real>::all(Real{0.5});
  const LaneVector<Real> middle = half * (low + high);
  // From the middle to the segment, to the box and back: going on finds hardly anything nearer.
  const LaneVector<Real> in_box = clamped(nearest_on_segment(middle), low, high);
  const LaneVector<Real> direction = nearest_on_segment(in_box) - in_box;
  const Lanes<Real> gap = gapAlong(direction, from, step, middle, half * (high - low));
  return {LaneVector<Real>{} - direction, distanceOfGap(gap, dot(direction, direction))};
}

/// Of two segments, shares of both.
template <class Real>
struct NearestShares {
  Lanes<Real> of_lane, of_tip;
};

/// Where the tip's segment and those in the lanes are nearest: from the squares of their lengths,
/// their product, and the products of each with the way from the tip's start to the lane's.
/// Source: C. Ericson, "Real-time collision detection" (2005), 5.1.9.
template <class Real>
[[gnu::always_inline]] inline NearestShares<Real> nearestShares(Real squared_step,
                                                                const Lanes<Real>& squared_edge,
                                                                const Lanes<Real>& both,
                                                                const Lanes<Real>& of_step,
                                                                const Lanes<Real>& of_edge) {
  const Lanes<Real> passing =
      clampedTo1((of_step * squared_edge - of_edge * both) /
                 (Lanes<Real>::all(squared_step) * squared_edge - both * both));
  const Lanes<Real> of_lane = clampedTo1((passing * both - of_edge) / squared_edge);
  return {of_lane, clampedTo1((of_lane * both + of_step) * Lanes<Real>::all(1 / squared_step))};
}

/// Of the segment from `start` along `step`, and those a lane from `lane_start` along `edge`, the
/// vector from nearest point to nearest point.
template <class Real>
[[gnu::always_inline]] inline LaneVector<Real> betweenEdges(const Vector<Real>& start,
                                                            const Vector<Real>& step,
                                                            const LaneVector<Real>& lane_start,
                                                            const LaneVector<Real>& edge) {
  const LaneVector<Real> along = everywhere(step);
  const LaneVector<Real> between = lane_start - everywhere(start);
  const NearestShares<Real> shares = nearestShares(
      dot(step, step), dot(edge, edge), dot(along, edge), dot(along, between), dot(edge, between));
  return between + shares.of_lane * edge - shares.of_tip * along;
}

/// The same of a segment in each triangle's frame and an edge in its plane.
template <class Real>
[[gnu::always_inline]] inline LaneVector<Real> toEdges(
    const LaneVector<Real>& start, const LaneVector<Real>& step, Real squared_step,
    const Lanes<Real>& start_x, const Lanes<Real>& start_y, const Lanes<Real>& edge_x,
    const Lanes<Real>& edge_y) {
  const Lanes<Real> x = start_x - start.x;
  const Lanes<Real> y = start_y - start.y;
  const auto [t, s] = nearestShares(
      squared_step, edge_x * edge_x + edge_y * edge_y, step.x * edge_x + step.y * edge_y,
      step.x * x + step.y * y - step.z * start.z, edge_x * x + edge_y * y);
  return {x + t * edge_x - s * step.x, y + t * edge_y - s * step.y,
          Lanes<Real>{} - start.z - s * step.z};
}

/// What a point's projection onto the plane of a triangle is in the triangle's coordinates.
template <class Number>
struct Foot {
  Number of_first, of_second;  ///< edge
};

/// REQUIRES: `offset` leads from the point to the corner at which both edges start.
template <class Number>
inline Foot<Number> footIn(const Vector<Number>& offset, const Vector<Number>& first,
                           const Vector<Number>& second) {
  const Number squared_first = dot(first, first);
  const Number squared_second = dot(second, second);
  const Number both = dot(first, second);
  const Number along_first = dot(offset, first);
  const Number along_second = dot(offset, second);
  const Number squared_normal = squared_first * squared_second - both * both;
  return {(both * along_second - squared_second * along_first) / squared_normal,
          (both * along_first - squared_first * along_second) / squared_normal};
}

/// False where it is not a number.
template <class Real>
inline Truth<Real> isInside(const Foot<Lanes<Real>>& foot) {
  const Lanes<Real> none{};
  return (none <= foot.of_first) & (none <= foot.of_second) &
         (foot.of_first + foot.of_second <= Lanes<Real>::all(1));
}

/// How far each of `ours` is kept from all of `theirs`, along a direction.
template <class Real>
inline Lanes<Real> gapsAlong(const Vector<Real>& axis, const LaneTriangles<Real>& ours,
                             const LaneTriangles<Real>& theirs) {
  const LaneVector<Real> direction = everywhere(axis);
  return distanceOfGap(
      Lanes<Real>::all(leastOf(theirs.nearestAlong(direction))) - ours.farthestAlong(direction),
      Lanes<Real>::all(dot(axis, axis)));
}

/// Eight triangles, each along its own normal: there flat ones are as thick as rounding makes them.
template <class Real>
class LaneFaces {
 public:
  explicit LaneFaces(const LaneTriangles<Real>& triangles)
      : normal_(cross(triangles.ab, triangles.ac)),
        squared_normal_(dot(normal_, normal_)),
        nearest_(triangles.nearestAlong(normal_)),
        farthest_(triangles.farthestAlong(normal_)) {}

  /// How far each is kept from a triangle, on either side.
  Lanes<Real> gapsTo(const Vector<Real> (&tip)[3]) const {
    const Lanes<Real> a = dot(normal_, everywhere(tip[0]));
    const Lanes<Real> b = dot(normal_, everywhere(tip[1]));
    const Lanes<Real> c = dot(normal_, everywhere(tip[2]));
    const Lanes<Real> before = nearest_ - larger(larger(a, b), c);
    const Lanes<Real> behind = smaller(smaller(a, b), c) - farthest_;
    return distanceOfGap(larger(before, behind), squared_normal_);
  }

 private:
  LaneVector<Real> normal_;
  Lanes<Real> squared_normal_, nearest_, farthest_;
};

/// Between which distances the lanes' triangles are from a tip, but for rounding; and the axis that
/// separates them, from the tip.
template <class Real>
struct Gap {
  Lanes<Real> low, high;
  LaneVector<Real> axis;
};

/// Of a segment, relative to the packet's origin; it is looked at in the triangles' frames.
template <class Real>
inline Gap<Real> gapToTriangles(const Vector<Real> (&tip)[2], const TrianglePacket& packet) {
  const LaneFrames<Real> frames = orthonormal(framesFromOrigin<Real>(packet));
  const LaneVector<Real> normal = frames.normal();
  const auto seen = [&](const Vector<Real>& corner) -> LaneVector<Real> {
    const LaneVector<Real> offset = everywhere(corner) - frames.centroid;
    return {dot(offset, frames.along) + frames.xOfCentroid(),
            dot(offset, frames.up) + frames.yOfCentroid(), dot(offset, normal)};
  };
  const LaneVector<Real> start = seen(tip[0]);
  const LaneVector<Real> end = seen(tip[1]);
  const LaneVector<Real> step = end - start;
  const Vector<Real> whole = tip[1] - tip[0];
  const Real squared_step = dot(whole, whole);
  const Lanes<Real> none{};
  const Lanes<Real>& before = frames.before;
  const Lanes<Real>& beyond = frames.beyond;
  const Lanes<Real>& height = frames.height;

  const Lanes<Real> left = none - before;
  const Lanes<Real> down = none - height;
  Shortest<Real> shortest(toEdges(start, step, squared_step, left, none, before + beyond, none));
  shortest.consider(toEdges(start, step, squared_step, none, height, beyond, down));
  shortest.consider(toEdges(start, step, squared_step, none, height, left, down));
  for (const LaneVector<Real>* corner : {&start, &end}) {
    const Truth<Real> is_over = (none <= corner->y) &
                                (before * corner->y <= height * (before + corner->x)) &
                                (beyond * corner->y <= height * (beyond - corner->x));
    shortest.consider({none, none, none - corner->z}, is_over);
  }

  const LaneVector<Real>& offset = shortest.offset;
  const Lanes<Real> farthest_of_tip = larger(dot(offset, start), dot(offset, end));
  const Lanes<Real> nearest_of_lanes =
      smaller(smaller(offset.x * left, offset.x * beyond), offset.y * height);
  return {distanceOfGap(nearest_of_lanes - farthest_of_tip, shortest.squared),
          root(shortest.squared),
          offset.x * frames.along + offset.y * frames.up + offset.z * normal};
}

/// Of a triangle, relative to the packet's origin.
template <class Real>
inline Gap<Real> gapToTriangles(const Vector<Real> (&tip)[3], const TrianglePacket& packet) {
  const auto [a, ab, ac] = trianglesOf<Real>(packet);
  const LaneVector<Real> b = a + ab;
  const LaneVector<Real> c = a + ac;
  const LaneVector<Real> bc = ac - ab;

  Shortest<Real> shortest(a - everywhere(tip[0]));
  for (std::uint32_t i = 0; i < 3; ++i) {
    const Vector<Real> step = tip[(i + 1) % 3] - tip[i];
    shortest.consider(betweenEdges(tip[i], step, a, ab));
    shortest.consider(betweenEdges(tip[i], step, a, ac));
    shortest.consider(betweenEdges(tip[i], step, b, bc));
  }
  for (const Vector<Real>& corner : tip) {
    const LaneVector<Real> to_corner = a - everywhere(corner);
    const Foot<Lanes<Real>> foot = footIn(to_corner, ab, ac);
    shortest.consider(to_corner + foot.of_first * ab + foot.of_second * ac, isInside(foot));
  }
  const LaneVector<Real> first = everywhere(tip[1] - tip[0]);
  const LaneVector<Real> second = everywhere(tip[2] - tip[0]);
  for (const LaneVector<Real>* corner : {&a, &b, &c}) {
    const LaneVector<Real> from_corner = everywhere(tip[0]) - *corner;
    const Foot<Lanes<Real>> foot = footIn(from_corner, first, second);
    shortest.consider(
        LaneVector<Real>{} - (from_corner + foot.of_first * first + foot.of_second * second),
        isInside(foot));
  }

  const LaneVector<Real>& offset = shortest.offset;
  Lanes<Real> farthest_of_tip = dot(offset, everywhere(tip[0]));
  for (std::uint32_t i = 1; i < 3; ++i)
    farthest_of_tip = larger(farthest_of_tip, dot(offset, everywhere(tip[i])));
  const Lanes<Real> nearest_of_lanes =
      smaller(smaller(dot(offset, a), dot(offset, b)), dot(offset, c));
  return {distanceOfGap(nearest_of_lanes - farthest_of_tip, shortest.squared),
          root(shortest.squared), offset};
}

}  // namespace
}  // namespace organ_collision::core
