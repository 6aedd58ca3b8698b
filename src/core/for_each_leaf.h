#pragma once

#include <cstdint>
#include <vector>

#include "organ_collision/core/wide_tree.h"

namespace organ_collision::core {

/// Calls `look_at(leaf)` for the leaves of all packets whose box, and those above it, are wanted:
/// `is_wanted(box)`, in the unit frame. Nothing recurses. Neither may call this again.
template <class IsWanted, class LookAt>
void forEachLeaf(const WideTree& tree, const IsWanted& is_wanted, const LookAt& look_at) {
  thread_local std::vector<std::uint32_t> stack;  // nodes
  stack.assign(1, 0);
  while (!stack.empty()) {
    const WideNode& node = tree.nodes()[stack.back()];
    stack.pop_back();
    for (std::uint32_t lane = 0; lane < node.lane_count; ++lane) {
      if (!is_wanted(tree.boxOf(node, lane))) continue;
      if (lane < node.node_count) {
        stack.push_back(node.first_node + lane);
        continue;
      }
      const TrianglePacket& packet = tree.packets()[node.first_packet + lane - node.node_count];
      for (std::uint32_t i = 0; i < packet.lane_count; ++i) look_at(packet.first_leaf + i);
    }
  }
}

}  // namespace organ_collision::core
