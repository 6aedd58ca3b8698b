#pragma once

#include "core/kernels/frontier.h"
#include "core/kernels/packet_range.h"

// Triangles that a walk may have to measure.
namespace organ_collision::core {
namespace {

/// A whole number in each lane, as wide as a Real, that is only kept.
template <class Real>
struct LaneLabels {
  using Labels = typename Part<Real>::Truths;
  Labels part[Truth<Real>::kParts];

  void put(const Truth<Real>& lanes, std::uint32_t label) {
    for (int i = 0; i < Truth<Real>::kParts; ++i)
      part[i] = lanes.part[i] ? Labels{} + static_cast<std::int32_t>(label) : part[i];
  }
  std::uint32_t operator[](std::uint32_t lane) const {
    constexpr int kPartLanes = Lanes<Real>::kPartLanes;
    return static_cast<std::uint32_t>(part[lane / kPartLanes][lane % kPartLanes]);
  }
};

/// Of the packets looked at, the triangles that may be nearest. What is nearest of all is decided
/// once for many packets, as each decision waits for all that leads to it. `kExact`: how near the
/// others are at least is not asked.
template <class Real, bool kExact>
class Candidates {
 public:
  static constexpr std::uint32_t kMost = 32;  ///< packets
  /// Room for their leaves, and for what takeWithin() writes besides.
  using Leaves = std::uint32_t[(kMost + 1) * std::size_t{kLaneCount}];

  struct Packet {
    Lanes<Real> squares;  ///< of the bounds, but for rounding; infinite where there is no candidate
    std::uint32_t first_leaf;
  };
  /// A list, apart from all else, which then is kept in registers.
  using Room = Packet[kMost];

  explicit Candidates(Room& room) : packets_(room) {}

  std::uint32_t packetCount() const { return count_; }

  /// These lanes of a packet that starts with that leaf. REQUIRES: fewer than kMost are there.
  void add(const Truth<Real>& lanes, const SquaredRange<Real>& range, Real rounding,
           std::uint32_t first_leaf) {
    rounding_ = rounding > rounding_ ? rounding : rounding_;
    const Truth<Real> nearer = lanes & !(not_farther_ <= range.high);
    not_farther_ = select(nearer, range.high, not_farther_);
    nearest_.put(nearer, first_leaf);
    const Lanes<Real> squares = select(lanes, range.low, infinite<Real>());
    if constexpr (kExact) {
      second_ = smaller(second_, larger(least_, squares));
      least_ = smaller(least_, squares);
    }
    packets_[count_++] = {squares, first_leaf};
  }

  /// Lanes that are not to be added.
  void leaveOut(const Truth<Real>& lanes, const Lanes<Real>& squares) {
    left_out_ = leastOfThose(lanes, squares, left_out_);
  }

  /// Of those added since some were dropped or taken, the nearest is not farther.
  Real notFarther() const {
    return (rootOf(leastOf(not_farther_)) + rounding_) * (1 + 4 * kRoundoff<Real>);
  }
  /// The square of that and `more`, or a little above: no root is waited for.
  Real squareOfNotFarther(Real more) const {
    constexpr Real kPart{0x1p-12};  // (a + b)^2 <= (1 + x) * a^2 + (1 + 1 / x) * b^2
    const Real rounding = rounding_ + more;
    return (1 + 2 * kPart) * leastOf(not_farther_) + 2 / kPart * rounding * rounding;
  }
  /// The one that this is owed to. REQUIRES: there is one.
  std::uint32_t nearestLeaf() const {
    const Truth<Real> is_nearest = not_farther_ <= Lanes<Real>::all(leastOf(not_farther_));
    const std::uint32_t lane = lowestBit(is_nearest.bits());
    const LaneLabels<Real> first_leaves = nearest_;  // what is asked by number is in memory
    return first_leaves[lane] + lane;
  }

  /// Drops all and is true if at most one is not farther, which then needs no list. May be false
  /// though that is so, where dropBeyond() has left others out. Of exact searches only.
  bool takeOnlyWithin(Real reach) {
    static_assert(kExact);
    const Lanes<Real> limit = Lanes<Real>::all(squareOf(reach + rounding_));
    const std::uint32_t lanes = (least_ <= limit).bits();
    if ((lanes & (lanes - 1)) != 0 || (second_ <= limit).bits() != 0) return false;
    restart(0);
    return true;
  }

  /// Leaves out those that are farther.
  void dropBeyond(Real reach) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      const auto [squares, first_leaf] = packets_[i];
      const Truth<Real> matter = within(reach, squares);
      packets_[kept] = {select(matter, squares, infinite<Real>()), first_leaf};
      kept += matter.bits() != 0 ? 1 : 0;
    }
    restart(kept);
  }

  /// Lists the others and drops all; returns how many.
  std::uint32_t takeWithin(Real reach, Leaves& leaves) {
    std::uint32_t taken = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      const std::uint32_t lanes = within(reach, packets_[i].squares).bits();
      taken += writeNumbers(lanes, packets_[i].first_leaf, leaves + taken);
    }
    restart(0);
    return taken;
  }

  /// Bounds from their squares.
  Lanes<Real> boundsOf(const Lanes<Real>& squares) const {
    return root(squares) - Lanes<Real>::all(rounding_);
  }
  /// The least bound of what was left out.
  Real leftOut() const { return leastOf(boundsOf(left_out_)); }

 private:
  Truth<Real> within(Real reach, const Lanes<Real>& squares) {
    const Truth<Real> within = squares <= Lanes<Real>::all(squareOf(reach + rounding_));
    if constexpr (!kExact) leaveOut(!within, squares);
    return within;
  }

  void restart(std::uint32_t count) {
    count_ = count;
    not_farther_ = infinite<Real>();
    if (count == 0) least_ = second_ = infinite<Real>();
  }

  Packet* packets_;
  std::uint32_t count_ = 0;
  Real rounding_ = 0;                           // of all distances so far, at most
  Lanes<Real> not_farther_ = infinite<Real>();  // in each lane the nearest, squared
  LaneLabels<Real> nearest_ = {};               // its packet's first leaf
  Lanes<Real> least_ = infinite<Real>();        // in each lane the least bound, squared,
  Lanes<Real> second_ = infinite<Real>();       // and the next
  Lanes<Real> left_out_ = infinite<Real>();     // in each lane the nearest of those, squared
};

}  // namespace
}  // namespace organ_collision::core
