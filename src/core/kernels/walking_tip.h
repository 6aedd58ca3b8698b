#pragma once

#include "core/kernels/gap.h"
#include "core/kernels/packet_range.h"
#include "core/kernels/search.h"

// The tip of a walk, and how far boxes and triangles are from it.
namespace organ_collision::core {
namespace {

/// Of one, two or three corners, in the unit frame.
template <class Real, std::uint32_t kCorners>
class WalkingTip {
 public:
  explicit WalkingTip(const Search& search) {
    Real reach = 0;
    for (std::uint32_t i = 0; i < kCorners; ++i) {
      const std::array<double, 3>& corner = search.corners[i];
      corners_[i] = {static_cast<Real>(corner[0]), static_cast<Real>(corner[1]),
                     static_cast<Real>(corner[2])};
      const Real corner_reach = reachOf(corners_[i]);
      reach = corner_reach > reach ? corner_reach : reach;
    }
    rounding_of_corners_ = kRoundoff<Real> * reach;
    const WideNode& root = search.nodes[0];
    const Vector<Real> origin = {Real{root.origin[0]}, Real{root.origin[1]}, Real{root.origin[2]}};
    // Boxes are as much larger as what they enclose may be off; gaps along directions are not.
    rounding_of_boxes_ = roundingOf(reach + reachOf(origin) + 4 * Real{root.radius},
                                    kCorners == 2 ? root.radius : 0.0F);
  }

  /// Where the paper's search is routed to, as far as single precision tells.
  Vector<float> middle() const {
    Vector<Real> sum = corners_[0];
    for (std::uint32_t i = 1; i < kCorners; ++i) sum = sum + corners_[i];
    const auto share = [](Real x) { return static_cast<float>(x) / kCorners; };
    return {share(sum.x), share(sum.y), share(sum.z)};
  }

  /// Of the distance to any box.
  Real boxRounding() const { return rounding_of_boxes_; }

  /// A node's boxes and the tip's.
  struct SeenBoxes {
    LaneVector<Real> low, high;
    Vector<Real> tip_low, tip_high;
  };
  SeenBoxes boxesSeenIn(const WideNode& node) const {
    SeenBoxes seen = {load<Real>(node.low), load<Real>(node.high), {}, {}};
    boxIn(
        node.origin, [&node](const Vector<Real>& v) { return turned(node, v); }, seen.tip_low,
        seen.tip_high);
    return seen;
  }

  /// Lower bounds of the boxes' squared distances, but for boxRounding().
  [[gnu::always_inline]] Lanes<Real> squaresOf(const SeenBoxes& seen, const WideNode& node) const {
    if constexpr (kCorners == 2) {
      const Lanes<Real> gaps = larger(
          separatingAxesOf(seen, node).gap - Lanes<Real>::all(rounding_of_boxes_), Lanes<Real>{});
      return gaps * gaps;
    }
    return squaredDistanceOf(seen.low, seen.high, seen.tip_low, seen.tip_high);
  }

  /// From a segment to the boxes, in the node's orientation; but for twice boxRounding().
  SeparatingAxes<Real> separatingAxesOf(const SeenBoxes& seen, const WideNode& node) const {
    const auto end = [&](int i) { return turned(node, relative(corners_[i], node.origin)); };
    return separatingAxes(end(0), end(1), seen.low, seen.high);
  }

  /// The gaps between each box and the tip, axis by axis, from the box to the tip.
  LaneVector<Real> gapsOf(const SeenBoxes& seen) const {
    const Lanes<Real> none{};
    const auto gap = [&none](const Lanes<Real>& lows, const Lanes<Real>& highs, Real from,
                             Real to) {
      return larger(Lanes<Real>::all(from) - highs, none) -
             larger(lows - Lanes<Real>::all(to), none);
    };
    return {gap(seen.low.x, seen.high.x, seen.tip_low.x, seen.tip_high.x),
            gap(seen.low.y, seen.high.y, seen.tip_low.y, seen.tip_high.y),
            gap(seen.low.z, seen.high.z, seen.tip_low.z, seen.tip_high.z)};
  }

  /// From about the nearest point of the tip to the middle of each box.
  LaneVector<Real> offsetsToMiddles(const SeenBoxes& seen, const WideNode& node) const {
    const Lanes<Real> half = Lanes<Real>::all(Real{0.5});
    const LaneVector<Real> middles = half * (seen.low + seen.high);
    if constexpr (kIsPoint) return middles - everywhere(seen.tip_low);
    constexpr std::uint32_t kEdges = kCorners == 2 ? 1 : 3;
    Lanes<Real> least = infinite<Real>();
    LaneVector<Real> shortest = {};
    for (std::uint32_t i = 0; i < kEdges; ++i) {
      const Vector<Real> start = turned(node, relative(corners_[i], node.origin));
      const Vector<Real> end = turned(node, relative(corners_[(i + 1) % kCorners], node.origin));
      const LaneVector<Real> edge = everywhere(end - start);
      const LaneVector<Real> from_start = middles - everywhere(start);
      const LaneVector<Real> offset =
          from_start - clampedTo1(dot(from_start, edge) / dot(edge, edge)) * edge;
      const Truth<Real> is_shorter = dot(offset, offset) <= least;
      least = select(is_shorter, dot(offset, offset), least);
      shortest = select(is_shorter, offset, shortest);
    }
    return shortest;
  }

  /// What is in the box of some lane is nowhere farther than this, but for boxRounding().
  Real farthestInNearest(const SeenBoxes& seen, const WideNode& node) const {
    const Lanes<Real> half = Lanes<Real>::all(Real{0.5});
    const LaneVector<Real> offset =
        magnitudesOf(offsetsToMiddles(seen, node)) + half * (seen.high - seen.low);
    return rootOf(leastOf(dot(offset, offset))) * (1 + Real{kAxesShorter});
  }

  /// A packet's triangles: between which distances they are, but for `rounding`; and, where they
  /// are asked for, which planes keep them apart.
  [[gnu::always_inline]] SquaredRange<Real> rangeOf(const TrianglePacket& packet, Real& rounding,
                                                    Planes<Real>* planes = nullptr) const {
    if constexpr (kIsPoint) {
      rounding = withPlaces(Real{roundingOf(packet)});
      const LaneFrames<Real> frames = orthonormal(framesOf<Real>(packet));
      const auto nearest = nearestInFrames(frames, corners_[0]);
      if (planes != nullptr) *planes = nearest.planes(frames);
      return nearest.range();
    } else {
      Vector<Real> low, high;
      rounding = withPlaces(roundingOf(boxIn(packet, low, high), packet.radius));
      Vector<Real> tip[kCorners];
      for (std::uint32_t i = 0; i < kCorners; ++i) tip[i] = relative(corners_[i], packet.origin);
      const Gap<Real> gap = gapToTriangles(tip, packet);
      rounding = kGapRoundings<kCorners> * rounding;
      if (planes != nullptr)
        *planes = {Lanes<Real>::all(-1) / root(dot(gap.axis, gap.axis)) * gap.axis, gap.low};
      return {gap.low * gap.low, gap.high * gap.high};
    }
  }

  /// The squared distances of their boxes, but for the same rounding.
  Lanes<Real> squaresToBoxesOfTriangles(const TrianglePacket& packet) const {
    LaneVector<Real> low, high;
    boxTriangles(packet, low, high);
    Vector<Real> tip_low, tip_high;
    boxIn(packet, tip_low, tip_high);
    return Lanes<Real>::all(1 - kRangeRounding<Real>) *
           squaredDistanceOf(low, high, tip_low, tip_high);
  }

 private:
  static constexpr bool kIsPoint = kCorners == 1;

  /// Boxes are turned by axes that are shorter than 1, by less.
  static constexpr float kAxesShorter = 0x1p-18F;

  /// The box of the tip in a node's coordinates; how far it is from the origin.
  template <class Turn>
  Real boxIn(const std::array<float, 3>& origin, const Turn& turn, Vector<Real>& low,
             Vector<Real>& high) const {
    const Vector<Real> first = relative(corners_[0], origin);
    Real farthest = reachOf(first);
    low = high = turn(first);
    if constexpr (!kIsPoint) {
      for (std::uint32_t i = 1; i < kCorners; ++i) {
        const Vector<Real> corner = relative(corners_[i], origin);
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

  /// The same in a packet's, without a turn.
  Real boxIn(const TrianglePacket& packet, Vector<Real>& low, Vector<Real>& high) const {
    return boxIn(
        packet.origin, [](const Vector<Real>& v) { return v; }, low, high);
  }

  /// Vertices, centroids and the tip are rounded where they are, too.
  Real withPlaces(Real rounding) const {
    return rounding + rounding_of_corners_ + Real{2 * kPlaceRounding};
  }

  Vector<Real> corners_[kCorners];
  Real rounding_of_corners_;
  Real rounding_of_boxes_;
};

}  // namespace
}  // namespace organ_collision::core
