#pragma once

#include "core/kernels/descend.h"
#include "core/kernels/front_keeper.h"
#include "core/kernels/frontier.h"
#include "core/kernels/nearest_so_far.h"

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

/// What a walk is for.
enum class Aim : std::uint8_t {
  kAllowed,  ///< an answer as the search allows, and how near the others are at least
  kExact,    ///< the nearest triangle: nothing needs to be known of what is left out
  kFront,    ///< that, and what is opened makes a front
};

/// Of a tip of one, two or three corners.
template <class Real, std::uint32_t kCorners, Aim kAim>
class Walk {
 public:
  static void run(Search& search) {
    typename Nearest::Room room;
    Walk(search, room).run();
  }

 private:
  static constexpr bool kExact = kAim != Aim::kAllowed;
  static constexpr std::uint32_t kRoot = 0;
  using Nearest = NearestSoFar<Real, kCorners, kExact>;
  using SeenBoxes = typename WalkingTip<Real, kCorners>::SeenBoxes;

  Walk(Search& search, typename Nearest::Room& room) : search_(search), nearest_(search, room) {
    if constexpr (kAim == Aim::kFront) keeper_.start(*search.front);
  }

  void run() {
    Frontier frontier(*search_.room);
    if (search_.dives) {
      for (const PassedNode* passed = dive(); passed-- != search_.room->passed;) {
        openBeside(*passed, frontier);
        if (nearest_.isSparing()) lookAll(frontier);  // few leaves are for what is beside the first
      }
    } else {
      frontier.addNode(kRoot);
    }
    lookAll(frontier);
    if (!nearest_.isExact()) leaveOutBoxes();
    nearest_.finish();
  }

  /// Sets with bounds of these squares are not opened.
  void leaveOut(const Lanes<Real>& squares) {
    if constexpr (!kExact) boxes_left_out_ = smaller(squares, boxes_left_out_);
  }

  void leaveOutBoxes() {
    nearest_.leaveOut(rootOf(leastOf(boxes_left_out_)) *
                      (1 - 4 * kRoundoff<Real>)-nearest_.tip().boxRounding());
  }

  /// Goes down to a packet the way of the paper's search, none of whose turns is proven, so that of
  /// the rest little matters; to nearest boxes where that search came already, and from a segment,
  /// as it may be nearest far from its middle. The boxes are measured on the way, where little else
  /// is to do. Returns the end of what was passed by.
  const PassedNode* dive() {
    const Vector<float> middle = nearest_.tip().middle();
    PassedNode* passed = search_.room->passed;
    std::uint32_t set = kRoot;
    while ((set & kPacketBit) == 0) {
      std::uint32_t next = setTowards(middle, search_.splits[set]);  // first: the rest waits for it
      const WideNode& node = search_.nodes[set];
      const auto seen = nearest_.tip().boxesSeenIn(node);
      const Lanes<Real> squares = nearest_.tip().squaresOf(seen, node);
      if (kCorners == 2 || nearest_.isSparing())
        next = setIn(node, nearestLane(node, seen, squares));
      select(only(laneOf(node, next)), infinite<float>(), inFloats(squares))
          .store(passed->squares.data());
      passed->node = set;
      ++passed;
      search_.bounds += node.lane_count;
      set = next;
    }
    lookAt(set & ~kPacketBit);
    nearest_.decide();
    return passed;
  }

  /// Many boxes may hold the tip: of those the middles tell.
  std::uint32_t nearestLane(const WideNode& node, const SeenBoxes& seen,
                            const Lanes<Real>& squares) const {
    const Lanes<Real> weight = Lanes<Real>::all(Real{0x1p-3});
    const LaneVector<Real> offsets = nearest_.tip().offsetsToMiddles(seen, node);
    return laneOfLeast(inFloats(squares + weight * dot(offsets, offsets)), node.lane_count);
  }

  /// Opens a node but for the set that the way down led to.
  void openBeside(const PassedNode& passed, Frontier& frontier) {
    const WideNode& node = search_.nodes[passed.node];
    const Lanes<Real> squares = Lanes<Real>::load(passed.squares.data());
    keep(node, put(node, squares, frontier) | (infinite<Real>() <= squares).bits());
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
    const auto seen = nearest_.tip().boxesSeenIn(node);
    if constexpr (kNearsReach) nearest_.isWithin(nearest_.tip().farthestInNearest(seen, node));
    const std::uint32_t matter = put(node, nearest_.tip().squaresOf(seen, node), frontier);
    keep(node, matter);
  }

  /// Those of a node's sets that matter are to wait; returns them, by bits.
  [[gnu::always_inline]] std::uint32_t put(const WideNode& node, const Lanes<Real>& squares,
                                           Frontier& frontier) {
    const Truth<Real> matter = squares <= Lanes<Real>::all(nearest_.squaredReach());
    leaveOut(select(matter, infinite<Real>(), squares));  // lanes not in use repeat others
    const std::uint32_t lanes = matter.bits() & ((1U << node.lane_count) - 1);
    frontier.add(node, lanes, inFloats(squares));
    return lanes;
  }

  /// The sets of a node but for those nodes among them, by bits, that are opened, too.
  void keep(const WideNode& node, std::uint32_t opened) {
    if constexpr (kAim == Aim::kFront) {
      KeptSets* const kept = keeper_.roomFor(static_cast<std::uint32_t>(&node - search_.nodes));
      const std::uint32_t nodes = (1U << node.node_count) - 1;
      const std::uint32_t all = (1U << node.lane_count) - 1;
      if (kept != nullptr)
        keeper_.keepBoxes(node, nearest_.tip(), lanesOf(all & ~(opened & nodes)), *kept);
    }
  }

  /// Few leaves are spent one packet after the other. Of many packets most do not matter once the
  /// nearest is known; a few are looked at sooner than it is told which of them do: more of them
  /// from a point, as each takes less time from there.
  void scanAll(Frontier& frontier) {
    constexpr std::uint32_t kFew = kCorners == 1 ? 20 : 6;
    if (nearest_.isSparing()) {
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
    nearest_.decide();
    constexpr Real kLargest{0x1p127F};
    const Real square = nearest_.squaredReach();
    const float least =
        frontier.dropPacketsBeyond(square < kLargest ? static_cast<float>(square) : kFloatInfinity);
    leaveOut(Lanes<Real>::all(Real{least}));
  }

  void lookAt(std::uint32_t number) {
    const TrianglePacket& packet = search_.packets[number];
    if (!nearest_.isTooLate(packet)) nearest_.scan(packet);
  }

  Search& search_;
  Nearest nearest_;
  Lanes<Real> boxes_left_out_ = infinite<Real>();  // the nearest of those, squared
  FrontKeeper<kCorners> keeper_;
};

/// What is asked most is compiled in one piece, as calls pass vectors through memory.
template <std::uint32_t kCorners, Aim kAim>
[[gnu::flatten]] inline void walkInOnePiece(Search& search) {
  Walk<float, kCorners, kAim>::run(search);
}

/// REQUIRES: a search that keeps a front is exact, and its tip is near.
template <std::uint32_t kCorners>
inline void walkFrom(Search& search) {
  if (!(search.farthest < kFar)) return Walk<double, kCorners, Aim::kAllowed>::run(search);
  if (search.front != nullptr) return Walk<float, kCorners, Aim::kFront>::run(search);
  if (search.is_exact) return walkInOnePiece<kCorners, Aim::kExact>(search);
  walkInOnePiece<kCorners, Aim::kAllowed>(search);
}

inline void walk(Search& search) {
  switch (search.corner_count) {
    case 1:
      return walkFrom<1>(search);
    case 2:
      return walkFrom<2>(search);
    default:
      return walkFrom<3>(search);
  }
}

}  // namespace
}  // namespace organ_collision::core
