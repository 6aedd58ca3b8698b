#pragma once

#include "core/bounds.h"
#include "core/candidates.h"
#include "core/gap.h"
#include "core/packet_range.h"
#include "core/pair_search.h"
#include "core/waiting.h"

// The walk through two trees at once, for whichever vector unit includes it.
//
// Rounding, in the terms of bounds.h, t being how far the origins are apart and r the sum of
// both radii: what is in a box turns back from the axes of its node but for 2^-20*r, is stored to
// 4*v*r, and moves to the other's axes by three products and sums, off by 4*u*(t + 2*r). Gaps are
// off by 16*u*(t + 2*r) more, those of triangles as gap.h says. Together below 64*u*t + 2^-15*r.
namespace organ_collision::core {
namespace {

template <class Real>
inline Vector<Real> vectorOf(const std::array<double, 3>& v) {
  return {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
}
inline Vector<double> doublesOf(const std::array<float, 3>& v) {
  return {double{v[0]}, double{v[1]}, double{v[2]}};
}

/// Eight boxes of a node; or those of a packet's triangles, along the axes of the unit frame.
struct alignas(64) BoxesOf {
  LanePoints low, high;
  std::array<Vector<double>, 3> axes;
  Vector<double> origin;
  float radius;
  std::uint32_t count;

  explicit BoxesOf(const WideNode& node)
      : low(node.low),
        high(node.high),
        axes{doublesOf(node.axes[0]), doublesOf(node.axes[1]), doublesOf(node.axes[2])},
        origin(doublesOf(node.origin)),
        radius(node.radius),
        count(node.lane_count) {}

  explicit BoxesOf(const TrianglePacket& packet)
      : axes{Vector<double>{1, 0, 0}, Vector<double>{0, 1, 0}, Vector<double>{0, 0, 1}},
        origin(doublesOf(packet.origin)),
        radius(packet.radius),
        count(packet.lane_count) {
    LaneVector<float> lows, highs;
    boxTriangles(packet, lows, highs);
    lows.x.store(&low[0][0]);
    lows.y.store(&low[1][0]);
    lows.z.store(&low[2][0]);
    highs.x.store(&high[0][0]);
    highs.y.store(&high[1][0]);
    highs.z.store(&high[2][0]);
  }
};

/// From one set's axes and origin to another's.
template <class Real>
struct Placement {
  std::array<Vector<Real>, 3> rows;
  Vector<Real> offset;

  Placement(const BoxesOf& from, const AffineMap& map, const BoxesOf& to) {
    // Axes are a trifle shorter than 1.
    const double inverse = 1.0 / dot(from.axes[0], from.axes[0]);
    Vector<double> columns[3];  // of the map, along the axes of `from`
    double moved[3];
    for (int row = 0; row < 3; ++row) {
      const Vector<double> linear = {map.linear[row][0], map.linear[row][1], map.linear[row][2]};
      columns[row] = inverse * Vector<double>{dot(linear, from.axes[0]), dot(linear, from.axes[1]),
                                              dot(linear, from.axes[2])};
      moved[row] = dot(linear, from.origin) + map.offset[row];
    }
    const Vector<double> between = Vector<double>{moved[0], moved[1], moved[2]} - to.origin;
    for (int row = 0; row < 3; ++row) {
      const Vector<double>& axis = to.axes[row];
      const Vector<double> turned = axis.x * columns[0] + axis.y * columns[1] + axis.z * columns[2];
      rows[row] = {static_cast<Real>(turned.x), static_cast<Real>(turned.y),
                   static_cast<Real>(turned.z)};
    }
    offset = {static_cast<Real>(dot(to.axes[0], between)),
              static_cast<Real>(dot(to.axes[1], between)),
              static_cast<Real>(dot(to.axes[2], between))};
  }

  LaneVector<Real> turned(const LaneVector<Real>& v) const {
    return {dot(everywhere(rows[0]), v), dot(everywhere(rows[1]), v), dot(everywhere(rows[2]), v)};
  }
  LaneVector<Real> operator()(const LaneVector<Real>& v) const {
    return everywhere(offset) + turned(v);
  }
  /// Boxes around the moved boxes.
  void operator()(LaneVector<Real>& low, LaneVector<Real>& high) const {
    const Lanes<Real> half = Lanes<Real>::all(Real{0.5});
    const LaneVector<Real> middle = (*this)(half * (low + high));
    const LaneVector<Real> size = half * (high - low);
    const auto reach = [&size](const Vector<Real>& row) {
      return dot(
          everywhere(Vector<Real>{magnitudeOf(row.x), magnitudeOf(row.y), magnitudeOf(row.z)}),
          size);
    };
    const LaneVector<Real> reaches = {reach(rows[0]), reach(rows[1]), reach(rows[2])};
    low = middle - reaches;
    high = middle + reaches;
  }
};

template <class Real>
inline Vector<Real> laneOf(const LaneVector<Real>& v, std::uint32_t lane) {
  return {v.x[lane], v.y[lane], v.z[lane]};
}

/// A set of one of the surfaces, ready to be compared.
class OpenSet {
 public:
  OpenSet(const SearchedTree& tree, std::uint32_t number)
      : number_(number),
        node_((number & kPacketBit) == 0 ? tree.nodes + number : nullptr),
        packet_(node_ == nullptr ? tree.packets + (number & ~kPacketBit) : nullptr),
        boxes_(node_ != nullptr ? BoxesOf(*node_) : BoxesOf(*packet_)) {}

  const BoxesOf& boxes() const { return boxes_; }
  const TrianglePacket* packet() const { return packet_; }  ///< null: a node
  /// A packet stays whole.
  std::uint32_t childCount() const { return node_ != nullptr ? node_->lane_count : 1; }
  std::uint32_t child(std::uint32_t i) const {
    return node_ != nullptr ? setIn(*node_, i) : number_;
  }

 private:
  std::uint32_t number_;
  const WideNode* node_;
  const TrianglePacket* packet_;
  BoxesOf boxes_;
};

/// Triangles that may be the nearest two and wait to be measured.
struct PairCandidate {
  float bound;
  std::uint32_t leaf_of_first, leaf_of_second;
};

template <class Real>
class PairWalk {
 public:
  explicit PairWalk(PairSearch& search) : search_(search) { look(); }

  void run() {
    WaitingPair* const bottom = search_.stack;
    WaitingPair* top = bottom;
    *top++ = {0.0F, 0, 0};
    while (top != bottom && search_.pairs_left > 0 && search_.best > 0.0) {
      const WaitingPair next = *--top;
      if (static_cast<Real>(next.bound) > reach_) {
        leaveOut(next.bound);
      } else {
        top = open(next, top);
      }
    }
    while (top != bottom) leaveOut((--top)->bound);
    measureCandidates();
    if (promised_) measure(promised_pair_);
    leaveOut(leastOf(left_out_));
    // Left out because it was farther than the best of its time, it is farther than the last.
    if (static_cast<Real>(search_.unopened) > static_cast<Real>(search_.best))
      search_.unopened = kInfinity;
  }

 private:
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

  /// What every bound gives away; see above.
  Real roundingOf(const BoxesOf& first, const BoxesOf& second,
                  const Placement<Real>& placement) const {
    const double radii = search_.largest_scale * double{first.radius} + double{second.radius};
    return 64 * kRoundoff<Real> * reachOf(placement.offset) +
           static_cast<Real>(0x1p-15 * radii + search_.rounding) + Real{kTiny};
  }

  /// Puts the pairs of children that matter on the stack, the nearest on top.
  WaitingPair* open(const WaitingPair& pair, WaitingPair* top) {
    const OpenSet first(search_.first, pair.first);
    const OpenSet second(search_.second, pair.second);
    const Placement<Real> placement(first.boxes(), search_.second_from_first, second.boxes());
    const Real rounding = roundingOf(first.boxes(), second.boxes(), placement);
    Lanes<Real> bounds[kLaneCount];  // of each set of the first to those of the second
    findBounds(first.boxes(), second.boxes(), placement, rounding, bounds);
    if (first.packet() != nullptr && second.packet() != nullptr) {
      scan(*first.packet(), *second.packet(), placement, rounding, bounds);
      return top;
    }
    if (first.packet() != nullptr)
      for (std::uint32_t i = 1; i < first.boxes().count; ++i)
        bounds[0] = smaller(bounds[0], bounds[i]);
    WaitingPair* const bottom = top;
    for (std::uint32_t i = 0; i < first.childCount(); ++i) {
      if (second.packet() != nullptr) bounds[i] = Lanes<Real>::all(leastOf(bounds[i]));
      // Lanes that are not in use repeat others.
      const Truth<Real> matter = bounds[i] <= Lanes<Real>::all(reach_);
      leaveOut(!matter, bounds[i]);
      Real bound[kLaneCount];
      bounds[i].store(bound);
      const std::uint32_t used = (1U << second.childCount()) - 1;
      for (std::uint32_t rest = used & matter.bits(); rest != 0; rest &= rest - 1) {
        const std::uint32_t lane = lowestBit(rest);
        top = put({inFloat(bound[lane]), first.child(i), second.child(lane)}, bottom, top);
      }
    }
    return top;
  }

  static WaitingPair* put(const WaitingPair& pair, const WaitingPair* bottom, WaitingPair* top) {
    WaitingPair* place = top;
    for (; place != bottom && place[-1].bound < pair.bound; --place) *place = place[-1];
    *place = pair;
    return top + 1;
  }

  /// Boxes are compared along the axes of both: flat ones that lie askew tell most along their own.
  void findBounds(const BoxesOf& first, const BoxesOf& second, const Placement<Real>& placement,
                  Real rounding, Lanes<Real> (&bounds)[kLaneCount]) {
    const LaneVector<Real> low = load<Real>(first.low);
    const LaneVector<Real> high = load<Real>(first.high);
    LaneVector<Real> moved_low = low;
    LaneVector<Real> moved_high = high;
    placement(moved_low, moved_high);
    const LaneVector<Real> other_low = load<Real>(second.low);
    const LaneVector<Real> other_high = load<Real>(second.high);
    LaneVector<Real> back_low = other_low;
    LaneVector<Real> back_high = other_high;
    Placement<Real>(second, search_.first_from_second, first)(back_low, back_high);
    const auto scale = static_cast<Real>(search_.least_scale);
    const Lanes<Real> squared_scale = Lanes<Real>::all(scale * scale);
    for (std::uint32_t i = 0; i < first.count; ++i) {
      const Lanes<Real> there =
          squaredDistanceOf(other_low, other_high, laneOf(moved_low, i), laneOf(moved_high, i));
      const Lanes<Real> back =
          squaredDistanceOf(back_low, back_high, laneOf(low, i), laneOf(high, i));
      bounds[i] = root(larger(squared_scale * back, there)) - Lanes<Real>::all(rounding);
    }
    search_.bounds += first.count * second.count;
  }

  /// Looks at the triangles of two packets.
  void scan(const TrianglePacket& first, const TrianglePacket& second,
            const Placement<Real>& placement, Real rounding,
            const Lanes<Real> (&boxes)[kLaneCount]) {
    const LaneVector<Real> a = placement(load<Real>(first.corner));
    const LaneVector<Real> b = a + placement.turned(load<Real>(first.edge1));
    const LaneVector<Real> c = a + placement.turned(load<Real>(first.edge2));
    for (std::uint32_t i = 0; i < first.lane_count; ++i) {
      const Real nearest_box = leastOf(boxes[i]);
      if (nearest_box > reach_ || search_.pairs_left == 0) {
        leaveOut(nearest_box);
        continue;
      }
      const Vector<Real> tip[3] = {laneOf(a, i), laneOf(b, i), laneOf(c, i)};
      scan(first.first_leaf + i, second, gapToTriangles(tip, second), rounding);
    }
  }

  /// Looks at a triangle of the first surface and those of a packet of the second.
  void scan(std::uint32_t leaf_of_first, const TrianglePacket& second, const Gap<Real>& gap,
            Real rounding) {
    const Lanes<Real> bounds = gap.low - Lanes<Real>::all(rounding);
    const std::uint32_t looked_at =
        second.lane_count < search_.pairs_left ? second.lane_count : search_.pairs_left;
    search_.pairs_left -= looked_at;
    search_.triangles += looked_at;
    const Truth<Real> allowed =
        Lanes<Real>::numbers() <= Lanes<Real>::all(static_cast<Real>(looked_at) - 1);
    const Lanes<Real> infinite = Lanes<Real>::all(Real{kFloatInfinity});
    const Real nearest = leastOf(select(allowed, gap.high, infinite));
    const double not_farther =
        static_cast<double>(nearest + rounding) * (1.0 + 4 * kRoundoff<Real>);
    if (not_farther < search_.best) {
      search_.best = not_farther;
      look();
      const Truth<Real> those = allowed & (gap.high <= Lanes<Real>::all(nearest));
      promised_ = true;
      promised_pair_ = {0.0F, leaf_of_first, second.first_leaf + lowestBit(those.bits())};
    }
    const Truth<Real> matter = allowed & (bounds <= Lanes<Real>::all(reach_));
    const Truth<Real> used =
        Lanes<Real>::numbers() <= Lanes<Real>::all(static_cast<Real>(second.lane_count) - 1);
    leaveOut(used & !matter, bounds);
    Real bound[kLaneCount];
    bounds.store(bound);
    bool may_meet = false;
    for (std::uint32_t rest = matter.bits(); rest != 0; rest &= rest - 1) {
      const std::uint32_t lane = lowestBit(rest);
      if (candidates_.isFull()) measureCandidates();
      candidates_.add({inFloat(bound[lane]), leaf_of_first, second.first_leaf + lane});
      may_meet = may_meet || bound[lane] <= 0;
    }
    if (may_meet) measureCandidates();  // then nothing else matters
  }

  /// Measures exactly what still may be nearest.
  void measureCandidates() {
    while (!candidates_.isEmpty()) {
      const PairCandidate candidate = candidates_.takeNearest();
      if (static_cast<Real>(candidate.bound) > reach_) {
        leaveOut(candidate.bound);
      } else {
        measure(candidate);
      }
    }
  }

  void measure(const PairCandidate& pair) {
    search_.measure(search_, pair.leaf_of_first, pair.leaf_of_second);
    look();
    promised_ = promised_ && (pair.leaf_of_first != promised_pair_.leaf_of_first ||
                              pair.leaf_of_second != promised_pair_.leaf_of_second);
  }

  PairSearch& search_;
  Real reach_;                                                     // what is farther is left out
  Lanes<Real> left_out_ = Lanes<Real>::all(Real{kFloatInfinity});  // the nearest of that
  Candidates<PairCandidate> candidates_;
  bool promised_ = false;  // search_.best is owed to a pair that was not measured
  PairCandidate promised_pair_ = {};
};

inline void walkPairs(PairSearch& search) {
  constexpr double kFarSeenFromFirst = 0x1p40;  // squares do not overflow in single precision
  bool near = true;
  for (int axis = 0; axis < 3; ++axis) {
    near = near && magnitudeOf(search.second_from_first.offset[axis]) < kFar &&
           magnitudeOf(search.first_from_second.offset[axis]) < kFarSeenFromFirst;
  }
  if (near) {
    PairWalk<float>(search).run();
  } else {
    PairWalk<double>(search).run();
  }
}

}  // namespace
}  // namespace organ_collision::core
