#pragma once

#include "core/kernels/bounds.h"
#include "core/kernels/gap.h"
#include "core/kernels/lane_boxes.h"
#include "core/kernels/open_set.h"
#include "core/kernels/pair_search.h"

// How far the sets and triangles of two surfaces are apart at least.
//
// Rounding, in the terms of bounds.h, t being how far the origins are apart and r the sum of
// both radii: what is in a box turns back from the axes of its node but for 2^-20*r, is stored to
// 24*v*r, and moves to the other's axes by three products and sums, off by 4*u*(t + 2*r). Gaps are
// off by 16*u*(t + 2*r) more, those of triangles as gap.h says. Together below 64*u*t + 2^-15*r.
namespace organ_collision::core {
namespace {

template <class Real>
class PairBounds {
 public:
  explicit PairBounds(const PairSearch& search) : search_(search) {}

  /// Boxes are compared along the axes of both: flat ones that lie askew tell most along their own.
  /// Row by row: of each box of one (`by_first`: the first) to those of the other.
  void betweenBoxes(const Boxes& first, const Boxes& second, bool by_first,
                    Lanes<Real> (&bounds)[kLaneCount]) const {
    const Placement<Real> there(first.node, search_.second_from_first, second.node);
    const Placement<Real> back(second.node, search_.first_from_second, first.node);
    const LaneBoxes<Real> firsts = boxesOf<Real>(first.node);
    const LaneBoxes<Real> seconds = boxesOf<Real>(second.node);
    const LaneBoxes<Real> firsts_there = there(firsts);
    const LaneBoxes<Real> seconds_back = back(seconds);
    const Lanes<Real> rounding =
        Lanes<Real>::all(roundingOf(first.node.radius, second.node.radius, reachOf(there.offset)));
    const auto scale = static_cast<Real>(search_.least_scale);
    const Lanes<Real> squared_scale = Lanes<Real>::all(scale * scale);
    const Boxes& rows = by_first ? first : second;
    const LaneBoxes<Real>& rows_there = by_first ? firsts_there : seconds;
    const LaneBoxes<Real>& rows_back = by_first ? firsts : seconds_back;
    const LaneBoxes<Real>& lanes_there = by_first ? seconds : firsts_there;
    const LaneBoxes<Real>& lanes_back = by_first ? seconds_back : firsts;
    for (std::uint32_t i = rows.begin; i < rows.end; ++i) {
      const Lanes<Real> squares =
          larger(lanes_there.squaredDistanceTo(rows_there, i),
                 squared_scale * lanes_back.squaredDistanceTo(rows_back, i));
      bounds[i] = root(squares) - rounding;
    }
  }

  /// The triangles of a packet of the first, turned like the second and around its own origin.
  LaneTriangles<Real> turned(const TrianglePacket& packet) const {
    const auto turn = [this](const LaneVector<Real>& v) {
      const auto row = [&](int i) {
        const auto& linear = search_.second_from_first.linear[i];
        return dot(everywhere(vectorOf<Real>(linear)), v);
      };
      return LaneVector<Real>{row(0), row(1), row(2)};
    };
    const LaneTriangles<Real> triangles = trianglesOf<Real>(packet);
    return {turn(triangles.a), turn(triangles.ab), turn(triangles.ac)};
  }

  /// From the origin of a packet of the second to that of one of the first.
  Vector<Real> offsetOf(const TrianglePacket& first, const TrianglePacket& second) const {
    const AffineMap& map = search_.second_from_first;
    const auto coordinate = [&](int i) {
      const Vector<double> row = {map.linear[i][0], map.linear[i][1], map.linear[i][2]};
      return static_cast<Real>(dot(row, vectorOf<double>(first.origin)) + map.offset[i] -
                               double{second.origin[i]});
    };
    return {coordinate(0), coordinate(1), coordinate(2)};
  }

  /// What every bound between the triangles of two packets gives away.
  Real roundingOf(const TrianglePacket& first, const TrianglePacket& second,
                  const Vector<Real>& offset) const {
    return roundingOf(first.radius, second.radius, reachOf(offset)) +
           static_cast<Real>(2 * kPlaceRounding * (search_.largest_scale + 1));
  }

  /// Of each of our triangles to all of theirs, by how far they reach along some directions: from
  /// middle to middle, as the best so far, or, where these tell of some within `reach`,
  /// perpendicular to the surfaces.
  Lanes<Real> betweenTriangles(const LaneTriangles<Real>& ours, const LaneTriangles<Real>& theirs,
                               Real rounding, Real reach) const {
    const Lanes<Real> given_away = Lanes<Real>::all(rounding);
    const Vector<Real> apart = theirs.middle() - ours.middle();
    const Lanes<Real> gaps = larger(gapsAlong(apart, ours, theirs),
                                    gapsAlong(vectorOf<Real>(search_.axis), ours, theirs));
    if (leastOf(gaps - given_away) > reach) return gaps - given_away;
    const Lanes<Real> perpendicular = larger(gapsAlong(ours.normalTowards(apart), ours, theirs),
                                             gapsAlong(theirs.normalTowards(apart), ours, theirs));
    return larger(gaps, perpendicular) - given_away;
  }

 private:
  /// What every bound gives away where sets of these radii are so far apart; see above.
  Real roundingOf(float radius_of_first, float radius_of_second, Real apart) const {
    const double radii = search_.largest_scale * double{radius_of_first} + double{radius_of_second};
    return 64 * kRoundoff<Real> * apart + static_cast<Real>(0x1p-15 * radii + search_.rounding) +
           Real{kTiny};
  }

  const PairSearch& search_;
};

}  // namespace
}  // namespace organ_collision::core
