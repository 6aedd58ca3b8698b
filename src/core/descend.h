#pragma once

#include "core/bounds.h"
#include "core/descent.h"
#include "core/lane_vector.h"

// The paper's search, for whichever vector unit includes it: all splits of a wide node, and of a
// packet, at a time.
namespace organ_collision::core {
namespace {

/// What the rounding of two poles makes of the difference of their squared distances from a tip, as
/// a part of both their offsets from it; see greedy_search.cpp.
constexpr float kOffsetRounding = 0x1p-20F;

constexpr std::uint64_t kEachByte = 0x0101010101010101U;

/// The first byte that is 0. REQUIRES: one is.
inline std::uint32_t firstZero(std::uint64_t bytes) {
  const std::uint64_t zeros = (bytes - kEachByte) & ~bytes & (kEachByte << 7U);
  return static_cast<std::uint32_t>(__builtin_ctzll(zeros)) / 8;
}

/// Which way splits lead, by bits, and whether that is sure.
struct Signs {
  std::uint32_t firsts, sure;
};

/// Where they lead to.
struct Choice {
  std::uint32_t set;     ///< a lane
  std::uint32_t splits;  ///< on the way
  bool sure;             ///< about all of them
};

/// The set to which splits lead, from a lane on.
inline Choice chosenSet(const SplitPaths& paths, std::uint32_t first, const Signs& signs) {
  const std::uint64_t wrong = (signs.firsts * kEachByte & paths.above) ^ paths.firsts;
  const std::uint32_t set = first + firstZero(wrong >> (8 * first));
  const std::uint32_t above = paths.above >> (8 * set) & 0xFFU;
  return {set, static_cast<std::uint32_t>(__builtin_popcount(above)), (above & ~signs.sure) == 0};
}

/// The differences of the squared distances from the poles, as the planes between them tell.
inline Signs signsOf(const Descent& descent, const NodeSplits& node) {
  const Vector<float> tip = vectorOf<float>(descent.tip);
  const LaneVector<float> apart = load<float>(node.apart);
  const LaneVector<float> twice = everywhere(tip + tip);
  const Lanes<float> sides = (twice.x * apart.x + twice.y * apart.y) +
                             (twice.z * apart.z - Lanes<float>::load(node.middle.data()));
  const float of_offset =
      kOffsetRounding * 2 * (reachOf(relative(tip, node.origin)) + node.radius) + descent.least;
  const Lanes<float> rounding =
      Lanes<float>::all(descent.of_apart) * reachOf(apart) + Lanes<float>::all(of_offset);
  return {signsOf(sides), (rounding <= magnitudeOf(sides)).bits()};
}

/// From the squares.
inline Signs signsOf(const Descent& descent, const PacketSplits& packet) {
  const auto& [x, y, z] = packet.centroids;
  const LaneVector<float> centroids = {Lanes<float>::copy(x.data()), Lanes<float>::copy(y.data()),
                                       Lanes<float>::copy(z.data())};
  const LaneVector<float> offset = centroids - everywhere(vectorOf<float>(descent.tip));
  const Lanes<float> squares = dot(offset, offset);
  const Lanes<float> one = permuted(squares, packet.poles[0]);
  const Lanes<float> other = permuted(squares, packet.poles[1]);
  const Lanes<float> sides = one - other;
  const Lanes<float> rounding = Lanes<float>::all(descent.of_squares) * (one + other) +
                                Lanes<float>::all(4 * descent.least * descent.least);
  return {signsOf(sides), (rounding <= sides * sides).bits()};
}

/// From descent.node to a leaf; false, at some node, where rounding could decide wrongly.
inline bool descend(Descent& descent) {
  for (;;) {
    const NodeSplits& node = descent.nodes[descent.node];
    const Signs signs = signsOf(descent, node);
    descent.firsts = signs.firsts;
    descent.sure = signs.sure;
    const Choice below = chosenSet(node.paths, 0, signs);
    if (!below.sure) return false;
    const std::uint32_t set = node.sets[below.set];
    if ((set & kPacketBit) == 0) {
      descent.node = set;
      descent.splits += below.splits;
      continue;
    }
    const std::uint32_t number = (set & ~kPacketBit) / kLaneCount;
    const std::uint32_t first_leaf = descent.triangles[number].first_leaf;
    __builtin_prefetch(descent.leaf_corners + first_leaf);  // what comes next waits for them
    const PacketSplits& packet = descent.packets[number];
    const Choice leaf = chosenSet(packet.paths, set % kLaneCount, signsOf(descent, packet));
    descent.leaf = first_leaf + leaf.set;
    descent.splits += leaf.sure ? below.splits + leaf.splits : 0;
    return leaf.sure;
  }
}

/// Eight centroids that are anywhere, by their slots.
inline LaneVector<float> centroidsIn(const PacketSplits* packets,
                                     const std::array<std::uint32_t, kLaneCount>& slots) {
  alignas(kVectorBytes) LanePoints rows;
  for (std::uint32_t i = 0; i < kLaneCount; ++i) {
    const LanePoints& centroids = packets[slots[i] / kLaneCount].centroids;
    for (std::uint32_t axis = 0; axis < 3; ++axis)
      rows[axis][i] = centroids[axis][slots[i] % kLaneCount];
  }
  return load<float>(rows);
}

/// Takes over where the poles of `count` nodes' splits are.
inline void placeSplits(const PacketSplits* packets, const Poles* poles, std::size_t count,
                        NodeSplits* nodes) {
  for (std::size_t i = 0; i < count; ++i) {
    const LaneVector<float> first = centroidsIn(packets, poles[i][0]);
    const LaneVector<float> second = centroidsIn(packets, poles[i][1]);
    const Vector<float> origin = laneOf(first, 0);
    const LaneVector<float> apart = second - first;
    store(apart, nodes[i].apart);
    dot(apart, first + second).store(nodes[i].middle.data());
    nodes[i].origin = {origin.x, origin.y, origin.z};
    nodes[i].radius =
        mostOf(larger(reachOf(first - everywhere(origin)), reachOf(second - everywhere(origin))));
  }
}

}  // namespace
}  // namespace organ_collision::core
