#pragma once

#include "core/bounds.h"
#include "core/search.h"

// Sets that wait to be looked at, the nearest of a node on top.
namespace organ_collision::core {
namespace {

constexpr std::uint32_t kPacketBit = 0x80000000U;
constexpr std::uint32_t kNoSet = ~0U;  // seems to be a packet

using Keys __attribute__((vector_size(kLanes * sizeof(std::int32_t)))) = std::int32_t;
using Sets __attribute__((vector_size(kLanes * sizeof(std::uint32_t)))) = std::uint32_t;

constexpr Keys kLaneNumbers = {0, 1, 2, 3, 4, 5, 6, 7};
constexpr std::int32_t kLaneBits = 7;

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

/// Bits of a bound that is a trifle less than the key's was.
inline Keys boundsOf(const Keys& keys) { return keys & ~kLaneBits; }

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

#if defined(__clang__)
#define ORGAN_COLLISION_SHUFFLE(keys, ...) __builtin_shufflevector(keys, keys, __VA_ARGS__)
#else
#define ORGAN_COLLISION_SHUFFLE(keys, ...) __builtin_shuffle(keys, Keys{__VA_ARGS__})
#endif

/// The least, taken for a number without sign.
inline std::uint32_t leastOf(const Keys& keys) {
  Sets least = reinterpret_cast<Sets>(keys);
  const auto fold = [&least](const Keys& others) {
    const Sets other = reinterpret_cast<Sets>(others);
    least = least < other ? least : other;
  };
  fold(ORGAN_COLLISION_SHUFFLE(keys, 4, 5, 6, 7, 0, 1, 2, 3));
  fold(ORGAN_COLLISION_SHUFFLE(reinterpret_cast<Keys>(least), 2, 3, 0, 1, 6, 7, 4, 5));
  fold(ORGAN_COLLISION_SHUFFLE(reinterpret_cast<Keys>(least), 1, 0, 3, 2, 5, 4, 7, 6));
  return least[0];
}

/// Compares each lane with another one, which keeps the larger in front.
template <int... kOther>
inline Keys exchange(const Keys& keys) {
  constexpr Keys kOthers = {kOther...};
  const Keys others = ORGAN_COLLISION_SHUFFLE(keys, kOther...);
  const Keys larger = keys > others ? keys : others;
  const Keys smaller = keys > others ? others : keys;
  return kOthers > kLaneNumbers ? larger : smaller;
}

/// The largest first. Source: K. Batcher, "Sorting networks and their applications" (1968).
inline Keys sorted(Keys keys) {
  keys = exchange<1, 0, 3, 2, 5, 4, 7, 6>(keys);
  keys = exchange<2, 3, 0, 1, 6, 7, 4, 5>(keys);
  keys = exchange<0, 2, 1, 3, 4, 6, 5, 7>(keys);
  keys = exchange<4, 5, 6, 7, 0, 1, 2, 3>(keys);
  keys = exchange<0, 1, 4, 5, 2, 3, 6, 7>(keys);
  return exchange<0, 2, 1, 4, 3, 6, 5, 7>(keys);
}

/// The sets in lanes of a node.
inline Sets setsOf(const WideNode& node, const Keys& lanes) {
  const Keys is_packet = lanes >= static_cast<std::int32_t>(node.node_count);
  const Sets nodes = node.first_node - Sets{};
  const Sets packets = node.first_packet - node.node_count + kPacketBit - Sets{};
  return (is_packet ? packets : nodes) + reinterpret_cast<Sets>(lanes);
}

/// At its bottom is kNoSet, nearer than anything, and below that nothing that is taken.
class Stack {
 public:
  explicit Stack(const WaitingSets& room) : squares_(room.squares), sets_(room.sets) {
    for (int i = 0; i < kLanes; ++i) squares_[i] = -kFloatInfinity;
    sets_[kLanes - 1] = kNoSet;
  }

  /// The one on top.
  std::uint32_t set() const { return sets_[count_ - 1]; }
  void pop() { --count_; }

  /// Takes the topmost whose bound, squared, is at most `square`. Those above are dropped; of their
  /// bounds, squared, the least joins `dropped`.
  template <class Real>
  std::uint32_t take(Real square, Lanes<Real>& dropped) {
    for (;; count_ -= kLanes) {
      alignas(kVectorBytes) float top[kLanes];
      __builtin_memcpy(top, squares_ + count_ - kLanes, sizeof(top));
      const Lanes<Real> squares = Lanes<Real>::load(top);
      const std::uint32_t within = (squares <= Lanes<Real>::all(square)).bits();
      if (within == 0) {
        dropped = smaller(dropped, squares);
        continue;
      }
      const std::uint32_t lane = highestBit(within);
      const Truth<Real> kept = Lanes<Real>::numbers() <= Lanes<Real>::all(static_cast<Real>(lane));
      dropped = leastOfThose(!kept, squares, dropped);
      count_ = count_ - kLanes + lane;
      return sets_[count_];
    }
  }

  /// The sets in a node's lanes, the nearest on top; those with keys below 0 are left out.
  void push(const WideNode& node, const Keys& keys, std::uint32_t count) {
    const Keys order = sorted(keys);
    const Keys squares = boundsOf(order);
    const Sets sets = setsOf(node, order & kLaneBits);
    __builtin_memcpy(squares_ + count_, &squares, sizeof(squares));
    __builtin_memcpy(sets_ + count_, &sets, sizeof(sets));
    count_ += count;
  }

 private:
  float* squares_;
  std::uint32_t* sets_;
  std::uint32_t count_ = kLanes;
};

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
