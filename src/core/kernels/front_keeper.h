#pragma once

#include "core/kernels/bounds.h"
#include "core/kernels/search.h"
#include "core/kernels/walking_tip.h"

// Bounds that are kept from query to query.
//
// A plane that keeps the tip from a convex body, at a distance b along a direction of unit length,
// keeps it at b + direction . m when the tip has moved by m; a tip of several corners by the least
// that one of them says. Whatever the direction, that is a lower bound.
//
// Rounding, as parts of u: the shift of a corner is off by 1 of its length, its product with a
// direction by 7, the direction's length by 16, the sums with bound and drift by 1 of each; now,
// and when the bound was taken.
namespace organ_collision::core {
namespace {

/// Of a tip of so many corners.
template <std::uint32_t kCorners>
class FrontKeeper {
 public:
  /// With the shift and drift that the front has now.
  void start(Front& front) {
    front_ = &front;
    drift_ = static_cast<float>(front.drift);
    moved_ = drift_;
    for (std::uint32_t i = 0; i < kCorners; ++i) {
      const Vector<float> shift = vectorOf<float>(front.shift[i]);
      shifts_[i] = everywhere(shift);
      moved_ += reachOf(shift);
    }
  }

  /// Bounds of what is within reach are not more.
  Lanes<float> allowed(float reach) const {
    return Lanes<float>::all(reach + drift_ + kRounding * (reach + moved_));
  }
  Lanes<float> boundsOf(const KeptSets& kept) const {
    const LaneVector<float> direction = load<float>(kept.direction);
    Lanes<float> along = dot(direction, shifts_[0]);
    for (std::uint32_t i = 1; i < kCorners; ++i) along = smaller(along, dot(direction, shifts_[i]));
    return Lanes<float>::load(kept.bound.data()) + along;
  }

  /// Chains the kept sets of which some are within reach, and returns the first. Without a branch,
  /// as none could be foreseen; from the last to the first, and each set's link in the set itself,
  /// as processors tell addresses apart by some of their bits: a load that seems to be of what was
  /// stored just before waits for it.
  std::uint32_t chainWithin(const Lanes<float>& allowed) {
    std::uint32_t first = KeptSets::kNone;
    for (std::uint32_t i = front_->count; i-- != 0;) {
      KeptSets& kept = front_->kept[i];
      kept.within = (boundsOf(kept) <= allowed).bits();
      kept.next = first;
      first = kept.within != 0 ? i : first;
    }
    return first;
  }

  /// Room for what is in a set that is opened; null, and no front any more, where there is none.
  KeptSets* roomFor(std::uint32_t set) {
    if (front_->count == Front::kMost) {
      front_->count = 0;
      is_lost_ = true;
    }
    if (is_lost_) return nullptr;
    KeptSets& kept = front_->kept[front_->count++];
    kept.opened = set;
    return &kept;
  }

  /// Of these sets of a node, by lanes.
  void keepBoxes(const WideNode& node, const WalkingTip<float, kCorners>& tip,
                 const Truth<float>& lanes, KeptSets& kept) const {
    const auto seen = tip.boxesSeenIn(node);
    const Lanes<float> rounding = Lanes<float>::all(tip.boxRounding());
    LaneVector<float> away = tip.gapsOf(seen);
    Lanes<float> distances = root(dot(away, away));
    if constexpr (kCorners == 2) {
      const SeparatingAxes<float> axes = tip.separatingAxesOf(seen, node);
      const Truth<float> is_better = distances <= axes.gap - rounding;
      away = select(is_better, LaneVector<float>{} - axes.axis, away);
      distances = select(is_better, axes.gap - rounding, distances);
    }
    const Lanes<float> squares = dot(away, away);
    const Lanes<float> inverse = select(Lanes<float>::all(kShortestSquare) <= squares,
                                        Lanes<float>::all(1) / root(squares), Lanes<float>{});
    keep(inverse * turnedBack(node, away), distances - rounding, lanes, kept);
  }

  /// Of these triangles of a packet, by lanes. Where no plane keeps them apart, nothing is known.
  /// `rounding` is that of the packet's range, of which planes of a point take twice as much.
  void keepTriangles(const Planes<float>& planes, float rounding, const Truth<float>& lanes,
                     KeptSets& kept) const {
    const float rounding_of_planes = kCorners == 1 ? 2 * rounding : rounding;
    keep(select(planes.gap <= Lanes<float>{}, LaneVector<float>{}, planes.direction),
         planes.gap - Lanes<float>::all(rounding_of_planes), lanes, kept);
  }

 private:
  static constexpr float kRounding = 32 * kRoundoff<float>;

  /// Infinite bounds of other lanes.
  void keep(const LaneVector<float>& directions, const Lanes<float>& bounds,
            const Truth<float>& lanes, KeptSets& kept) const {
    Lanes<float> along = dot(directions, shifts_[0]);
    for (std::uint32_t i = 1; i < kCorners; ++i) along = larger(along, dot(directions, shifts_[i]));
    const Lanes<float> rounding =
        Lanes<float>::all(kRounding) * (magnitudeOf(bounds) + Lanes<float>::all(moved_));
    store(directions, kept.direction);
    select(lanes, bounds - along + Lanes<float>::all(drift_) - rounding, infinite<float>())
        .store(kept.bound.data());
  }

  Front* front_ = nullptr;
  bool is_lost_ = false;
  LaneVector<float> shifts_[kCorners];
  float drift_;
  float moved_;  // tip and mesh, at most
};

}  // namespace
}  // namespace organ_collision::core
