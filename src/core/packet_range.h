#pragma once

#include "core/bounds.h"
#include "core/lane_triangles.h"
#include "core/ways.h"

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
  const auto least = [](const auto& x, const auto& y, const auto& z) {
    return smaller(smaller(x, y), z);
  };
  const auto most = [](const auto& x, const auto& y, const auto& z) {
    return larger(larger(x, y), z);
  };
  low = {least(a.x, b.x, c.x), least(a.y, b.y, c.y), least(a.z, b.z, c.z)};
  high = {most(a.x, b.x, c.x), most(a.y, b.y, c.y), most(a.z, b.z, c.z)};
}

/// The point nearest to the origin of the segment from `start` along `edge`.
template <class Real>
inline LaneVector<Real> nearestOfSegment(const LaneVector<Real>& start,
                                         const LaneVector<Real>& edge, const Lanes<Real>& along,
                                         const Lanes<Real>& squared_edge) {
  // larger() and smaller() make 0 of what is not a number: edges without length.
  const Lanes<Real> t =
      smaller(larger((Lanes<Real>{} - along) / squared_edge, Lanes<Real>{}), Lanes<Real>::all(1));
  return start + t * edge;
}
template <class Real>
inline Lanes<Real> squaredDistanceToSegment(const LaneVector<Real>& start,
                                            const LaneVector<Real>& edge, const Lanes<Real>& along,
                                            const Lanes<Real>& squared_edge) {
  const LaneVector<Real> nearest = nearestOfSegment(start, edge, along, squared_edge);
  return dot(nearest, nearest);
}

/// Between which distances, squared, a tip's distances to the triangles of a packet lie, but for
/// roundingOf().
template <class Real>
struct SquaredRange {
  Lanes<Real> low, high;
};

template <class Real>
inline SquaredRange<Real> squaredDistanceOfPoint(const TrianglePacket& packet,
                                                 const Vector<Real>& point, Real farthest) {
  const auto [corner, ab, ac] = trianglesOf<Real>(packet);
  const LaneVector<Real> a = corner - everywhere(point);
  const LaneVector<Real> bc = ac - ab;
  const LaneVector<Real> b = a + ab;
  const Lanes<Real> abab = dot(ab, ab);
  const Lanes<Real> acac = dot(ac, ac);
  const Lanes<Real> aab = dot(a, ab);
  const Lanes<Real> aac = dot(a, ac);
  const Lanes<Real> to_edges = smaller(smaller(squaredDistanceToSegment(a, ab, aab, abab),
                                               squaredDistanceToSegment(a, ac, aac, acac)),
                                       squaredDistanceToSegment(b, bc, dot(b, bc), dot(bc, bc)));

  // Where the point's projection lies in the face, the distance to its plane counts; where it may
  // or may not, either. What cancels in products of edges is 8*u times their lengths, and of the
  // normal's square, as that is at most half as long as they are, 9*u times their squares.
  const Lanes<Real> abac = dot(ab, ac);
  const LaneVector<Real> normal = cross(ab, ac);
  const Lanes<Real> squared_normal = dot(normal, normal);
  const Lanes<Real> edges = abab + acac;
  const Lanes<Real> reach = Lanes<Real>::all(farthest);
  const Lanes<Real> doubt = Lanes<Real>::all(8 * kRoundoff<Real>) * edges;
  const Lanes<Real> weight_doubt = doubt * (reach * reach + edges);
  const Lanes<Real> s = abac * aac - acac * aab;  // weights of b and c, times squared_normal
  const Lanes<Real> t = abac * aab - abab * aac;
  const Lanes<Real> none{};
  const Lanes<Real> least_weight = smaller(smaller(s, t), squared_normal - (s + t));
  const Lanes<Real> height = magnitudeOf(dot(a, normal));
  const Lanes<Real> height_doubt = doubt * reach;
  const Lanes<Real> square_doubt = Lanes<Real>::all(9 * kRoundoff<Real>) * edges * edges;
  const Lanes<Real> low = larger(height - height_doubt, none);
  const Lanes<Real> high = height + height_doubt;
  // The quotients first: squares of heights underflow.
  const Lanes<Real> to_plane = larger(low / (squared_normal + square_doubt) * low, none);
  const Lanes<Real> perhaps_to_plane = high / (squared_normal - square_doubt) * high;
  const Truth<Real> perhaps_inside = none <= least_weight + weight_doubt;
  const Truth<Real> surely_inside =
      (weight_doubt <= least_weight) & (Lanes<Real>::all(4) * square_doubt <= squared_normal);
  return {select(perhaps_inside, smaller(to_plane, to_edges), to_edges),
          select(surely_inside, smaller(perhaps_to_plane, to_edges), to_edges)};
}

/// About the shortest ways from a point to the triangles of a packet, of which it is told how far
/// they are.
template <class Real>
[[gnu::always_inline]] inline Ways<Real> waysTo(const TrianglePacket& packet,
                                                const Vector<Real>& point,
                                                const Lanes<Real>& squared_low) {
  const auto [corner, ab, ac] = trianglesOf<Real>(packet);
  const LaneVector<Real> a = corner - everywhere(point);
  const LaneVector<Real> bc = ac - ab;
  const LaneVector<Real> b = a + ab;
  Shortest<Real> to_edges(nearestOfSegment(a, ab, dot(a, ab), dot(ab, ab)));
  to_edges.consider(nearestOfSegment(a, ac, dot(a, ac), dot(ac, ac)));
  to_edges.consider(nearestOfSegment(b, bc, dot(b, bc), dot(bc, bc)));
  const LaneVector<Real> normal = cross(ab, ac);
  const LaneVector<Real> to_plane = dot(a, normal) / dot(normal, normal) * normal;
  const LaneVector<Real> ways = select(to_edges.squared <= squared_low, to_edges.offset, to_plane);
  const Lanes<Real> along =
      dot(ways, a) + smaller(smaller(dot(ways, ab), dot(ways, ac)), Lanes<Real>{});
  return {ways, distanceOfGap(along, dot(ways, ways))};
}

}  // namespace
}  // namespace organ_collision::core
