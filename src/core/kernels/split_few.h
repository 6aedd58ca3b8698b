#pragma once

#include "core/kernels/far_points.h"
#include "core/kernels/kernels.h"

// The hierarchy of up to eight points, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

/// Some of a few points, in their order.
struct FewMembers {
  Truth<double> within;
  std::uint32_t bits;
  std::uint32_t split;   ///< that they come of
  std::uint32_t levels;  ///< above them
};

/// A few points and the squared distances between them.
class FewPoints {
 public:
  FewPoints(const PointColumns& points, std::uint32_t count) {
    std::array<std::array<double, kLaneCount>, 3> at;
    for (std::uint32_t i = 0; i < kLaneCount; ++i) {  // the first again, to make eight of them
      const std::uint32_t point = i < count ? i : 0;
      at[0][i] = points.x[point];
      at[1][i] = points.y[point];
      at[2][i] = points.z[point];
    }
    const LaneVector<double> all = eightOf({&at[0][0], &at[1][0], &at[2][0]}, 0);
    for (std::uint32_t i = 0; i < count; ++i) {
      const LaneVector<double> apart =
          all - everywhere(Vector<double>{at[0][i], at[1][i], at[2][i]});
      squared_distances_[i] = dot(apart, apart);
    }
  }

  /// The first of the pairs that are farthest apart; of members that coincide, the first one and
  /// that which begins the second half. Returns who goes with the second.
  Truth<double> split(const FewMembers& members, std::array<std::uint32_t, 2>& poles) const {
    const Lanes<double> none = Lanes<double>::all(-1.0);
    Lanes<double> farthest = none;
    std::uint32_t count = 0;
    for (std::uint32_t bits = members.bits; bits != 0; bits &= bits - 1, ++count)
      farthest = larger(farthest, squared_distances_[lowestBit(bits)]);
    farthest = select(members.within, farthest, none);
    const double most = mostOf(farthest);
    if (most == 0.0) {
      std::uint32_t second_half = members.bits;
      for (std::uint32_t i = 0; i < count / 2; ++i) second_half &= second_half - 1;
      poles = {lowestBit(members.bits), lowestBit(second_half)};
      return Lanes<double>::all(poles[1]) <= Lanes<double>::numbers();
    }
    poles[0] = lowestBit((Lanes<double>::all(most) <= farthest).bits());
    const Lanes<double>& from_first = squared_distances_[poles[0]];
    poles[1] = lowestBit((Lanes<double>::all(most) <= from_first).bits() & members.bits);
    return squared_distances_[poles[1]] <= from_first;
  }

 private:
  Lanes<double> squared_distances_[kLanes];
};

inline void splitFew(const PointColumns& points, std::uint32_t count, FewSplits& few) {
  const FewPoints all(points, count);
  FewMembers pending[kLanes];
  std::uint32_t pending_count = 0, split_count = 0, placed = 0;
  FewMembers members = {
      Lanes<double>::numbers() <= Lanes<double>::all(static_cast<double>(count) - 1.0),
      (1U << count) - 1, 0, 0};
  few.levels = 0;
  while (true) {
    if ((members.bits & (members.bits - 1)) == 0) {
      few.order[placed++] = lowestBit(members.bits);
      if (few.levels < members.levels) few.levels = members.levels;
      if (pending_count == 0) return;
      members = pending[--pending_count];
      FewSplits::Split& above = few.splits[members.split];
      above.first_size = placed - above.first_size;
      continue;
    }
    FewSplits::Split& split = few.splits[split_count];
    const Truth<double> away = all.split(members, split.poles);
    split.first_size = placed;  // until all of the first are placed
    const std::uint32_t away_bits = away.bits();
    const std::uint32_t levels = members.levels + 1;
    pending[pending_count++] = {members.within & away, members.bits & away_bits, split_count,
                                levels};
    members = {members.within & !away, members.bits & ~away_bits, split_count, levels};
    ++split_count;
  }
}

}  // namespace
}  // namespace organ_collision::core
