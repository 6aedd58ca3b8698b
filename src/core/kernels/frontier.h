#pragma once

#include "core/kernels/bounds.h"
#include "core/kernels/search.h"

// Sets that wait to be looked at.
namespace organ_collision::core {
namespace {

constexpr LaneInts kLaneNumbers = {0, 1, 2, 3, 4, 5, 6, 7};
constexpr std::int32_t kLaneBits = 7;

/// Lower bounds in single precision.
inline Lanes<float> inFloats(const Lanes<float>& bounds) { return bounds; }
inline Lanes<float> inFloats(const Lanes<double>& bounds) {
  float values[kLanes];
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) values[lane] = inFloat(bounds[lane]);
  return Lanes<float>::copy(values);
}

/// The lane of the least of the first `count` numbers. Those that differ by less than a millionth
/// may tie. REQUIRES: none is negative.
inline std::uint32_t laneOfLeast(const Lanes<float>& numbers, std::uint32_t count) {
  using Unsigned __attribute__((vector_size(sizeof(LaneInts)))) = std::uint32_t;
  LaneInts keys;  // in an order that integers keep, with the lanes' numbers in the last bits
  __builtin_memcpy(&keys, numbers.part, sizeof(keys));
  keys = (keys & ~kLaneBits) | kLaneNumbers;
  keys = kLaneNumbers < static_cast<std::int32_t>(count) ? keys : -1 - LaneInts{};
  auto least = reinterpret_cast<Unsigned>(keys);
  const auto fold = [&least](const Unsigned& others) { least = least < others ? least : others; };
  fold(__builtin_shufflevector(least, least, 4, 5, 6, 7, 0, 1, 2, 3));
  fold(__builtin_shufflevector(least, least, 2, 3, 0, 1, 6, 7, 4, 5));
  fold(__builtin_shufflevector(least, least, 1, 0, 3, 2, 5, 4, 7, 6));
  return least[0] & kLaneBits;
}

/// Which lanes some bits choose: their numbers, three bits each, the first in the lowest bits;
/// above them, from bit 24 on, how many there are.
constexpr std::array<std::uint32_t, 256> chosenLanes() {
  std::array<std::uint32_t, 256> chosen = {};
  for (std::uint32_t bits = 0; bits < chosen.size(); ++bits) {
    std::uint32_t count = 0;
    for (std::uint32_t lane = 0; lane < kLaneCount; ++lane)
      if ((bits >> lane & 1U) != 0) chosen[bits] |= lane << (3 * count++);
    chosen[bits] |= count << 24U;
  }
  return chosen;
}
alignas(64) constexpr std::array<std::uint32_t, 256> kChosenLanes = chosenLanes();

/// How many lanes some bits choose. Where bits can be counted, nothing has to be looked up, for
/// which all that comes next would wait.
inline std::uint32_t countOf(std::uint32_t lanes) {
#if defined(__POPCNT__)
  return static_cast<std::uint32_t>(__builtin_popcount(lanes));
#else
  return kChosenLanes[lanes] >> 24U;
#endif
}

/// Writes `first` plus the number of each lane that some bits choose, and returns how many those
/// are; writes to room for as many as there are lanes.
inline std::uint32_t writeNumbers(std::uint32_t lanes, std::uint32_t first,
                                  std::uint32_t* numbers) {
  using Unsigned __attribute__((vector_size(sizeof(LaneInts)))) = std::uint32_t;
  const Unsigned chosen =
      (Unsigned{} + kChosenLanes[lanes]) >> Unsigned{0, 3, 6, 9, 12, 15, 18, 21};
  const Unsigned written = (chosen & static_cast<std::uint32_t>(kLaneBits)) + first;
  __builtin_memcpy(numbers, &written, sizeof(written));
  return countOf(lanes);
}

/// The set in a lane of a node, without a branch on whether it is a packet.
inline std::uint32_t setIn(const WideNode& node, std::uint32_t lane) {
  const std::uint32_t is_packet = 0U - static_cast<std::uint32_t>(lane >= node.node_count);
  return lane + ((node.first_node & ~is_packet) |
                 ((node.first_packet - node.node_count + kPacketBit) & is_packet));
}

/// The lane of a node in which a set is.
inline std::uint32_t laneOf(const WideNode& node, std::uint32_t set) {
  return (set & kPacketBit) == 0 ? set - node.first_node
                                 : (set & ~kPacketBit) - node.first_packet + node.node_count;
}

/// Nodes and packets, in the order in which they were added, while none is taken. What is added is
/// written without a branch, as none could be foreseen.
class Frontier {
 public:
  explicit Frontier(const FrontierRoom& room) : room_(room) {}

  void addNode(std::uint32_t node) { room_.nodes[node_count_++] = node; }

  /// These lanes of a node, by bits.
  [[gnu::always_inline]] void add(const WideNode& node, std::uint32_t lanes,
                                  const Lanes<float>& squares) {
    const std::uint32_t of_nodes = (1U << node.node_count) - 1;
    node_count_ += writeNumbers(lanes & of_nodes, node.first_node, room_.nodes + node_count_);
    const std::uint32_t packets = lanes & ~of_nodes;
    permuted(squares, kChosenLanes[packets]).store(room_.squares + packet_count_);
    packet_count_ +=
        writeNumbers(packets, node.first_packet - node.node_count, room_.packets + packet_count_);
  }

  std::uint32_t nodeCount() const { return node_count_; }
  std::uint32_t node(std::uint32_t i) const { return room_.nodes[i]; }
  void dropNodes() { node_count_ = 0; }

  std::uint32_t packetCount() const { return packet_count_; }
  std::uint32_t packet(std::uint32_t i) const { return room_.packets[i]; }
  void dropPackets() { packet_count_ = 0; }

  /// REQUIRES: a packet waits.
  std::uint32_t takeNearestPacket() {
    std::uint32_t nearest = 0;
    float least = room_.squares[0];
    for (std::uint32_t i = 1; i < packet_count_; ++i) {
      const bool is_nearer = room_.squares[i] < least;
      least = is_nearer ? room_.squares[i] : least;
      nearest = is_nearer ? i : nearest;
    }
    const std::uint32_t packet = room_.packets[nearest];
    --packet_count_;
    room_.packets[nearest] = room_.packets[packet_count_];
    room_.squares[nearest] = room_.squares[packet_count_];
    return packet;
  }

  /// Drops packets whose bound, squared, is above `square`; returns the least of those, if any.
  float dropPacketsBeyond(float square) {
    float least = kFloatInfinity;
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < packet_count_; ++i) {
      const float bound = room_.squares[i];
      const bool is_kept = bound <= square;
      room_.packets[kept] = room_.packets[i];
      room_.squares[kept] = bound;
      kept += is_kept ? 1 : 0;
      least = is_kept || least < bound ? least : bound;
    }
    packet_count_ = kept;
    return least;
  }

 private:
  FrontierRoom room_;
  std::uint32_t node_count_ = 0, packet_count_ = 0;
};

}  // namespace
}  // namespace organ_collision::core
