#pragma once

#include "core/kernels/kernels.h"
#include "core/kernels/node_boxes.h"

// Boxes around those of other nodes, and splits, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

/// Of a node's boxes from a lane on, seen from another node.
inline Reach reachOfLanes(const WideNode& node, std::uint32_t first_lane,
                          const Vector<float>& offset, const Turn& turn) {
  const LaneVector<float> low = load<float>(node.low);
  const LaneVector<float> high = load<float>(node.high);
  const Lanes<float> half = Lanes<float>::all(0.5F);
  const LaneVector<float> middle = everywhere(offset) + turn(half * (low + high));
  const LaneVector<float> size = turn.magnitudes()(half * (high - low));
  const LaneVector<float> from = middle - size;
  const LaneVector<float> to = middle + size;
  if (first_lane == 0) return reachOfBoxes(from, to);
  const Truth<float> is_meant =
      Lanes<float>::all(static_cast<float>(first_lane)) <= Lanes<float>::numbers();
  const LaneVector<float> least = {nowhere(), nowhere(), nowhere()};
  return reachOfBoxes(select(is_meant, from, LaneVector<float>{} - least),
                      select(is_meant, to, least));
}

inline Vector<float> offsetOf(const WideNode& from, const std::array<float, 3>& to) {
  return vectorOf<float>(to) - vectorOf<float>(from.origin);
}

/// Of the corners of a node's packets, seen from another node.
inline Reach reachOfPackets(const WideNode& node, const TrianglePacket* packets,
                            const WideNode& target) {
  const std::uint32_t packet_count = node.lane_count - node.node_count;
  Reach reach = nowhere();
  for (std::uint32_t i = 0; i < packet_count; ++i) {
    LaneTriangles<float> triangles = framesOf<float>(packets[node.first_packet + i]).triangles();
    triangles.a = triangles.a - everywhere(vectorOf<float>(target.origin));
    reach = larger(reach, reachOfCorners(triangles, turnOf(target.axes)));
  }
  return reach;
}

/// Of all that is below one node, level by level: those of a level follow one another.
inline Reach reachOfAllBelow(const PlainTree& tree, const WideNode& target, std::uint32_t top) {
  Reach reach = nowhere();
  std::uint32_t begin = top;
  std::uint32_t end = top + 1;
  while (begin != end) {
    for (std::uint32_t i = begin; i < end; ++i)
      reach = larger(reach, reachOfPackets(tree.nodes[i], tree.packets, target));
    begin = tree.nodes[begin].first_node;
    end = tree.nodes[end - 1].first_node + tree.nodes[end - 1].node_count;
  }
  return reach;
}

/// Adds the boxes that a node's are drawn around.
inline void addBoxes(const PlainTree& tree, std::uint32_t self, SetReaches& reaches) {
  const WideNode& node = tree.nodes[self];
  const Turn turn = turnOf(node.axes);
  for (std::uint32_t i = tree.first_parts[self]; i < tree.first_parts[self + 1]; ++i) {
    const NodePart& part = tree.parts[i];
    const WideNode& source = tree.nodes[part.node];
    const Vector<float> offset = offsetOf(node, source.origin);
    reaches.add(part.lane,
                reachOfLanes(source, part.first_lane,
                             {dot(turn.x, offset), dot(turn.y, offset), dot(turn.z, offset)},
                             turnOf(part.turn)));
  }
}

/// Places the boxes of a node's nodes: those of its packets are there already (fill.h), and the
/// origin, if it has packets.
inline void placeBoxes(const PlainTree& tree, std::uint32_t self, Fit fit) {
  WideNode& node = tree.nodes[self];
  if (node.node_count == 0) return;
  if (node.node_count == node.lane_count) node.origin = tree.nodes[node.first_node].origin;
  SetReaches reaches;
  for (std::uint32_t lane = 0; lane < node.node_count; ++lane)
    reaches.set(
        lane, fit == Fit::kBoxes ? nowhere() : reachOfAllBelow(tree, node, node.first_node + lane));
  if (fit == Fit::kBoxes) addBoxes(tree, self, reaches);
  storeBoxes(node, 0, node.node_count, reaches);
  node.radius = radiusAround(load<float>(node.high), LaneVector<float>{} - load<float>(node.low));
}

/// Eight centroids that are anywhere, by their slots.
inline LaneVector<float> centroidsIn(const TrianglePacket* packets,
                                     const std::array<std::uint32_t, kLaneCount>& slots) {
  const auto along = [&](std::size_t axis) {
    return Lanes<float>::each([&](std::uint32_t i) {
      const TrianglePacket& packet = packets[slots[i] / kLaneCount];
      return packet.centroid[axis][slots[i] % kLaneCount];
    });
  };
  return {along(0), along(1), along(2)};
}

/// Takes over where the poles of a node's splits are.
inline void placeSplits(const PlainTree& tree, std::uint32_t self) {
  NodeSplits& node = tree.node_splits[self];
  const LaneVector<float> first = centroidsIn(tree.packets, tree.poles[self][0]);
  const LaneVector<float> second = centroidsIn(tree.packets, tree.poles[self][1]);
  const Vector<float> origin = laneOf(first, 0);
  const LaneVector<float> apart = second - first;
  store(apart, node.apart);
  dot(apart, first + second).store(node.middle.data());
  node.origin = {origin.x, origin.y, origin.z};
  node.radius =
      mostOf(larger(reachOf(first - everywhere(origin)), reachOf(second - everywhere(origin))));
}

inline void enclose(const PlainTree& tree, std::uint32_t begin, std::uint32_t end, Fit fit) {
  while (end > begin) {
    --end;
    placeBoxes(tree, end, fit);
    placeSplits(tree, end);
  }
}

}  // namespace
}  // namespace organ_collision::core
