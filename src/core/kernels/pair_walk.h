#pragma once

#include "core/kernels/frontier.h"
#include "core/kernels/pair_bounds.h"
#include "core/kernels/pair_candidates.h"
#include "core/kernels/pair_search.h"

// The walk through two trees at once, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

template <class Real>
class PairWalk {
 public:
  explicit PairWalk(PairSearch& search) : search_(search), bounds_(search) { look(); }

  void run() {
    WaitingPair* const bottom = search_.stack;
    WaitingPair* top = bottom;
    *top++ = {0.0F, 0, 0};
    while (top != bottom && search_.pairs_left > 0 && search_.best > 0.0) {
      const WaitingPair next = *--top;
      if (static_cast<Real>(next.bound) > reach_of_sets_) {
        leaveOutSets(next.bound);
      } else {
        top = open(next, top);
      }
    }
    while (top != bottom) leaveOutSets((--top)->bound);
    leaveOutSets(leastOf(sets_left_out_));
    finish();
  }

  /// The same over the pairs that are followed, with their bounds brought up to date.
  void follow(float step) {
    FollowedPairs& followed = *search_.followed;
    // What rounding takes is less than what a bound is lowered by besides.
    const Lanes<float> kept = Lanes<float>::all(1 - 4 * kRoundoff<float>);
    for (std::uint32_t i = 0; i < followed.count; i += kLaneCount)
      (kept * Lanes<float>::load(&followed.bounds[i]) - Lanes<float>::all(step))
          .store(&followed.bounds[i]);
    for (std::uint32_t i = 0; i < followed.count && search_.best > 0.0; ++i) {
      if (followed.bounds[i] > reach_) continue;
      followed.bounds[i] = inFloat(scan(search_.first.packets[followed.first[i]],
                                        search_.second.packets[followed.second[i]]));
    }
    finish();
  }

 private:
  void look() {
    reach_ = static_cast<Real>(allowedReach(search_.best, search_.share, search_.allowance));
    reach_of_sets_ = reach_ + static_cast<Real>(search_.slack);
  }

  void finish() {
    measureCandidates();
    if (promised_) measure(promised_pair_);
    leaveOut(leastOf(left_out_));
    // Left out because it was farther than the best of its time, it is farther than the last.
    if (static_cast<Real>(search_.unopened) > static_cast<Real>(search_.best))
      search_.unopened = kInfinity;
  }

  /// To follow two packets whose nearest triangles are not nearer than `bound`.
  void note(const WaitingPair& pair, Real bound) {
    if (search_.followed == nullptr) return;
    FollowedPairs& followed = *search_.followed;
    if (followed.count < FollowedPairs::kMost && bound <= reach_of_sets_) {
      followed.first[followed.count] = pair.first & ~kPacketBit;
      followed.second[followed.count] = pair.second & ~kPacketBit;
      followed.bounds[followed.count++] = inFloat(bound);
    } else if (bound < followed.clear) {
      followed.clear = bound;
    }
  }

  void leaveOut(double bound) {
    if (bound < search_.unopened) search_.unopened = bound;
  }

  void leaveOutSets(double bound) {
    leaveOut(bound);
    if (search_.followed != nullptr && bound < search_.followed->clear)
      search_.followed->clear = bound;
  }

  /// A set that is compared with another: with all its children or, the much smaller one, whole.
  struct Side {
    const OpenSet& set;
    bool is_split;

    std::uint32_t child(std::uint32_t lane) const {
      return is_split ? set.child(lane) : set.number();
    }
  };

  /// Puts the pairs of children that matter on the stack, the nearest on top.
  WaitingPair* open(const WaitingPair& pair, WaitingPair* top) {
    const OpenSet first(search_.first, pair.first);
    const OpenSet second(search_.second, pair.second);
    if (first.isPacket() && second.isPacket()) {
      note(pair, scan(first.packet(), second.packet()));
      return top;
    }
    constexpr double kMuchSmaller = 0.125;
    const double size_of_first = search_.largest_scale * double{first.radius()};
    const double size_of_second = double{second.radius()};
    const Side ours = {first, !first.isPacket() && (second.isPacket() ||
                                                    size_of_first > kMuchSmaller * size_of_second)};
    const Side theirs = {
        second,
        !second.isPacket() && (first.isPacket() || size_of_second > kMuchSmaller * size_of_first)};
    Lanes<Real> bounds[kLaneCount];
    const bool by_first = !second.isPacket();  // of a packet there is one row
    const Boxes first_boxes = first.boxes();
    const Boxes second_boxes = second.boxes();
    bounds_.betweenBoxes(first_boxes, second_boxes, by_first, bounds);
    search_.bounds +=
        (first_boxes.end - first_boxes.begin) * (second_boxes.end - second_boxes.begin);
    return by_first ? put<true>(ours, theirs, bounds, top) : put<false>(theirs, ours, bounds, top);
  }

  /// Row by row; `kByFirst`: the rows are the first's.
  template <bool kByFirst>
  WaitingPair* put(const Side& rows, const Side& lanes, Lanes<Real> (&bounds)[kLaneCount],
                   WaitingPair* top) {
    const Boxes boxes = rows.set.boxes();
    const std::uint32_t begin = boxes.begin;
    const std::uint32_t end = rows.is_split ? boxes.end : begin + 1;
    for (std::uint32_t i = end; i < boxes.end; ++i)
      bounds[begin] = smaller(bounds[begin], bounds[i]);
    const std::uint32_t used = lanes.is_split ? (1U << lanes.set.boxes().end) - 1 : 1;
    WaitingPair* const bottom = top;
    for (std::uint32_t i = begin; i < end; ++i) {
      if (!lanes.is_split) bounds[i] = Lanes<Real>::all(leastOf(bounds[i]));
      // Lanes that are not in use repeat others.
      const Truth<Real> matter = bounds[i] <= Lanes<Real>::all(reach_of_sets_);
      sets_left_out_ = leastOfThose(!matter, bounds[i], sets_left_out_);
      Real bound[kLaneCount];
      bounds[i].store(bound);
      for (std::uint32_t rest = used & matter.bits(); rest != 0; rest &= rest - 1) {
        const std::uint32_t lane = lowestBit(rest);
        const std::uint32_t row = rows.child(i);
        const std::uint32_t other = lanes.child(lane);
        top = put({inFloat(bound[lane]), kByFirst ? row : other, kByFirst ? other : row}, bottom,
                  top);
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

  /// Looks at the triangles of two packets: none are nearer than what it returns.
  Real scan(const TrianglePacket& first, const TrianglePacket& second) {
    const Vector<Real> offset = bounds_.offsetOf(first, second);
    LaneTriangles<Real> ours = bounds_.turned(first);
    ours.a = ours.a + everywhere(offset);
    const LaneTriangles<Real> theirs = trianglesOf<Real>(second);
    const Real rounding = bounds_.roundingOf(first, second, offset);
    const Lanes<Real> bounds = bounds_.betweenTriangles(ours, theirs, rounding, reach_of_sets_);
    const Truth<Real> matter = bounds <= Lanes<Real>::all(reach_);
    // Lanes that are not in use repeat others.
    Real least = leastOf(select(matter, infinite<Real>(), bounds));
    leaveOut(least);
    const std::uint32_t used = (1U << first.lane_count) - 1;
    if ((used & matter.bits()) == 0) return least;
    const LaneFaces<Real> faces(theirs);
    for (std::uint32_t rest = used & matter.bits(); rest != 0; rest &= rest - 1) {
      const std::uint32_t i = lowestBit(rest);
      const Vector<Real> a = laneOf(ours.a, i);
      const Vector<Real> tip[3] = {a, a + laneOf(ours.ab, i), a + laneOf(ours.ac, i)};
      const Real beside = leastOf(faces.gapsTo(tip)) - rounding;
      Real bound = beside > bounds[i] ? beside : bounds[i];
      if (bound > reach_ || search_.pairs_left == 0) {
        leaveOut(bound);
      } else {
        bound = scan(first.first_leaf + i, second, gapToTriangles(tip, second), rounding);
      }
      least = bound < least ? bound : least;
    }
    return least;
  }

  /// Looks at a triangle of the first surface and those of a packet of the second: none are nearer
  /// than what it returns.
  Real scan(std::uint32_t leaf_of_first, const TrianglePacket& second, const Gap<Real>& gap,
            Real rounding) {
    const Lanes<Real> bounds = gap.low - Lanes<Real>::all(rounding);
    const std::uint32_t looked_at =
        second.lane_count < search_.pairs_left ? second.lane_count : search_.pairs_left;
    search_.pairs_left -= looked_at;
    search_.triangles += looked_at;
    const Truth<Real> allowed =
        Lanes<Real>::numbers() <= Lanes<Real>::all(static_cast<Real>(looked_at) - 1);
    const Real nearest = leastOf(select(allowed, gap.high, infinite<Real>()));
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
    const Truth<Real> used = lanesInUse<Real>(second);
    left_out_ = leastOfThose(used & !matter, bounds, left_out_);
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
    return leastOf(select(used, bounds, infinite<Real>()));
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
  PairBounds<Real> bounds_;
  Real reach_;                                    // what is farther is left out
  Real reach_of_sets_;                            // sets with that
  Lanes<Real> sets_left_out_ = infinite<Real>();  // the nearest of them
  Lanes<Real> left_out_ = infinite<Real>();       // the nearest triangles
  PairCandidates candidates_;
  bool promised_ = false;  // search_.best is owed to a pair that was not measured
  PairCandidate promised_pair_ = {};
};

/// Then squares do not overflow in single precision.
inline bool isNear(const PairSearch& search) {
  constexpr double kFarSeenFromFirst = 0x1p40;
  constexpr double kMostTimesLarger = 0x1p40;
  if (!(search.largest_scale < kMostTimesLarger && search.least_scale * kMostTimesLarger > 1.0))
    return false;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(magnitudeOf(search.second_from_first.offset[axis]) < kFar) ||
        !(magnitudeOf(search.first_from_second.offset[axis]) < kFarSeenFromFirst))
      return false;
  }
  return true;
}

inline void walkPairs(PairSearch& search) {
  if (isNear(search)) {
    PairWalk<float>(search).run();
  } else {
    PairWalk<double>(search).run();
  }
}

inline void followPairs(PairSearch& search, double step) {
  const auto most = static_cast<float>(step * (1.0 + 0x1p-20) + 0x1p-100);
  if (isNear(search)) {
    PairWalk<float>(search).follow(most);
  } else {
    PairWalk<double>(search).follow(most);
  }
}

}  // namespace
}  // namespace organ_collision::core
