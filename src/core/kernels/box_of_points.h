#pragma once

#include "core/kernels/kernels.h"
#include "core/kernels/lanes.h"

// The box of points, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

inline PlainBox boxOf(const double* points, std::size_t count) {
  constexpr std::size_t kStep = 3 * std::size_t{kLanes};
  // Eight points are three vectors; which coordinate a lane has is the same in all eights.
  Lanes<double> low[3], high[3];
  const Lanes<double> zero{};
  Lanes<double> none[3] = {};  // not a number once a coordinate was not finite
  for (int i = 0; i < 3; ++i) {
    low[i] = Lanes<double>::all(__builtin_huge_val());
    high[i] = Lanes<double>::all(-__builtin_huge_val());
  }
  const auto add = [&](const double* eight) {
    for (int i = 0; i < 3; ++i) {
      const Lanes<double> values = Lanes<double>::copy(eight + std::ptrdiff_t{i} * kLanes);
      low[i] = smaller(values, low[i]);
      high[i] = larger(values, high[i]);
      none[i] = none[i] + values * zero;
    }
  };
  const std::size_t rest_begin = 3 * (count - count % kLanes);
  for (std::size_t i = 0; i < rest_begin; i += kStep) add(points + i);
  double last_eight[kStep];
  for (std::size_t i = 0; i < kStep; ++i)
    last_eight[i] = points[rest_begin + i < 3 * count ? rest_begin + i : i % 3];
  add(last_eight);
  PlainBox box;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = __builtin_huge_val();
    box.high[axis] = -__builtin_huge_val();
  }
  for (std::uint32_t i = 0; i < 3 * kLanes; ++i) {
    const double least = low[i / kLanes][i % kLanes];
    const double most = high[i / kLanes][i % kLanes];
    box.low[i % 3] = least < box.low[i % 3] ? least : box.low[i % 3];
    box.high[i % 3] = most > box.high[i % 3] ? most : box.high[i % 3];
  }
  box.finite = sumOf(none[0] + none[1] + none[2]) == 0.0;
  return box;
}

}  // namespace
}  // namespace organ_collision::core
