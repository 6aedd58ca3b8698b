#pragma once

#include "core/bounds.h"
#include "core/gap.h"
#include "core/packet_range.h"
#include "core/search.h"
#include "core/waiting.h"

// The walk itself, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

/// Triangles of a packet that may be nearest, by lanes.
template <class Real>
struct CandidateLanes {
  Lanes<Real> bounds;  ///< infinite for the others
  std::uint32_t first_leaf;
};

/// Of a tip of one, two or three corners.
template <class Real, std::uint32_t kCorners>
class Walk {
 public:
  explicit Walk(Search& search) : search_(search) {
    Real reach = 0;
    for (std::uint32_t i = 0; i < kCorners; ++i) {
      const std::array<double, 3>& corner = search.corners[i];
      tip_[i] = {static_cast<Real>(corner[0]), static_cast<Real>(corner[1]),
                 static_cast<Real>(corner[2])};
      const Real corner_reach = reachOf(tip_[i]);
      reach = corner_reach > reach ? corner_reach : reach;
    }
    tip_rounding_ = kRoundoff<Real> * reach;
    const WideNode& root = search.nodes[0];
    const Vector<Real> origin = {Real{root.origin[0]}, Real{root.origin[1]}, Real{root.origin[2]}};
    // Boxes are as much larger as what they enclose may be off; gaps along directions are not.
    box_rounding_ = roundingOf(reach + reachOf(origin) + 4 * Real{root.radius},
                               kCorners == 2 ? root.radius : 0.0F);
    look();
  }

  void run() {
    constexpr std::uint32_t kRoot = 0;
    Stack stack(search_.stack);
    for (std::uint32_t set = kRoot; set != kNoSet;
         set = stack.take(search_.leaves_left > 0 ? squared_reach_ : Real{-kFloatInfinity},
                          boxes_left_out_)) {
      while ((set & kPacketBit) == 0) set = open(search_.nodes[set], stack);
      if (set == kNoSet) continue;
      const std::uint32_t packet = set & ~kPacketBit;
      note(packet,
           isTooLate(search_.packets[packet]) ? Lanes<Real>{} : scan(search_.packets[packet]));
    }
    if (search_.followed != nullptr || !isExact()) leaveOutBoxes();
    finish();
  }

  /// The same over the packets that are followed.
  void follow() {
    Followed& followed = *search_.followed;
    const auto drift = static_cast<float>(followed.drift * (1 + kKept));
    const float nearest = kept(static_cast<Real>(measure(followed.nearest)));
    if (search_.best_vertex != kNoVertex) {
      if (search_.best_vertex != followed.tied_vertex) forgetTies();
      drift_of_ties_ = drift;
    }
    for (std::uint32_t first = 0; first < followed.count; first += kLaneCount) {
      const Lanes<float> bounds = Lanes<float>::load(&followed.bounds[first]);
      for (std::uint32_t rest = (bounds <= Lanes<float>::all(reach_ + drift)).bits(); rest != 0;
           rest &= rest - 1) {
        const std::uint32_t i = first + lowestBit(rest);
        if (i < followed.count && !isTooLate(search_.packets[followed.packets[i]]))
          lookAgain(i, reach_ + drift, nearest);
      }
    }
    finish();
    if (search_.best_leaf != followed.nearest) followed.tied_vertex = kNoVertex;
  }

 private:
  static constexpr bool kIsPoint = kCorners == 1;

  /// What was left out because it was farther than the best of its time is farther than the last.
  bool isExact() const {
    return search_.share == 1.0 && search_.allowance == 0.0 && search_.leaves_left > 0;
  }

  void leaveOutBoxes() {
    const double box = rootOf(leastOf(boxes_left_out_)) * (1 - 4 * kRoundoff<Real>)-box_rounding_;
    if (search_.followed != nullptr && box < search_.followed->clear) search_.followed->clear = box;
    leaveOut(box);
  }

  void finish() {
    measureCandidates();
    if (!isExact()) leaveOut(leastOf(left_out_));
    if (isExact() || search_.unopened >= search_.best) search_.unopened = kInfinity;
  }

  /// Of triangles that touch the tip the first is named.
  bool isTooLate(const TrianglePacket& packet) const {
    return search_.best == 0.0 && packet.first_leaf > search_.best_leaf;
  }

  /// What rounding takes from a bound that is kept is less than this part of it.
  static constexpr float kKept = 4 * kRoundoff<float>;
  /// A bound of today, as it is kept.
  float kept(Real bound) const {
    const auto drift = static_cast<Real>(search_.followed->drift);
    return inFloat((bound + drift - Real{kTiny}) * (1 - Real{kKept}));
  }
  Lanes<Real> kept(const Lanes<Real>& bounds) const {
    const auto drift = static_cast<Real>(search_.followed->drift);
    return (bounds + Lanes<Real>::all(drift)) * Lanes<Real>::all(1 - Real{kKept});
  }

  static constexpr float kNotTied = -1.0F;

  void forgetTies() {
    Followed& followed = *search_.followed;
    followed.tied_vertex = search_.best_vertex;
    for (std::uint32_t i = 0; i < followed.count; ++i)
      Lanes<float>::all(kNotTied).store(followed.tied_until[i].data());
  }

  /// Brings the bounds of a packet up to date that may be within `reach`, as bounds are kept; that
  /// of the triangle that was nearest is known.
  void lookAgain(std::uint32_t i, float reach, float nearest) {
    Followed& followed = *search_.followed;
    const TrianglePacket& packet = search_.packets[followed.packets[i]];
    LaneFloats& lanes = followed.lanes[i];
    const std::uint32_t nearest_lane = followed.nearest - packet.first_leaf;
    if (nearest_lane < packet.lane_count) lanes[nearest_lane] = kFloatInfinity;
    const float tied = kept(static_cast<Real>(search_.best));
    const Lanes<float> bounds = Lanes<float>::load(lanes.data());
    const Truth<float> within = lanesInUse<float>(packet) & (bounds <= Lanes<float>::all(reach));
    const Truth<float> surely_tied =
        Lanes<float>::all(drift_of_ties_) <= Lanes<float>::load(followed.tied_until[i].data());
    select(within & surely_tied, Lanes<float>::all(tied), bounds).store(lanes.data());
    std::uint32_t rest = (within & !surely_tied).bits();
    for (; rest != 0; rest &= rest - 1) {
      const std::uint32_t lane = lowestBit(rest);
      const double room = search_.roomOfTie(search_, packet.first_leaf + lane);
      if (room < 0.0) break;
      lanes[lane] = tied;
      followed.tied_until[i][lane] = static_cast<float>((followed.drift + room) * (1 - kKept));
    }
    if (rest != 0) kept(scan(packet)).storeRounded(lanes);
    if (nearest_lane < packet.lane_count) lanes[nearest_lane] = nearest;
    followed.bounds[i] = leastOf(Lanes<float>::load(lanes.data()));
  }

  /// To follow a packet whose triangles are not nearer than `bounds`.
  void note(std::uint32_t packet, const Lanes<Real>& bounds) {
    if (search_.followed == nullptr) return;
    Followed& followed = *search_.followed;
    if (followed.count == Followed::kMost) {
      const Real least = leastOf(bounds);
      if (least < followed.clear) followed.clear = least;
      return;
    }
    const std::uint32_t i = followed.count++;
    followed.packets[i] = packet;
    kept(bounds).storeRounded(followed.lanes[i]);
    Lanes<float>::all(kNotTied).store(followed.tied_until[i].data());
    followed.bounds[i] = leastOf(Lanes<float>::load(followed.lanes[i].data()));
  }

  void look() {
    reach_ = static_cast<Real>(allowedReach(search_.best, search_.share, search_.allowance));
    const Real box_reach = reach_ + static_cast<Real>(search_.slack) + box_rounding_;
    squared_reach_ =
        box_reach > 0 ? box_reach * box_reach * (1 + 16 * kRoundoff<Real>) : Real{-1};  // no box
  }

  void leaveOut(double bound) {
    if (bound < search_.unopened) search_.unopened = bound;
  }

  /// The box of the tip in a node's or packet's coordinates; how far it is from the origin.
  template <class Turn>
  Real tipBox(const std::array<float, 3>& origin, const Turn& turn, Vector<Real>& low,
              Vector<Real>& high) const {
    const Vector<Real> first = relative(tip_[0], origin);
    Real farthest = reachOf(first);
    low = high = turn(first);
    if constexpr (!kIsPoint) {
      for (std::uint32_t i = 1; i < kCorners; ++i) {
        const Vector<Real> corner = relative(tip_[i], origin);
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

  /// The boxes' squared distances, but for box_rounding_.
  Lanes<Real> squaresOf(const WideNode& node) {
    const auto turn = [&node](const Vector<Real>& v) { return turned(node, v); };
    const LaneVector<Real> boxes_low = load<Real>(node.low);
    const LaneVector<Real> boxes_high = load<Real>(node.high);
    Vector<Real> low, high;
    tipBox(node.origin, turn, low, high);
    const Lanes<Real> squares = squaredDistanceOf(boxes_low, boxes_high, low, high);
    if constexpr (kCorners == 2) {
      const Lanes<Real> gaps =
          larger(gapToBoxes(turn(relative(tip_[0], node.origin)),
                            turn(relative(tip_[1], node.origin)), boxes_low, boxes_high) -
                     Lanes<Real>::all(box_rounding_),
                 Lanes<Real>{});
      return larger(squares, gaps * gaps);
    }
    return squares;
  }

  /// The nearest child that matters, if any; puts the others on the stack.
  std::uint32_t open(const WideNode& node, Stack& stack) {
    const Lanes<Real> squares = squaresOf(node);
    search_.bounds += node.lane_count;
    const Truth<Real> matter = squares <= Lanes<Real>::all(squared_reach_);
    // Lanes that are not in use repeat others.
    boxes_left_out_ = leastOfThose(!matter, squares, boxes_left_out_);
    const std::uint32_t waiting = matter.bits() & ((1U << node.lane_count) - 1);
    if (waiting == 0) return kNoSet;
    if (search_.fetches) fetchThose(waiting, node);
    const Keys none = -1 - Keys{};
    const Keys used = kLaneNumbers < static_cast<std::int32_t>(node.lane_count);
    const Keys keys = used != 0 ? keysOf(squares) : none;
    // Keys are rounded: the nearest is of a box that matters, or of one that ties with it.
    const std::uint32_t nearest = leastOf(keys);
    stack.push(node, without(nearest, chosenBy(matter) != 0 ? keys : none));
    return setIn(node, nearest & kLaneBits);
  }

  /// Brings what is in these lanes of a node closer, by bits. As a call gcc would leave it out, as
  /// one that does nothing.
  [[gnu::always_inline]] void fetchThose(std::uint32_t lanes, const WideNode& node) const {
    for (; lanes != 0; lanes &= lanes - 1) fetch(search_, setIn(node, lowestBit(lanes)));
  }

  Range<Real> rangeOf(const TrianglePacket& packet, Real& rounding) const {
    Vector<Real> low, high;
    const Real farthest = tipBox(
        packet.origin, [](const Vector<Real>& v) { return v; }, low, high);
    rounding = roundingOf(farthest, packet.radius) + tip_rounding_ + Real{kPlaceRounding};
    if constexpr (kIsPoint) {
      return distanceOfPoint(packet, low, farthest + 2 * Real{packet.radius});
    } else {
      Vector<Real> tip[kCorners];
      for (std::uint32_t i = 0; i < kCorners; ++i) tip[i] = relative(tip_[i], packet.origin);
      const Gap<Real> gap = gapToTriangles(tip, packet);
      rounding = rounding + rounding;
      return {gap.low, gap.high};
    }
  }

  /// The triangles to look at while there are leaves left: one after the other, the nearest box
  /// first, until no box is nearer than the best. None is farther than its `high`.
  Truth<Real> chosen(const TrianglePacket& packet, const Lanes<Real>& high, Real rounding) {
    LaneVector<Real> least, most;
    boxTriangles(packet, least, most);
    Vector<Real> tip_low, tip_high;
    tipBox(
        packet.origin, [](const Vector<Real>& v) { return v; }, tip_low, tip_high);
    Real boxes[kLaneCount];
    (root(squaredDistanceOf(least, most, tip_low, tip_high)) - Lanes<Real>::all(rounding))
        .store(boxes);
    search_.bounds += packet.lane_count;
    alignas(kVectorBytes) float is_chosen[kLaneCount] = {};
    Real reach = reach_;
    for (; search_.leaves_left > 0; --search_.leaves_left) {
      std::uint32_t nearest = 0;
      for (std::uint32_t lane = 1; lane < packet.lane_count; ++lane)
        if (boxes[lane] < boxes[nearest]) nearest = lane;
      if (!(boxes[nearest] <= reach) || is_chosen[nearest] == 1.0F) break;
      boxes[nearest] = Real{kFloatInfinity};
      is_chosen[nearest] = 1.0F;
      reach = high[nearest] < reach ? high[nearest] : reach;
      ++search_.triangles;
    }
    return Lanes<Real>::all(1) <= Lanes<Real>::load(is_chosen);
  }

  /// Looks at the triangles of a packet: those that may be nearest are to be measured. All are at
  /// least as far as what it returns if packets are followed.
  Lanes<Real> scan(const TrianglePacket& packet) {
    Real rounding = 0;
    const Range<Real> range = rangeOf(packet, rounding);
    const Lanes<Real> bounds = range.low - Lanes<Real>::all(rounding);
    const Truth<Real> used = lanesInUse<Real>(packet);
    Truth<Real> allowed = used;
    if (search_.sparing) {
      allowed = chosen(packet, range.high + Lanes<Real>::all(rounding), rounding);
    } else {
      search_.triangles += packet.lane_count;
    }
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
      if (search_.fetches) __builtin_prefetch(search_.leaf_corners + promised_leaf_);
    }
    const Truth<Real> matter = allowed & (bounds <= Lanes<Real>::all(reach_));
    left_out_ = leastOfThose(used & !matter, bounds, left_out_);
    const Lanes<Real> infinite = Lanes<Real>::all(Real{kFloatInfinity});
    candidates_[candidate_count_] = {select(matter, bounds, infinite), packet.first_leaf};
    candidate_count_ += matter.bits() != 0 ? 1 : 0;
    const bool may_meet = !kIsPoint && (matter & (bounds <= Lanes<Real>{})).bits() != 0;
    if (may_meet || candidate_count_ == kMostCandidates) measureCandidates();
    return select(used, bounds, infinite);
  }

  /// Measures exactly what still may be nearest, first what seems to be.
  void measureCandidates() {
    if (promised_) measure(promised_leaf_);
    for (std::uint32_t i = 0; i < candidate_count_; ++i) {
      const auto& [bounds, first_leaf] = candidates_[i];
      const Truth<Real> within = bounds <= Lanes<Real>::all(reach_);
      left_out_ = leastOfThose(!within, bounds, left_out_);
      for (std::uint32_t rest = within.bits(); rest != 0; rest &= rest - 1) {
        const std::uint32_t leaf = first_leaf + lowestBit(rest);
        if (leaf != search_.best_leaf) measure(leaf);
      }
    }
    candidate_count_ = 0;
  }

  double measure(std::uint32_t leaf) {
    const double distance = search_.measure(search_, leaf);
    look();
    promised_ = promised_ && leaf != promised_leaf_;
    return distance;
  }

  Search& search_;
  Vector<Real> tip_[kCorners];
  Real tip_rounding_;   // of its corners
  Real box_rounding_;   // of the distance to any box
  Real reach_;          // what is farther is left out
  Real squared_reach_;  // a box with that
  Lanes<Real> boxes_left_out_ =
      Lanes<Real>::all(Real{kFloatInfinity});                      // the nearest of those, squared
  Lanes<Real> left_out_ = Lanes<Real>::all(Real{kFloatInfinity});  // the nearest triangle of them
  static constexpr std::uint32_t kMostCandidates = 16;
  CandidateLanes<Real> candidates_[kMostCandidates];
  std::uint32_t candidate_count_ = 0;
  float drift_of_ties_ = kFloatInfinity;  // without a nearest vertex nobody shares it
  bool promised_ = false;  // search_.best is owed to a triangle that was not measured
  std::uint32_t promised_leaf_ = 0;
};

template <class Real>
inline void walkAs(Search& search) {
  if (search.corner_count == 1) Walk<Real, 1>(search).run();
  if (search.corner_count == 2) Walk<Real, 2>(search).run();
  if (search.corner_count == 3) Walk<Real, 3>(search).run();
}

inline void walk(Search& search) {
  if (search.farthest < kFar) {
    walkAs<float>(search);
  } else {
    walkAs<double>(search);
  }
}

/// REQUIRES: the tip is near.
inline void follow(Search& search) {
  if (search.corner_count == 1) Walk<float, 1>(search).follow();
  if (search.corner_count == 2) Walk<float, 2>(search).follow();
  if (search.corner_count == 3) Walk<float, 3>(search).follow();
}

}  // namespace
}  // namespace organ_collision::core
