#pragma once

#include "core/kernels/lanes.h"
#include "organ_collision/core/wide_node.h"

// What sets cost that share a node's lanes, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

inline void weigh(const LaneFloats& of_one, const LaneFloats& of_other, float as_packet,
                  float weight, LaneFloats& costs) {
  constexpr float kNone = __builtin_huge_valf();
  Lanes<float> of_rest = Lanes<float>::copy(of_other.data());
  Lanes<float> divided = Lanes<float>::all(kNone);
  for (std::uint32_t first = 1; first < kLaneCount; ++first) {
    of_rest = movedUp(of_rest, kNone);
    divided = smaller(divided, Lanes<float>::all(of_one[first - 1]) + of_rest);
  }
  const float as_node = weight + divided[kLaneCount - 1];
  const float whole = as_packet < as_node ? as_packet : as_node;
  smaller(divided, Lanes<float>::all(whole)).store(costs.data());
}

}  // namespace
}  // namespace organ_collision::core
