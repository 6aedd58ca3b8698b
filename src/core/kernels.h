#pragma once

#include <cstdint>

#include "core/pair_search.h"
#include "core/search.h"
#include "organ_collision/core/wide_node.h"

// What is translated once for each vector unit. Plain data only: no code that is translated for one
// unit may be called by code for another.
namespace organ_collision::core {

/// How closely a node's boxes are drawn: around boxes that lie some levels below, which takes the
/// same time for every node, or around all the corners there.
enum class Fit : std::uint8_t { kBoxes, kCorners };

/// Where the corners of eight triangles are [m]: first, second, third corner; x, y, z; lane.
struct alignas(64) PacketCorners {
  std::array<std::array<std::array<double, kLaneCount>, 3>, 3> position;
};

/// UnitFrame as plain data.
struct PlainUnitFrame {
  std::array<double, 3> center;
  double scale;
};

struct PacketTally {
  double volume;                ///< six times, in the unit frame, of the lanes in use
  std::uint32_t maybe_no_area;  ///< lanes, by bits: rounding leaves it open; all others have one
};

struct Kernels {
  /// Walks through the tree until nothing that waits matters, or no leaf is left to look at.
  void (*walk)(Search& search);
  /// Looks at the packets that are followed, after the tip has moved by at most `step`.
  void (*follow)(Search& search, double step);
  /// Walks through two trees at once.
  void (*walkPairs)(PairSearch& search);
  /// Looks at the pairs that are followed, after the surfaces have moved by at most `step`.
  void (*followPairs)(PairSearch& search, double step);
  /// Takes over where its triangles are. REQUIRES: packet.lane_count; the other lanes of `corners`
  /// repeat some of those.
  PacketTally (*fill)(const PacketCorners& corners, const PlainUnitFrame& frame,
                      TrianglePacket& packet);
  /// Places a node's origin and boxes. REQUIRES: that is done for all nodes and packets below.
  void (*enclose)(WideNode* nodes, const TrianglePacket* packets, std::uint32_t node, Fit fit);
};

extern const Kernels kBaselineKernels;
extern const Kernels kAvx2Kernels;
extern const Kernels kAvx512Kernels;

/// Those of vectorUnit(). All of them give the same answers, bit for bit.
const Kernels& kernels();

}  // namespace organ_collision::core
