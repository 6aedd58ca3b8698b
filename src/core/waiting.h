#pragma once

#include "core/search.h"

// Sets that wait, packed and unpacked.
namespace organ_collision::core {
namespace {

constexpr std::uint32_t kPacketBit = 0x80000000U;
constexpr Waiting kNoSet = ~Waiting{0};

inline Waiting waiting(float square, std::uint32_t set) {
  std::uint32_t bits = 0;
  __builtin_memcpy(&bits, &square, sizeof(bits));
  return static_cast<Waiting>(bits) << 32U | set;
}
inline float squareOf(Waiting waiting) {
  const auto bits = static_cast<std::uint32_t>(waiting >> 32U);
  float square = 0;
  __builtin_memcpy(&square, &bits, sizeof(square));
  return square;
}
inline std::uint32_t setOf(Waiting waiting) { return static_cast<std::uint32_t>(waiting); }

/// The set in a lane of a node, without a branch on whether it is a packet.
inline std::uint32_t setIn(const WideNode& node, std::uint32_t lane) {
  const std::uint32_t is_packet = 0U - static_cast<std::uint32_t>(lane >= node.node_count);
  return lane + ((node.first_node & ~is_packet) |
                 ((node.first_packet - node.node_count + kPacketBit) & is_packet));
}

/// Brings a set closer that will be needed.
inline void fetch(const Search& search, std::uint32_t set) {
  const bool is_packet = (set & kPacketBit) != 0;
  const char* item = is_packet ? reinterpret_cast<const char*>(search.packets + (set & ~kPacketBit))
                               : reinterpret_cast<const char*>(search.nodes + set);
  for (std::size_t i = 0; i < sizeof(WideNode); i += 64) __builtin_prefetch(item + i);
}

}  // namespace
}  // namespace organ_collision::core
