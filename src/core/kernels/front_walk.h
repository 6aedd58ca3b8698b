#pragma once

#include "core/kernels/front_keeper.h"
#include "core/kernels/frontier.h"
#include "core/kernels/nearest_so_far.h"

// From the front of a former walk, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

/// Of a tip of one, two or three corners.
template <std::uint32_t kCorners>
class FrontWalk {
 public:
  /// False where there is no room for all that has to be opened.
  static bool run(Search& search) {
    FrontKeeper<kCorners> keeper;
    keeper.start(*search.front);
    const Lanes<float> allowed = keeper.allowed(static_cast<float>(search.best));
    const std::uint32_t first = firstInDoubt(search, keeper.chainWithin(allowed));
    if (first == KeptSets::kNone) {  // most often
      search.unopened = kInfinity;
      return true;
    }
    typename Nearest::Room room;
    return FrontWalk(search, room, keeper).run(first, allowed);
  }

 private:
  static constexpr float kNotTied = -1.0F;
  static constexpr double kApproachRounding = 4 * kRoundoff<float>;
  using Nearest = NearestSoFar<float, kCorners, true>;

  FrontWalk(Search& search, typename Nearest::Room& room, const FrontKeeper<kCorners>& keeper)
      : search_(search), front_(*search.front), nearest_(search, room), keeper_(keeper) {}

  /// The first of a chain of kept sets of which more is within reach than the triangle that was
  /// nearest, which is measured; or none.
  static std::uint32_t firstInDoubt(const Search& search, std::uint32_t i) {
    const Front& front = *search.front;
    while (i != KeptSets::kNone && isPacket(front.kept[i]) &&
           withoutNearest(front.kept[i].within, front, packetOf(search, front.kept[i])) == 0)
      i = front.kept[i].next;
    return i;
  }

  bool run(std::uint32_t first, const Lanes<float>& allowed) {
    if (search_.best_vertex != kNoVertex) {
      if (search_.best_vertex != front_.tied_vertex) forgetTies();
      approach_ = static_cast<float>(front_.approach * (1 + kApproachRounding));
    }
    if (!lookAtAll(first, allowed)) return false;
    nearest_.finish();
    if (search_.best_leaf != front_.nearest) front_.tied_vertex = kNoVertex;
    return true;
  }

  /// At what is within reach, of a chain of kept sets; false where there is no room for what has to
  /// be opened.
  bool lookAtAll(std::uint32_t first, const Lanes<float>& allowed) {
    const std::uint32_t followed = front_.count;
    for (std::uint32_t i = first; i != KeptSets::kNone; i = front_.kept[i].next) {
      KeptSets& kept = front_.kept[i];
      if (isPacket(kept)) {
        lookAtTriangles(kept.within, kept);
      } else if (!lookAtSets(allowed, kept)) {
        return false;
      }
    }
    for (std::uint32_t i = followed; i < front_.count; ++i)  // what was opened comes last
      if (!isPacket(front_.kept[i]) && !lookAtSets(allowed, front_.kept[i])) return false;
    return true;
  }

  static bool isPacket(const KeptSets& kept) { return (kept.opened & kPacketBit) != 0; }
  static const TrianglePacket& packetOf(const Search& search, const KeptSets& kept) {
    return search.packets[kept.opened & ~kPacketBit];
  }

  /// Of lanes of a packet, by bits, those that do not hold the triangle that was nearest.
  static std::uint32_t withoutNearest(std::uint32_t lanes, const Front& front,
                                      const TrianglePacket& packet) {
    const std::uint32_t nearest = front.nearest - packet.first_leaf;
    return nearest < kLaneCount ? lanes & ~(1U << nearest) : lanes;
  }

  /// Boxes that seemed to be within reach, from where the tip was when they were looked at, may be
  /// seen to be farther now. The others are opened; false where there is no room.
  bool lookAtSets(const Lanes<float>& allowed, KeptSets& kept) {
    const WideNode& node = search_.nodes[kept.opened];
    const Truth<float> not_opened = !(infinite<float>() <= Lanes<float>::load(kept.bound.data()));
    search_.bounds += node.lane_count;
    keeper_.keepBoxes(node, nearest_.tip(), not_opened, kept);
    for (std::uint32_t lanes = (keeper_.boundsOf(kept) <= allowed).bits(); lanes != 0;
         lanes &= lanes - 1) {
      const std::uint32_t lane = lowestBit(lanes);
      if (!open(setIn(node, lane))) return false;
      kept.bound[lane] = kFloatInfinity;
    }
    return true;
  }

  bool open(std::uint32_t set) {
    KeptSets* const kept = keeper_.roomFor(set);
    if (kept == nullptr) return false;
    if ((set & kPacketBit) != 0) {
      Lanes<float>::all(kNotTied).store(kept->tied_until.data());
      scan(search_.packets[set & ~kPacketBit], *kept);
    } else {
      const Truth<float> used = lanesOf((1U << search_.nodes[set].lane_count) - 1);
      select(used, Lanes<float>{}, infinite<float>()).store(kept->bound.data());
    }
    return true;
  }

  /// At those of a packet's triangles, by bits, that may be within reach.
  void lookAtTriangles(std::uint32_t lanes, KeptSets& kept) {
    const TrianglePacket& packet = packetOf(search_, kept);
    const Truth<float> tied =
        Lanes<float>::all(approach_) <= Lanes<float>::load(kept.tied_until.data());
    const std::uint32_t in_doubt = withoutNearest(lanes & ~tied.bits(), front_, packet);
    if (in_doubt != 0 && !nearest_.isTooLate(packet) && !areTied(in_doubt, packet, kept))
      scan(packet, kept);
  }

  /// Takes bounds of a packet's triangles anew, and makes candidates of those that are within
  /// reach, but for the one that was nearest: it is measured.
  void scan(const TrianglePacket& packet, KeptSets& kept) {
    search_.triangles += packet.lane_count;
    float rounding = 0;
    Planes<float> planes;
    const SquaredRange<float> range = nearest_.tip().rangeOf(packet, rounding, &planes);
    const Truth<float> used = lanesInUse<float>(packet);
    keeper_.keepTriangles(planes, rounding, used, kept);
    const Truth<float> matter =
        used & (range.low <= Lanes<float>::all(squareOf(nearest_.reach() + rounding)));
    if (withoutNearest(matter.bits(), front_, packet) != 0)
      nearest_.consider(matter, range, rounding, packet);
  }

  void forgetTies() {
    front_.tied_vertex = search_.best_vertex;
    for (std::uint32_t i = 0; i < front_.count; ++i)
      Lanes<float>::all(kNotTied).store(front_.kept[i].tied_until.data());
  }

  /// Whether these lanes of a packet, by bits, tie at the nearest vertex; keeps until when.
  bool areTied(std::uint32_t lanes, const TrianglePacket& packet, KeptSets& kept) const {
    if (search_.best_vertex == kNoVertex) return false;
    for (; lanes != 0; lanes &= lanes - 1) {
      const std::uint32_t lane = lowestBit(lanes);
      const double room = search_.roomOfTie(search_, packet.first_leaf + lane);
      if (room < 0.0) return false;
      kept.tied_until[lane] =
          static_cast<float>((front_.approach + room) * (1 - kApproachRounding));
    }
    return true;
  }

  Search& search_;
  Front& front_;
  Nearest nearest_;
  FrontKeeper<kCorners> keeper_;
  float approach_ = kFloatInfinity;  // without a nearest vertex nobody shares it
};

/// In one piece, like walkInOnePiece().
[[gnu::flatten]] inline bool followPoint(Search& search) { return FrontWalk<1>::run(search); }

/// REQUIRES: the search is exact, and its tip is near; there is a front, of which the nearest is
/// measured.
inline bool follow(Search& search) {
  switch (search.corner_count) {
    case 1:
      return followPoint(search);
    case 2:
      return FrontWalk<2>::run(search);
    default:
      return FrontWalk<3>::run(search);
  }
}

}  // namespace
}  // namespace organ_collision::core
