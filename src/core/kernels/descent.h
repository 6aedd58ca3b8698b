#pragma once

#include <array>
#include <cstdint>

#include "organ_collision/core/ids.h"
#include "organ_collision/core/wide_node.h"

namespace organ_collision::core {

/// Where a descent went: a set on each level, as far as there is room, in the end a leaf. What it
/// holds changes only how fast the next one is.
using LastWay = std::array<std::uint32_t, 16>;

/// The paper's search on its way down: what it is given, and where it has come. Lengths in the unit
/// frame.
struct Descent {
  const NodeSplits* nodes;
  const TrianglePacket* packets;
  const PacketSplits* packet_splits;
  const Corners* leaf_corners;  ///< of their triangles, by leaf
  LastWay* last_way;
  std::array<float, 3> tip;
  float reach;     ///< 1 and the largest magnitude of the tip's coordinates, at least
  float rounding;  ///< of differences of squared distances in double precision

  std::uint32_t node = 0;  ///< to start from; in doubt, that it has come to: all before is decided
  std::uint32_t splits = 0;  ///< before
  std::uint32_t firsts = 0;  ///< in doubt, the node's splits, by bits, that go with the first pole
  std::uint32_t sure = 0;    ///< those of which that is sure
  std::uint32_t leaf = 0;    ///< in the end
};

}  // namespace organ_collision::core
