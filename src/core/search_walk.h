#pragma once

#include "core/bounds.h"
#include "core/candidates.h"
#include "core/frontier.h"
#include "core/search.h"
#include "core/walking_tip.h"

// The walk itself, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

/// Brings what will be read soon closer.
template <class Item>
inline void fetch(const Item& item) {
  constexpr std::size_t kLine = 64;
  for (std::size_t i = 0; i < sizeof(item); i += kLine)
    __builtin_prefetch(reinterpret_cast<const char*>(&item) + i);
}

/// Of a tip of one, two or three corners.
template <class Real, std::uint32_t kCorners>
class Walk {
 public:
  explicit Walk(Search& search)
      : search_(search),
        tip_(search),
        share_(search.share == 1.0 ? 1 : static_cast<Real>(search.share * (1 + 0x1p-22))),
        allowance_(Real{inFloat(search.allowance)}) {
    look();
  }

  void run() {
    constexpr std::uint32_t kRoot = 0;
    Frontier frontier(search_.room);
    if (search_.dives) {
      for (const PassedNode* node = dive(kRoot); node-- != search_.room.passed;) {
        put(*node->node, Lanes<Real>::load(node->squares.data()), frontier);
        if (search_.sparing) lookAll(frontier);  // few leaves are for what is beside the first
      }
    } else {
      frontier.addNode(kRoot);
    }
    lookAll(frontier);
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
    const double box =
        rootOf(leastOf(boxes_left_out_)) * (1 - 4 * kRoundoff<Real>)-tip_.boxRounding();
    if (search_.followed != nullptr && box < search_.followed->clear) search_.followed->clear = box;
    leaveOut(box);
  }

  void finish() {
    measureCandidates();
    if (!isExact()) leaveOut(candidates_.leftOut());
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
    const Lanes<float> nearest_lane =
        Lanes<float>::all(static_cast<float>(followed.nearest - packet.first_leaf));
    const Truth<float> used = lanesInUse<float>(packet);
    const Truth<float> is_nearest = used & (Lanes<float>::numbers() <= nearest_lane) &
                                    (nearest_lane <= Lanes<float>::numbers());
    Lanes<float> bounds = Lanes<float>::load(followed.lanes[i].data());
    const Truth<float> within = used & !is_nearest & (bounds <= Lanes<float>::all(reach));
    const Truth<float> surely_tied =
        Lanes<float>::all(drift_of_ties_) <= Lanes<float>::load(followed.tied_until[i].data());
    const float tied = kept(static_cast<Real>(search_.best));
    bounds = select(within & surely_tied, Lanes<float>::all(tied), bounds);
    const std::uint32_t in_doubt = (within & !surely_tied).bits();
    if (in_doubt != 0) {
      if (areTied(in_doubt, i, packet)) {
        bounds = select(within, Lanes<float>::all(tied), bounds);
      } else {
        bounds = kept(candidates_.boundsOf(scan(packet)));
      }
    }
    bounds = select(is_nearest, Lanes<float>::all(nearest), bounds);
    bounds.store(followed.lanes[i].data());
    followed.bounds[i] = leastOf(bounds);
  }

  /// Whether these lanes of a packet, by bits, tie at the nearest vertex; keeps until when.
  bool areTied(std::uint32_t lanes, std::uint32_t i, const TrianglePacket& packet) {
    Followed& followed = *search_.followed;
    for (; lanes != 0; lanes &= lanes - 1) {
      const std::uint32_t lane = lowestBit(lanes);
      const double room = search_.roomOfTie(search_, packet.first_leaf + lane);
      if (room < 0.0) return false;
      followed.tied_until[i][lane] = static_cast<float>((followed.drift + room) * (1 - kKept));
    }
    return true;
  }

  /// To follow a packet whose triangles are not nearer than `bounds`.
  void note(std::uint32_t packet, const Lanes<Real>& bounds) {
    Followed& followed = *search_.followed;
    if (followed.count == Followed::kMost) {
      const Real least = leastOf(bounds);
      if (least < followed.clear) followed.clear = least;
      return;
    }
    const std::uint32_t i = followed.count++;
    followed.packets[i] = packet;
    const Lanes<float> kept_bounds = inFloats(kept(bounds));
    kept_bounds.store(followed.lanes[i].data());
    Lanes<float>::all(kNotTied).store(followed.tied_until[i].data());
    followed.bounds[i] = leastOf(kept_bounds);
  }

  void look() { look(static_cast<Real>(search_.best)); }
  void look(Real best) {
    reach_ = allowedReach(best, share_, allowance_);
    squared_reach_ = squaredReachOf(reach_);
  }

  /// Of boxes whose sets matter within that reach.
  Real squaredReachOf(Real reach) const {
    return squareOf(reach + static_cast<Real>(search_.slack) + tip_.boxRounding());
  }
  Real squaredReach() const {
    return search_.leaves_left > 0 ? squared_reach_ : Real{-kFloatInfinity};
  }

  void leaveOut(double bound) {
    if (bound < search_.unopened) search_.unopened = bound;
  }

  /// Goes down to a packet that is as near as can be told on the way, so that of the rest little
  /// matters. Returns the end of what was passed by.
  const PassedNode* dive(std::uint32_t set) {
    // Many boxes may hold the tip: of those the middles tell.
    const Lanes<Real> weight = Lanes<Real>::all(Real{0x1p-3});
    const WideNode* const nodes = search_.nodes;
    PassedNode* passed = search_.room.passed;
    while ((set & kPacketBit) == 0) {
      const WideNode& node = nodes[set];
      search_.bounds += node.lane_count;
      const auto seen = tip_.boxesSeenIn(node);
      const Lanes<Real> squares = tip_.squaresOf(seen, node);
      const LaneVector<Real> way = tip_.wayToMiddles(seen, node);
      const std::uint32_t lane =
          laneOfLeast(inFloats(squares + weight * dot(way, way)), node.lane_count);
      inFloats(squares).store(passed->squares.data());
      passed->squares[lane] = kFloatInfinity;
      passed->node = &node;
      ++passed;
      set = setIn(node, lane);
    }
    lookAt(set & ~kPacketBit);
    decide();
    return passed;
  }

  /// Looks at all that waits.
  void lookAll(Frontier& frontier) {
    openAll(frontier);
    scanAll(frontier);
  }

  /// Level by level: the nodes of a level do not wait for each other.
  void openAll(Frontier& frontier) {
    constexpr std::uint32_t kMany = 16;  // nodes, of which most turn out not to matter
    std::uint32_t next = 0;
    while (next != frontier.nodeCount()) {
      const std::uint32_t end = frontier.nodeCount();
      if (search_.fetches)
        for (std::uint32_t i = next; i != end; ++i) fetch(search_.nodes[frontier.node(i)]);
      if (end - next > kMany) {
        for (; next != end; ++next) open<true>(search_.nodes[frontier.node(next)], frontier);
      } else {
        for (; next != end; ++next) open<false>(search_.nodes[frontier.node(next)], frontier);
      }
    }
    frontier.dropNodes();
  }

  /// `kNearsReach`: nor does matter what is farther than all of some lane's set.
  template <bool kNearsReach>
  void open(const WideNode& node, Frontier& frontier) {
    search_.bounds += node.lane_count;
    const auto seen = tip_.boxesSeenIn(node);
    if constexpr (kNearsReach) {
      const Real reach = squaredReachOf(tip_.farthestInNearest(seen, node) + tip_.boxRounding());
      squared_reach_ = reach < squared_reach_ ? reach : squared_reach_;
    }
    put(node, tip_.squaresOf(seen, node), frontier);
  }

  /// Those of a node's sets that matter are to wait.
  [[gnu::always_inline]] void put(const WideNode& node, const Lanes<Real>& squares,
                                  Frontier& frontier) {
    const Truth<Real> matter = squares <= Lanes<Real>::all(squaredReach());
    // Lanes that are not in use repeat others.
    boxes_left_out_ = leastOfThose(!matter, squares, boxes_left_out_);
    frontier.add(node, matter.bits() & ((1U << node.lane_count) - 1), inFloats(squares));
  }

  /// Few leaves are spent one packet after the other. Of many packets most do not matter once the
  /// nearest is known; a few are looked at sooner than it is told which of them do.
  void scanAll(Frontier& frontier) {
    constexpr std::uint32_t kFew = 8;
    if (search_.sparing) {
      while (frontier.packetCount() > 0) lookAtNearest(frontier);
      return;
    }
    if (frontier.packetCount() > kFew) lookAtNearest(frontier);
    if (search_.fetches)
      for (std::uint32_t i = 0; i < frontier.packetCount(); ++i)
        fetch(search_.packets[frontier.packet(i)]);
    for (std::uint32_t i = 0; i < frontier.packetCount(); ++i) lookAt(frontier.packet(i));
    frontier.dropPackets();
  }

  /// Leaves out packets that are too far then.
  void lookAtNearest(Frontier& frontier) {
    lookAt(frontier.takeNearestPacket());
    decide();
    constexpr Real kLargest{0x1p127F};
    const Real square = squaredReach();
    const float least =
        frontier.dropPacketsBeyond(square < kLargest ? static_cast<float>(square) : kFloatInfinity);
    boxes_left_out_ = smaller(Lanes<Real>::all(Real{least}), boxes_left_out_);
  }

  void lookAt(std::uint32_t packet) {
    const Lanes<Real> squares =
        isTooLate(search_.packets[packet]) ? Lanes<Real>{} : scan(search_.packets[packet]);
    if (search_.followed != nullptr) note(packet, candidates_.boundsOf(squares));
  }

  /// The triangles to look at while there are leaves left: one after the other, the nearest box
  /// first, until no box is nearer than the best. None is farther than its `high`.
  Truth<Real> chosen(const TrianglePacket& packet, const Lanes<Real>& high, Real rounding) {
    Real boxes[kLaneCount];
    (root(tip_.squaresToBoxesOfTriangles(packet)) - Lanes<Real>::all(rounding)).store(boxes);
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

  /// Looks at the triangles of a packet, which become candidates. Returns the squares of their
  /// bounds, but for rounding.
  Lanes<Real> scan(const TrianglePacket& packet) {
    if (candidates_.packetCount() == Candidates<Real>::kMost) makeRoom();
    Real rounding = 0;
    const SquaredRange<Real> range = tip_.rangeOf(packet, rounding);
    const Truth<Real> used = lanesInUse<Real>(packet);
    Truth<Real> allowed = used;
    if (search_.sparing) {
      allowed = chosen(packet, root(range.high) + Lanes<Real>::all(rounding), rounding);
      candidates_.leaveOut(used & !allowed, range.low);
    } else {
      search_.triangles += packet.lane_count;
    }
    candidates_.add(allowed, range, rounding, packet.first_leaf);
    if (!kIsPoint) {
      const Lanes<Real> meeting = Lanes<Real>::all(squareOf(rounding));
      if ((allowed & (range.low <= meeting)).bits() != 0) measureCandidates();
    }
    return select(used, range.low, infinite<Real>());
  }

  /// What is nearest of the candidates so far.
  void decide() {
    const Real not_farther = candidates_.notFarther();
    if (!(static_cast<double>(not_farther) < search_.best)) return;
    search_.best = not_farther;
    look(not_farther);
    promised_ = true;
    promised_leaf_ = candidates_.nearestLeaf();
    if (search_.fetches) __builtin_prefetch(search_.leaf_corners + promised_leaf_);
  }

  void makeRoom() {
    decide();
    candidates_.dropBeyond(reachOfCandidates());
    if (candidates_.packetCount() > Candidates<Real>::kMost / 2) measureCandidates();
  }

  /// Measures exactly what still may be nearest, first what seems to be. Which those are is told
  /// before, so that none waits for the one before it.
  void measureCandidates() {
    decide();
    typename Candidates<Real>::Leaves leaves;
    const std::uint32_t count = candidates_.takeWithin(reachOfCandidates(), leaves);
    std::uint32_t first = search_.best_leaf;
    if (promised_) measure(first = promised_leaf_);
    for (std::uint32_t i = 0; i < count; ++i)
      if (leaves[i] != first) measure(leaves[i]);
  }

  /// Of few leaves no errors are allowed besides: more of them never make an answer worse.
  Real reachOfCandidates() const {
    return search_.sparing ? static_cast<Real>(search_.best) : reach_;
  }

  double measure(std::uint32_t leaf) {
    const double distance = search_.measure(search_, leaf);
    look();
    promised_ = promised_ && leaf != promised_leaf_;
    return distance;
  }

  Search& search_;
  WalkingTip<Real, kCorners> tip_;
  Real share_, allowance_;  // the search's, rounded so that nothing more is left out
  Real reach_;              // what is farther is left out
  Real squared_reach_;      // a box with that
  Lanes<Real> boxes_left_out_ = infinite<Real>();  // the nearest of those, squared
  Candidates<Real> candidates_;
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
