#pragma once

#include <array>
#include <cstdint>

// What WideTree is made of: plain data, which code for any vector unit can read.
namespace organ_collision::core {

constexpr std::uint32_t kLaneCount = 8;
using LaneFloats = std::array<float, kLaneCount>;
using LanePoints = std::array<LaneFloats, 3>;  ///< x, y, z of eight points

/// Up to eight sets of triangles: first nodes, then packets, stored one after the other.
struct alignas(64) WideNode {
  LanePoints low, high;                      ///< the sets' boxes, turned
  std::array<std::array<float, 3>, 3> axes;  ///< that the boxes lie along; a trifle shorter than 1
  std::array<float, 3> origin;               ///< of the boxes, in the unit frame
  float radius;                              ///< all that is below is so near to the origin
  std::uint32_t first_node, first_packet;    ///< of the sets
  std::uint8_t node_count, lane_count;       ///< sets that are nodes; all sets
};

/// Up to eight triangles, neighbours in the order of the leaves. Each has a frame of its own: along
/// an edge, the base, and up from a foot on it to the corner above that. The base is its longest
/// edge or, after it was deformed, another with such a foot.
struct alignas(32) TrianglePacket {
  std::array<float, 3> origin;  ///< in the unit frame
  float radius;                 ///< all corners are so near to the origin
  std::uint32_t first_leaf;
  std::uint32_t lane_count;
  std::uint32_t parent;             ///< node
  alignas(32) LanePoints centroid;  ///< in the unit frame
  LanePoints along, up;             ///< unit vectors, perpendicular
  LaneFloats before, beyond;        ///< how far from the foot the base starts, and ends; above 0
  LaneFloats height;                ///< of the corner above the foot; above 0
};

/// Tells the numbers of packets, and slots, from those of nodes. A slot is a packet's number * 8 +
/// a lane.
constexpr std::uint32_t kPacketBit = 0x80000000U;

/// Which of up to seven splits of the hierarchy lead to which of up to eight sets, so that all are
/// decided at a time. Byte i belongs to set i: its bits in `above` are the splits on the way down
/// to it; in `firsts`, those of them at which it lies on the first pole's side. Bytes without a set
/// hold what never matches. A split comes before those of its children, and the first child's
/// before the other's.
struct SplitPaths {
  std::uint64_t above, firsts;
};

/// The splits within a wide node. A tip p is nearer to the first pole where 2 * apart . p < middle.
struct alignas(64) NodeSplits {
  LanePoints apart;             ///< from the first pole to the second
  LaneFloats middle;            ///< apart . (first pole + second pole), in the unit frame
  std::array<float, 3> origin;  ///< one of the poles, there
  float radius;                 ///< what the poles' coordinates from there sum up to, the most
  /// In the order of the leaves: nodes, or kPacketBit and the slot of the first leaf.
  std::array<std::uint32_t, kLaneCount> sets;
  SplitPaths paths;
};

/// The splits within a packet, of all sets that it holds, down to its lanes.
struct PacketSplits {
  SplitPaths paths;
  std::array<std::uint32_t, 2> poles;  ///< lanes of the first ones, of the others; three bits each
};

/// The poles of up to eight splits, as leaves or by their slots: those that come first, and the
/// others.
using Poles = std::array<std::array<std::uint32_t, kLaneCount>, 2>;

/// Lanes of a node that boxes of one above are drawn around.
struct NodePart {
  std::uint32_t node;
  std::uint8_t first_lane;                   ///< and all after it
  std::uint8_t lane;                         ///< of the node above
  std::array<std::array<float, 3>, 3> turn;  ///< to the axes above
};

/// A vertex in the unit frame, aligned so that it is read at once.
struct alignas(16) VertexPlace {
  float x, y, z;
};

/// Of a packet's triangles, a, b, c of eight of them: how many bytes into the places of the
/// vertices that its node's packets have.
using PacketCorners = std::array<std::array<std::uint16_t, kLaneCount>, 3>;

/// What the triangles of a node's packets add to their mesh's health.
struct NodeTally {
  float volume;         ///< six times, in the unit frame
  float squared_edges;  ///< the sum of two of each triangle's, in the unit frame
  std::uint32_t flat;   ///< how many are of zero area
};

}  // namespace organ_collision::core
