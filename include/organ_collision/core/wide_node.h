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

/// Up to eight triangles, neighbours in the order of the leaves.
struct alignas(64) TrianglePacket {
  LanePoints corner, edge1, edge2;  ///< a, b - a, c - a; the corner relative to the origin
  std::array<float, 3> origin;      ///< in the unit frame
  float radius;                     ///< all corners are so near to the origin
  std::uint32_t first_leaf;
  std::uint32_t lane_count;
  std::uint32_t parent;  ///< node
};

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

/// What a packet's triangles add to their mesh's health.
struct PacketTally {
  float volume;         ///< six times, in the unit frame
  float squared_edges;  ///< the sum of two of each triangle's, in the unit frame
  std::uint32_t flat;   ///< the lanes, by bits, of triangles of zero area
};

}  // namespace organ_collision::core
