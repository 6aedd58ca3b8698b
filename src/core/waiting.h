#pragma once

#include "core/bounds.h"
#include "core/search.h"

// Sets that wait to be looked at.
namespace organ_collision::core {
namespace {

constexpr std::uint32_t kNoSet = ~0U;  // seems to be a packet

using Keys __attribute__((vector_size(kLanes * sizeof(std::int32_t)))) = std::int32_t;

constexpr Keys kLaneNumbers = {0, 1, 2, 3, 4, 5, 6, 7};
constexpr std::int32_t kLaneBits = 7;
constexpr std::uint32_t kNoKey = ~0U;

/// The lanes' bounds in an order that integers keep, with the lanes' numbers in the last bits.
/// REQUIRES: none is negative.
inline Keys keysOf(const Lanes<float>& squares) {
  Keys keys;
  __builtin_memcpy(&keys, squares.part, sizeof(keys));
  return (keys & ~kLaneBits) | kLaneNumbers;
}
inline Keys keysOf(const Lanes<double>& squares) {
  Lanes<float> rounded;
  float values[kLanes];
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) values[lane] = inFloat(squares[lane]);
  __builtin_memcpy(rounded.part, values, sizeof(values));
  return keysOf(rounded);
}

/// Lanes as truths of the width of keys.
inline Keys chosenBy(const Truth<float>& truth) {
  Keys keys;
  __builtin_memcpy(&keys, truth.part, sizeof(keys));
  return keys;
}
inline Keys chosenBy(const Truth<double>& truth) {
  const Keys bits = {1, 2, 4, 8, 16, 32, 64, 128};
  return (bits & static_cast<std::int32_t>(truth.bits())) != 0;
}

/// The least, taken for a number without sign.
inline std::uint32_t leastOf(const Keys& keys) {
  using Unsigned __attribute__((vector_size(sizeof(Keys)))) = std::uint32_t;
  auto least = reinterpret_cast<Unsigned>(keys);
  const auto fold = [&least](const Unsigned& others) { least = least < others ? least : others; };
  fold(__builtin_shufflevector(least, least, 4, 5, 6, 7, 0, 1, 2, 3));
  fold(__builtin_shufflevector(least, least, 2, 3, 0, 1, 6, 7, 4, 5));
  fold(__builtin_shufflevector(least, least, 1, 0, 3, 2, 5, 4, 7, 6));
  return least[0];
}

/// The bound in a key, a trifle less than it was; not a number where there is none.
inline float boundIn(std::uint32_t key) {
  const std::uint32_t bits = key & ~static_cast<std::uint32_t>(kLaneBits);
  float bound = 0.0F;
  __builtin_memcpy(&bound, &bits, sizeof(bound));
  return bound;
}

/// The keys without one of them.
inline Keys without(std::uint32_t key, const Keys& keys) {
  return keys == static_cast<std::int32_t>(key) ? -1 - Keys{} : keys;
}

/// The set in a lane of a node, without a branch on whether it is a packet.
inline std::uint32_t setIn(const WideNode& node, std::uint32_t lane) {
  const std::uint32_t is_packet = 0U - static_cast<std::uint32_t>(lane >= node.node_count);
  return lane + ((node.first_node & ~is_packet) |
                 ((node.first_packet - node.node_count + kPacketBit) & is_packet));
}

/// Node by node, the last on top; of a node the nearest comes first. It is found before it is asked
/// for, as whoever asks waits for it.
class Stack {
 public:
  explicit Stack(WaitingLanes* room) : end_(room), room_(room) {}

  /// The lanes of a node that have keys.
  void push(const WideNode& node, const Keys& keys) {
    end_->node = &node;
    end_ += prepare(*end_, keys) ? 1 : 0;
  }

  /// The nearest of the topmost node, if its bound, squared, is at most `square`. Nodes without are
  /// dropped; of their bounds, squared, the least joins `dropped`.
  template <class Real>
  std::uint32_t take(Real square, Lanes<Real>& dropped) {
    for (; end_ != room_; --end_) {
      WaitingLanes& top = end_[-1];
      const Real bound = boundIn(top.next_key);
      if (bound <= square) {
        const std::uint32_t set = top.next_set;
        Keys keys;
        __builtin_memcpy(&keys, &top.keys, sizeof(keys));
        end_ -= prepare(top, keys) ? 0 : 1;
        return set;
      }
      dropped = smaller(Lanes<Real>::all(bound), dropped);
    }
    return kNoSet;
  }

 private:
  /// Takes the nearest from the keys, for next time; false if there is none.
  static bool prepare(WaitingLanes& lanes, const Keys& keys) {
    const std::uint32_t nearest = leastOf(keys);
    const Keys others = without(nearest, keys);
    __builtin_memcpy(&lanes.keys, &others, sizeof(others));
    lanes.next_key = nearest;
    lanes.next_set = setIn(*lanes.node, nearest & kLaneBits);
    return nearest != kNoKey;
  }

  WaitingLanes* end_;
  WaitingLanes* room_;
};

/// Brings a set closer that may be opened soon.
[[gnu::always_inline]] inline void fetch(const Search& search, std::uint32_t set) {
  const bool is_packet = (set & kPacketBit) != 0;
  const char* item = is_packet ? reinterpret_cast<const char*>(search.packets + (set & ~kPacketBit))
                               : reinterpret_cast<const char*>(search.nodes + set);
  constexpr std::size_t kLine = 64;
  static_assert(sizeof(WideNode) <= sizeof(TrianglePacket));
  for (std::size_t i = 0; i < sizeof(TrianglePacket); i += kLine) __builtin_prefetch(item + i);
}

}  // namespace
}  // namespace organ_collision::core
