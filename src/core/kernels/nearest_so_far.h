#pragma once

#include "core/kernels/bounds.h"
#include "core/kernels/candidates.h"
#include "core/kernels/search.h"
#include "core/kernels/walking_tip.h"

// What a walk has found so far.
namespace organ_collision::core {
namespace {

/// How near a triangle is to a tip of one, two or three corners, and which triangles may be nearer.
/// `kExact`: of a search that is exact; what that leaves out needs no bound, as it is not nearer.
template <class Real, std::uint32_t kCorners, bool kExact>
class NearestSoFar {
 public:
  using Room = typename Candidates<Real, kExact>::Room;

  NearestSoFar(Search& search, Room& room)
      : search_(search),
        tip_(search),
        share_(kExact || search.share == 1.0 ? 1 : static_cast<Real>(search.share * (1 + 0x1p-22))),
        allowance_(kExact ? 0 : Real{inFloat(search.allowance)}),
        candidates_(room) {
    look();
  }

  const WalkingTip<Real, kCorners>& tip() const { return tip_; }

  /// Leaves are few.
  bool isSparing() const { return !kExact && search_.sparing; }
  /// What is farther is left out.
  Real reach() const { return reach_; }
  /// Boxes within this matter.
  Real squaredReach() const {
    return kExact || search_.leaves_left > 0 ? squared_reach_ : Real{-kFloatInfinity};
  }
  /// Some triangle is not farther than this, but for the rounding of boxes.
  void isWithin(Real distance) {
    const Real square = squaredReachOf(distance + tip_.boxRounding());
    squared_reach_ = square < squared_reach_ ? square : squared_reach_;
  }

  /// What was left out because it was farther than the best of its time is farther than the last.
  bool isExact() const {
    return kExact || (search_.share == 1.0 && search_.allowance == 0.0 && search_.leaves_left > 0);
  }

  /// Of triangles that touch the tip the first is named.
  bool isTooLate(const TrianglePacket& packet) const {
    return search_.best == 0.0 && packet.first_leaf > search_.best_leaf;
  }

  /// Looks at the triangles of a packet, which become candidates.
  void scan(const TrianglePacket& packet) {
    Real rounding = 0;
    const SquaredRange<Real> range = tip_.rangeOf(packet, rounding);
    const Truth<Real> used = lanesInUse<Real>(packet);
    Truth<Real> allowed = used;
    if (isSparing()) {
      allowed = chosen(packet, root(range.high) + Lanes<Real>::all(rounding), rounding);
      candidates_.leaveOut(used & !allowed, range.low);
    } else {
      search_.triangles += packet.lane_count;
    }
    consider(allowed, range, rounding, packet);
  }

  /// These triangles of a packet are candidates.
  [[gnu::always_inline]] void consider(const Truth<Real>& lanes, const SquaredRange<Real>& range,
                                       Real rounding, const TrianglePacket& packet) {
    if (candidates_.packetCount() == Candidates<Real, kExact>::kMost) makeRoom();
    candidates_.add(lanes, range, rounding, packet.first_leaf);
    if (!kIsPoint) {
      const Lanes<Real> meeting = Lanes<Real>::all(squareOf(rounding));
      if ((lanes & (range.low <= meeting)).bits() != 0) measureCandidates();
    }
  }

  /// What is nearest of the candidates so far.
  void decide() {
    const Real not_farther = candidates_.notFarther();
    if (!(static_cast<double>(not_farther) < search_.best)) return;
    search_.best = not_farther;
    look(not_farther);
    if constexpr (kExact) squared_reach_ = candidates_.squareOfNotFarther(tip_.boxRounding());
    promised_ = true;
    promised_leaf_ = candidates_.nearestLeaf();
    fetchPromised();
  }

  void measure(std::uint32_t leaf) {
    search_.measure(search_, leaf);
    look();
    promised_ = promised_ && leaf != promised_leaf_;
  }

  void leaveOut(double bound) {
    if (bound < search_.unopened) search_.unopened = bound;
  }

  /// When all has been looked at that matters.
  void finish() {
    measureCandidates();
    if (!isExact()) leaveOut(candidates_.leftOut());
    if (isExact() || search_.unopened >= search_.best) search_.unopened = kInfinity;
  }

 private:
  static constexpr bool kIsPoint = kCorners == 1;

  void look() { look(static_cast<Real>(search_.best)); }
  void look(Real best) {
    reach_ = kExact ? best : allowedReach(best, share_, allowance_);
    squared_reach_ = squaredReachOf(reach_);
  }
  Real squaredReachOf(Real reach) const { return squareOf(reach + tip_.boxRounding()); }

  /// The triangles to look at while there are leaves left: one after the other, the nearest box
  /// first, until no box is nearer than the best. None is farther than its `high`.
  Truth<Real> chosen(const TrianglePacket& packet, const Lanes<Real>& high, Real rounding) {
    Real boxes[kLaneCount];
    (root(tip_.squaresToBoxesOfTriangles(packet)) - Lanes<Real>::all(rounding)).store(boxes);
    search_.bounds += packet.lane_count;
    alignas(kVectorBytes) float is_chosen[kLaneCount] = {};
    Real reach = reach_;
    for (; search_.leaves_left > 0; --search_.leaves_left) {
      std::uint32_t nearest = 0;
      for (std::uint32_t lane = 1; lane < packet.lane_count; ++lane)
        if (boxes[lane] < boxes[nearest]) nearest = lane;
      if (!(boxes[nearest] <= reach) || is_chosen[nearest] == 1.0F) break;
      boxes[nearest] = Real{kFloatInfinity};
      is_chosen[nearest] = 1.0F;
      reach = high[nearest] < reach ? high[nearest] : reach;
      ++search_.triangles;
    }
    return Lanes<Real>::all(1) <= Lanes<Real>::load(is_chosen);
  }

  /// Brings closer what is read when it is measured: of many triangles what names its vertices, as
  /// that is not there yet; else these.
  void fetchPromised() const {
    const Corners& corners = search_.leaf_corners[promised_leaf_];
    if (search_.fetches) return __builtin_prefetch(&corners);
    for (const VertexId vertex : corners) __builtin_prefetch(search_.positions + 3 * index(vertex));
  }

  void makeRoom() {
    decide();
    candidates_.dropBeyond(reachOfCandidates());
    if (candidates_.packetCount() > Candidates<Real, kExact>::kMost / 2) measureCandidates();
  }

  /// Measures exactly what still may be nearest, first what seems to be. Which those are is told
  /// before, so that none waits for the one before it.
  void measureCandidates() {
    if (candidates_.packetCount() == 0) return;
    decide();
    if constexpr (kExact) {  // most often it is alone
      if (promised_ && candidates_.takeOnlyWithin(reach_)) return measure(promised_leaf_);
    }
    typename Candidates<Real, kExact>::Leaves leaves;
    const std::uint32_t count = candidates_.takeWithin(reachOfCandidates(), leaves);
    std::uint32_t first = search_.best_leaf;
    if (promised_) measure(first = promised_leaf_);
    for (std::uint32_t i = 0; i < count; ++i)
      if (leaves[i] != first) measure(leaves[i]);
  }

  /// Of few leaves no errors are allowed besides: more of them never make an answer worse.
  Real reachOfCandidates() const { return isSparing() ? static_cast<Real>(search_.best) : reach_; }

  Search& search_;
  const WalkingTip<Real, kCorners> tip_;
  const Real share_, allowance_;  // the search's, rounded so that nothing more is left out
  Real reach_;
  Real squared_reach_;
  Candidates<Real, kExact> candidates_;
  bool promised_ = false;  // search_.best is owed to a triangle that was not measured
  std::uint32_t promised_leaf_ = 0;
};

}  // namespace
}  // namespace organ_collision::core
