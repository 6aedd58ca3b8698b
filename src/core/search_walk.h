#pragma once

#include "core/gap.h"
#include "core/lane_vector.h"
#include "core/search.h"

// The walk itself, for whichever vector unit includes it.
//
// Rounding. A bound must not exceed the distance that the exact measurement would give. Everything
// is relative to an origin: let r be the radius around it, d the sum of the tip's coordinates'
// magnitudes there, u the unit roundoff of Real, v that of single precision, in which boxes and
// triangles are kept. Rounding moves the tip by u*d, turning it adds 3*u*d; stored corners are off
// by 4*v*r; a point of an edge is found, along it, to 3*u*(d + r) + 8*u*r, and its distance to
// 3*u*(d + 4*r). Together below 16*u*d + 64*(u + v)*r, which every bound gives away; that also
// covers the 4*u*extent of the exact measurement. Triangles so small that products of their edges
// underflow are smaller than kTiny, which is given away too.
namespace organ_collision::core {
namespace {

constexpr std::uint32_t kPacketBit = 0x80000000U;
constexpr double kInfinity = __builtin_huge_val();
constexpr float kFloatInfinity = __builtin_huge_valf();

template <class Real>
constexpr Real kRoundoff = sizeof(Real) == sizeof(float) ? Real{0x1p-24} : Real{0x1p-53};

constexpr float kTiny = 0x1p-56F;

template <class Real>
inline Real magnitudeOf(Real x) {
  return x < 0 ? -x : x;
}

/// A corner of the tip, relative to an origin.
template <class Real>
inline Vector<Real> relative(const std::array<double, 3>& tip, const std::array<float, 3>& origin) {
  return {static_cast<Real>(tip[0] - static_cast<double>(origin[0])),
          static_cast<Real>(tip[1] - static_cast<double>(origin[1])),
          static_cast<Real>(tip[2] - static_cast<double>(origin[2]))};
}

template <class Real>
inline Real reachOf(const Vector<Real>& v) {
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
inline Lanes<Real> distanceOf(const LaneVector<Real>& low, const LaneVector<Real>& high,
                              const Vector<Real>& tip_low, const Vector<Real>& tip_high) {
  const Lanes<Real> none{};
  const auto gap = [&none](const Lanes<Real>& lows, const Lanes<Real>& highs, Real from, Real to) {
    return larger(larger(lows - Lanes<Real>::all(to), Lanes<Real>::all(from) - highs), none);
  };
  const LaneVector<Real> gaps = {gap(low.x, high.x, tip_low.x, tip_high.x),
                                 gap(low.y, high.y, tip_low.y, tip_high.y),
                                 gap(low.z, high.z, tip_low.z, tip_high.z)};
  return root(dot(gaps, gaps));
}

/// The distance of a point, at the origin, to the segment from `start` along `edge`.
template <class Real>
inline Lanes<Real> squaredDistanceToSegment(const LaneVector<Real>& start,
                                            const LaneVector<Real>& edge, const Lanes<Real>& along,
                                            const Lanes<Real>& squared_edge) {
  // larger() and smaller() make 0 of what is not a number: edges without length.
  const Lanes<Real> t =
      smaller(larger((Lanes<Real>{} - along) / squared_edge, Lanes<Real>{}), Lanes<Real>::all(1));
  const LaneVector<Real> nearest = start + t * edge;
  return dot(nearest, nearest);
}

/// Between which distances a tip's distances to the triangles of a packet lie, but for
/// roundingOf().
template <class Real>
struct Range {
  Lanes<Real> low, high;
};

template <class Real>
inline Range<Real> distanceOfPoint(const TrianglePacket& packet, const Vector<Real>& point,
                                   Real farthest) {
  const LaneVector<Real> a = load<Real>(packet.corner) - everywhere(point);
  const LaneVector<Real> ab = load<Real>(packet.edge1);
  const LaneVector<Real> ac = load<Real>(packet.edge2);
  const LaneVector<Real> bc = ac - ab;
  const LaneVector<Real> b = a + ab;
  const Lanes<Real> abab = dot(ab, ab);
  const Lanes<Real> acac = dot(ac, ac);
  const Lanes<Real> aab = dot(a, ab);
  const Lanes<Real> aac = dot(a, ac);
  const Lanes<Real> to_edges =
      root(smaller(smaller(squaredDistanceToSegment(a, ab, aab, abab),
                           squaredDistanceToSegment(a, ac, aac, acac)),
                   squaredDistanceToSegment(b, bc, dot(b, bc), dot(bc, bc))));

  // Where the point's projection lies in the face, the distance to its plane counts; where it may
  // or may not, either. What cancels in products of edges is 8*u times their lengths.
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
  const Lanes<Real> height = magnitude(dot(a, normal));
  const Lanes<Real> length = root(squared_normal);
  const Lanes<Real> height_doubt = doubt * reach;
  const Lanes<Real> to_plane = larger((height - height_doubt) / (length + doubt), none);
  const Lanes<Real> perhaps_to_plane = (height + height_doubt) / (length - doubt);
  const Truth<Real> perhaps_inside = none <= least_weight + weight_doubt;
  const Truth<Real> surely_inside = (weight_doubt <= least_weight) & (doubt + doubt <= length);
  return {select(perhaps_inside, smaller(to_plane, to_edges), to_edges),
          select(surely_inside, smaller(perhaps_to_plane, to_edges), to_edges)};
}

inline std::uint32_t lowestBit(std::uint32_t bits) {
  return static_cast<std::uint32_t>(__builtin_ctz(bits));
}

/// A bound in single precision that is not larger, and not below zero.
inline float boundInFloat(float bound) { return bound > 0.0F ? bound : 0.0F; }
inline float boundInFloat(double bound) {
  constexpr double kLargest = 0x1p127;
  return bound > 0.0 ? static_cast<float>((bound < kLargest ? bound : kLargest) * (1.0 - 0x1p-22))
                     : 0.0F;
}

inline Waiting waiting(float bound, std::uint32_t set) {
  std::uint32_t bits = 0;
  __builtin_memcpy(&bits, &bound, sizeof(bits));
  return static_cast<Waiting>(bits) << 32U | set;
}
inline float boundOf(Waiting waiting) {
  const auto bits = static_cast<std::uint32_t>(waiting >> 32U);
  float bound = 0;
  __builtin_memcpy(&bound, &bits, sizeof(bound));
  return bound;
}
inline std::uint32_t setOf(Waiting waiting) { return static_cast<std::uint32_t>(waiting); }

/// Brings what a pointer points to closer.
template <class T>
inline void fetch(const T* item) {
  for (std::size_t i = 0; i < sizeof(T); i += 64)
    __builtin_prefetch(reinterpret_cast<const char*>(item) + i);
}

/// Of a tip of one, two or three corners.
template <class Real, std::uint32_t kCorners>
class Walk {
 public:
  explicit Walk(Search& search) : search_(search) { look(); }

  void run() {
    Waiting* const bottom = search_.stack;
    Waiting* top = bottom;
    *top++ = waiting(0.0F, 0);
    while (top != bottom && search_.leaves_left > 0) {
      const Waiting next = *--top;
      if (static_cast<Real>(boundOf(next)) > reach_) {
        leaveOut(boundOf(next));
      } else if ((setOf(next) & kPacketBit) != 0) {
        scan(search_.packets[setOf(next) & ~kPacketBit]);
      } else {
        top = open(search_.nodes[setOf(next)], top);
      }
    }
    while (top != bottom) leaveOut(boundOf(*--top));
    measureCandidates();
    if (promised_) measure(promised_leaf_);
    for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) leaveOut(left_out_[lane]);
    // Left out because it was farther than the best of its time, it is farther than the last.
    if (static_cast<Real>(search_.unopened) >= static_cast<Real>(search_.best))
      search_.unopened = kInfinity;
  }

 private:
  static constexpr bool kIsPoint = kCorners == 1;
  static constexpr std::uint32_t kMostCandidates = 16;

  void look() {
    const double share = search_.best * search_.share;
    const double less = search_.best - search_.allowance;
    reach_ = static_cast<Real>(share < less ? share : less);
  }

  void leaveOut(double bound) {
    if (bound < search_.unopened) search_.unopened = bound;
  }
  void leaveOut(const Truth<Real>& those, const Lanes<Real>& bounds) {
    left_out_ = smaller(left_out_, select(those, bounds, Lanes<Real>::all(Real{kFloatInfinity})));
  }

  /// The box of the tip in a node's or packet's coordinates; how far it is from the origin.
  template <class Turn>
  Real tipBox(const std::array<float, 3>& origin, const Turn& turn, Vector<Real>& low,
              Vector<Real>& high) const {
    const Vector<Real> first = relative<Real>(search_.corners[0], origin);
    Real farthest = reachOf(first);
    low = high = turn(first);
    if constexpr (!kIsPoint) {
      for (std::uint32_t i = 1; i < search_.corner_count; ++i) {
        const Vector<Real> corner = relative<Real>(search_.corners[i], origin);
        const Real reach = reachOf(corner);
        farthest = reach > farthest ? reach : farthest;
        const Vector<Real> v = turn(corner);
        low = {v.x < low.x ? v.x : low.x, v.y < low.y ? v.y : low.y, v.z < low.z ? v.z : low.z};
        high = {v.x > high.x ? v.x : high.x, v.y > high.y ? v.y : high.y,
                v.z > high.z ? v.z : high.z};
      }
    }
    return farthest;
  }

  Lanes<Real> boundsOf(const WideNode& node) const {
    const auto turn = [&node](const Vector<Real>& v) { return turned(node, v); };
    const LaneVector<Real> boxes_low = load<Real>(node.low);
    const LaneVector<Real> boxes_high = load<Real>(node.high);
    Vector<Real> low, high;
    const Real farthest = tipBox(node.origin, turn, low, high);
    const Lanes<Real> rounding = Lanes<Real>::all(roundingOf(farthest, node.radius));
    const Lanes<Real> distances = distanceOf(boxes_low, boxes_high, low, high) - rounding;
    if constexpr (kCorners != 2) return distances;
    const Lanes<Real> gaps =
        gapToBoxes(turn(relative<Real>(search_.corners[0], node.origin)),
                   turn(relative<Real>(search_.corners[1], node.origin)), boxes_low, boxes_high);
    return larger(distances, gaps - (rounding + rounding));
  }

  /// Puts the children that matter on the stack, the nearest on top.
  Waiting* open(const WideNode& node, Waiting* top) {
    const Lanes<Real> bounds = boundsOf(node);
    search_.bounds += node.lane_count;
    const Truth<Real> matter = bounds <= Lanes<Real>::all(reach_);
    leaveOut(!matter, bounds);  // lanes that are not in use repeat others
    Real bound[kLaneCount];
    bounds.store(bound);
    Waiting* const first = top;
    const std::uint32_t used = (1U << node.lane_count) - 1;
    for (std::uint32_t rest = used & matter.bits(); rest != 0; rest &= rest - 1) {
      const std::uint32_t lane = lowestBit(rest);
      const bool is_node = lane < node.node_count;
      const std::uint32_t number =
          lane + (is_node ? node.first_node : node.first_packet - node.node_count);
      const Waiting set =
          waiting(boundInFloat(bound[lane]), is_node ? number : kPacketBit | number);
      if (is_node) {
        fetch(search_.nodes + number);
      } else {
        fetch(search_.packets + number);
      }
      Waiting* place = top++;
      for (; place != first && place[-1] < set; --place) *place = place[-1];
      *place = set;
    }
    return top;
  }

  Range<Real> rangeOf(const TrianglePacket& packet, Real& rounding) const {
    Vector<Real> low, high;
    const Real farthest = tipBox(
        packet.origin, [](const Vector<Real>& v) { return v; }, low, high);
    rounding = roundingOf(farthest, packet.radius);
    if constexpr (kIsPoint) {
      return distanceOfPoint(packet, low, farthest + 2 * Real{packet.radius});
    } else {
      Vector<Real> tip[kCorners];
      for (std::uint32_t i = 0; i < kCorners; ++i)
        tip[i] = relative<Real>(search_.corners[i], packet.origin);
      const Gap<Real> gap = gapToTriangles(tip, packet);
      rounding = rounding + rounding;
      return {gap.low, gap.high};
    }
  }

  /// Looks at the triangles of a packet: those that may be nearest are to be measured.
  void scan(const TrianglePacket& packet) {
    Real rounding = 0;
    const Range<Real> range = rangeOf(packet, rounding);
    const Lanes<Real> bounds = range.low - Lanes<Real>::all(rounding);
    const std::uint32_t looked_at =
        packet.lane_count < search_.leaves_left ? packet.lane_count : search_.leaves_left;
    search_.leaves_left -= looked_at;
    search_.triangles += looked_at;
    const Truth<Real> allowed =
        Lanes<Real>::numbers() <= Lanes<Real>::all(static_cast<Real>(looked_at) - 1);
    const Real nearest =
        leastOf(select(allowed, range.high, Lanes<Real>::all(Real{kFloatInfinity})));
    const double not_farther =
        static_cast<double>(nearest + rounding) * (1.0 + 4 * kRoundoff<Real>);
    if (not_farther < search_.best) {
      search_.best = not_farther;
      look();
      promised_ = true;
      promised_leaf_ = packet.first_leaf +
                       lowestBit((allowed & (range.high <= Lanes<Real>::all(nearest))).bits());
    }
    const Truth<Real> matter = allowed & (bounds <= Lanes<Real>::all(reach_));
    const Truth<Real> used =
        Lanes<Real>::numbers() <= Lanes<Real>::all(static_cast<Real>(packet.lane_count) - 1);
    leaveOut(used & !matter, bounds);
    Real bound[kLaneCount];
    bounds.store(bound);
    for (std::uint32_t rest = matter.bits(); rest != 0; rest &= rest - 1) {
      const std::uint32_t lane = lowestBit(rest);
      if (candidate_count_ == kMostCandidates) measureCandidates();
      candidates_[candidate_count_++] = {boundInFloat(bound[lane]), packet.first_leaf + lane};
    }
  }

  /// Measures exactly what still may be nearest.
  void measureCandidates() {
    while (candidate_count_ > 0) {
      std::uint32_t nearest = 0;
      for (std::uint32_t i = 1; i < candidate_count_; ++i)
        if (candidates_[i].bound < candidates_[nearest].bound) nearest = i;
      const Candidate candidate = candidates_[nearest];
      candidates_[nearest] = candidates_[--candidate_count_];
      if (static_cast<Real>(candidate.bound) > reach_) {
        leaveOut(candidate.bound);
      } else {
        measure(candidate.leaf);
      }
    }
  }

  void measure(std::uint32_t leaf) {
    search_.measure(search_, leaf);
    look();
    promised_ = promised_ && leaf != promised_leaf_;
  }

  Search& search_;
  Real reach_;                                                     // what is farther is left out
  Lanes<Real> left_out_ = Lanes<Real>::all(Real{kFloatInfinity});  // the nearest of that
  Candidate candidates_[kMostCandidates];
  std::uint32_t candidate_count_ = 0;
  bool promised_ = false;  // search_.best is owed to a triangle that was not measured
  std::uint32_t promised_leaf_ = 0;
};

// Beyond this many sizes of the organ, single precision tells its parts no longer apart.
constexpr double kFar = 8.0;

template <class Real>
inline void walkAs(Search& search) {
  if (search.corner_count == 1) Walk<Real, 1>(search).run();
  if (search.corner_count == 2) Walk<Real, 2>(search).run();
  if (search.corner_count == 3) Walk<Real, 3>(search).run();
}

inline void walk(Search& search) {
  double farthest = 0.0;
  for (std::uint32_t i = 0; i < search.corner_count; ++i)
    for (const double coordinate :
         {search.corners[i][0], search.corners[i][1], search.corners[i][2]})
      farthest = magnitudeOf(coordinate) > farthest ? magnitudeOf(coordinate) : farthest;
  if (farthest < kFar) {
    walkAs<float>(search);
  } else {
    walkAs<double>(search);
  }
}

}  // namespace
}  // namespace organ_collision::core
