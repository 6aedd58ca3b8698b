#pragma once

#include <cstdint>

#include "core/collapse.h"
#include "organ_collision/core/farthest_pair_tree.h"
#include "organ_collision/core/wide_node.h"

namespace organ_collision::core {

/// The hierarchy's splits within one of the layout's nodes and within its packets, but for where
/// the triangles are; returns the poles of the node's, as leaves.
Poles listSplits(const FarthestPairTree& tree, const WideLayout& layout, std::uint32_t number,
                 NodeSplits& splits, PacketSplits* packets);

}  // namespace organ_collision::core
