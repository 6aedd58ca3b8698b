#pragma once

#include "core/kernels/bounds.h"
#include "core/kernels/descent.h"
#include "core/kernels/lane_vector.h"

// The paper's search, for whichever vector unit includes it: all splits of a wide node, and of a
// packet, at a time.
namespace organ_collision::core {
namespace {

// What rounding makes of the difference of the squared distances from two poles, besides
// Descent::rounding; see greedy_search.cpp.
constexpr float kApartRounding = 0x1p-19F;     // as a part of reach times the poles' distance
constexpr float kOffsetRounding = 0x1p-20F;    // of their offsets from the tip
constexpr float kPlaneRounding = 0x1p-15F;     // of the reach: both together, at most
constexpr float kSquareRounding = 0x1.1p-36F;  // squared, of reach^2 times the sum of the squares

constexpr std::uint64_t kEachByte = 0x0101010101010101U;

/// The first byte that is 0. REQUIRES: one is.
inline std::uint32_t firstZero(std::uint64_t bytes) {
  const std::uint64_t zeros = (bytes - kEachByte) & ~bytes & (kEachByte << 7U);
  return static_cast<std::uint32_t>(__builtin_ctzll(zeros)) / 8;
}

/// Where splits lead to.
struct Choice {
  std::uint32_t set;    ///< a lane
  std::uint32_t above;  ///< the splits on the way, by bits
  std::uint32_t splits() const { return static_cast<std::uint32_t>(__builtin_popcount(above)); }
  /// Whether all of these are among those that are sure.
  bool isSure(std::uint32_t sure) const { return (above & ~sure) == 0; }
};

/// From a lane on; `firsts`: those splits, by bits, that lead to their first set.
inline Choice chosenSet(const SplitPaths& paths, std::uint32_t first, std::uint32_t firsts) {
  const std::uint64_t wrong = (firsts * kEachByte & paths.above) ^ paths.firsts;
  const std::uint32_t set = first + firstZero(wrong >> (8 * first));
  return {set, static_cast<std::uint32_t>(paths.above >> (8 * set)) & 0xFFU};
}

/// The differences of the squared distances from the poles, as the planes between them tell.
inline Lanes<float> sidesOf(const Vector<float>& tip, const NodeSplits& node) {
  const LaneVector<float> apart = load<float>(node.apart);
  const LaneVector<float> twice = everywhere(tip + tip);
  return (twice.x * apart.x + twice.y * apart.y) +
         (twice.z * apart.z - Lanes<float>::load(node.middle.data()));
}

/// The node, or kPacketBit and the packet, that they lead to: the paper's way, but for rounding.
inline std::uint32_t setTowards(const Vector<float>& tip, const NodeSplits& node) {
  const std::uint32_t set = node.sets[chosenSet(node.paths, 0, signsOf(sidesOf(tip, node))).set];
  return (set & kPacketBit) == 0 ? set : kPacketBit | (set & ~kPacketBit) / kLaneCount;
}

/// Those of them, by bits, that no node's rounding turns.
inline std::uint32_t clearSides(const Descent& descent, const Lanes<float>& sides) {
  const float rounding = kPlaneRounding * descent.reach + descent.rounding;
  return (Lanes<float>::all(rounding) <= magnitudeOf(sides)).bits();
}

/// Those that this node's rounding does not turn.
inline std::uint32_t sureSides(const Descent& descent, const NodeSplits& node,
                               const Lanes<float>& sides) {
  const Vector<float> offset = relative(vectorOf<float>(descent.tip), node.origin);
  const Lanes<float> of_apart =
      Lanes<float>::all(kApartRounding * descent.reach) * reachOf(load<float>(node.apart));
  const float of_offset = kOffsetRounding * 2 * (reachOf(offset) + node.radius) + descent.rounding;
  return (of_apart + Lanes<float>::all(of_offset) <= magnitudeOf(sides)).bits();
}

/// The differences, and which of them rounding does not turn, by bits.
struct ProvenSides {
  Lanes<float> sides;
  std::uint32_t sure;
};

/// From the squared distances themselves.
inline ProvenSides sidesOf(const Descent& descent, const TrianglePacket& packet,
                           const PacketSplits& splits) {
  const LaneVector<float> offset =
      load<float>(packet.centroid) - everywhere(vectorOf<float>(descent.tip));
  const Lanes<float> squares = dot(offset, offset);
  const Lanes<float> one = permuted(squares, splits.poles[0]);
  const Lanes<float> other = permuted(squares, splits.poles[1]);
  const Lanes<float> sides = one - other;
  const Lanes<float> rounding =
      Lanes<float>::all(kSquareRounding * descent.reach * descent.reach) * (one + other) +
      Lanes<float>::all(4 * descent.rounding * descent.rounding);
  return {sides, (rounding <= sides * sides).bits()};
}

/// What was found. Where it is what the last descent found, the processor goes on without it, as a
/// branch can be foreseen, while a number is waited for: so no level of a descent that goes the way
/// of the last one waits for the level above.
inline std::uint32_t foreseen(std::uint32_t found, std::uint32_t& last) {
  std::uint32_t same = last;
  __asm__("" : "+r"(same));  // or the compiler would see that it may as well use `found`
  if (found == last) return same;
  last = found;
  return found;
}

/// From descent.node to a leaf; false, at some node, where rounding could decide wrongly.
inline bool descend(Descent& descent) {
  std::uint32_t* last = descent.last_way->data();
  for (std::uint32_t node_number = descent.node;;) {
    const NodeSplits& node = descent.nodes[node_number];
    const Lanes<float> sides = sidesOf(vectorOf<float>(descent.tip), node);
    const Choice below = chosenSet(node.paths, 0, signsOf(sides));
    if (!below.isSure(clearSides(descent, sides))) {  // seldom
      descent.node = node_number;
      descent.firsts = signsOf(sides);
      descent.sure = sureSides(descent, node, sides);
      if (!below.isSure(descent.sure)) return false;
    }
    const std::uint32_t set = foreseen(node.sets[below.set], *last);
    if (last != &descent.last_way->back()) ++last;
    if ((set & kPacketBit) == 0) {
      node_number = set;
      descent.splits += below.splits();
      continue;
    }
    const std::uint32_t number = (set & ~kPacketBit) / kLaneCount;
    const TrianglePacket& packet = descent.packets[number];
    const std::uint32_t first_leaf = packet.first_leaf;
    __builtin_prefetch(descent.leaf_corners + first_leaf);  // what comes next waits for them
    const PacketSplits& splits = descent.packet_splits[number];
    const ProvenSides within = sidesOf(descent, packet, splits);
    const Choice leaf = chosenSet(splits.paths, set % kLaneCount, signsOf(within.sides));
    if (!leaf.isSure(within.sure)) {
      descent.node = node_number;
      descent.sure = 0;  // from the node on, all is asked again
      return false;
    }
    descent.leaf = foreseen(first_leaf + leaf.set, *last);
    descent.splits += below.splits() + leaf.splits();
    return true;
  }
}

}  // namespace
}  // namespace organ_collision::core
