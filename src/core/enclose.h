#pragma once

#include "core/bounds.h"
#include "core/kernels.h"
#include "core/lane_triangles.h"

// Boxes and splits of wide nodes, for whichever vector unit includes it.
//
// Rounding: with r the node's radius and u the unit roundoff, moving a point to the node's origin
// and turning it, be it in two steps, is off by less than 32*u*r; axes turn back by their
// transpose but for 2^-20*r. All boxes are widened by more than both.
namespace organ_collision::core {
namespace {

constexpr float kBoxRounding = 0x1p-18F;

struct LaneBox {
  LaneVector<float> low, high;

  void add(const LaneBox& other) {
    low = {smaller(low.x, other.low.x), smaller(low.y, other.low.y), smaller(low.z, other.low.z)};
    high = {larger(high.x, other.high.x), larger(high.y, other.high.y),
            larger(high.z, other.high.z)};
  }
  void add(const LaneVector<float>& point) { add(LaneBox{point, point}); }
};

inline LaneBox emptyLaneBox() {
  const LaneVector<float> infinite = everywhere(
      Vector<float>{__builtin_huge_valf(), __builtin_huge_valf(), __builtin_huge_valf()});
  return {infinite, LaneVector<float>{} - infinite};
}

/// Rows of a rotation.
struct Turn {
  Vector<float> x, y, z;

  [[gnu::always_inline]] LaneVector<float> operator()(const LaneVector<float>& v) const {
    return {dot(everywhere(x), v), dot(everywhere(y), v), dot(everywhere(z), v)};
  }
  Turn magnitudes() const { return {magnitudesOf(x), magnitudesOf(y), magnitudesOf(z)}; }
};

inline Turn turnOf(const WideNode& node) {
  return {vectorOf<float>(node.axes[0]), vectorOf<float>(node.axes[1]),
          vectorOf<float>(node.axes[2])};
}

[[gnu::always_inline]] inline LaneBox boxOfCorners(const TrianglePacket& packet,
                                                   const Vector<float>& offset, const Turn& turn) {
  const auto [corner, ab, ac] = trianglesOf<float>(packet);
  const LaneVector<float> moved = corner + everywhere(offset);
  const LaneVector<float> a = turn(moved);
  const LaneVector<float> b = turn(moved + ab);
  const LaneVector<float> c = turn(moved + ac);
  return {{smaller(smaller(a.x, b.x), c.x), smaller(smaller(a.y, b.y), c.y),
           smaller(smaller(a.z, b.z), c.z)},
          {larger(larger(a.x, b.x), c.x), larger(larger(a.y, b.y), c.y),
           larger(larger(a.z, b.z), c.z)}};
}

/// Of a node's boxes from a lane on, seen from another node.
inline LaneBox boxOfLanes(const WideNode& node, std::uint32_t first_lane,
                          const Vector<float>& offset, const Turn& turn) {
  const LaneVector<float> low = load<float>(node.low);
  const LaneVector<float> high = load<float>(node.high);
  const Lanes<float> half = Lanes<float>::all(0.5F);
  const LaneVector<float> middle = everywhere(offset) + turn(half * (low + high));
  const LaneVector<float> reach = turn.magnitudes()(half * (high - low));
  if (first_lane == 0) return {middle - reach, middle + reach};
  const Truth<float> is_meant =
      Lanes<float>::all(static_cast<float>(first_lane)) <= Lanes<float>::numbers();
  const Lanes<float> most = Lanes<float>::all(__builtin_huge_valf());
  const Lanes<float> least = Lanes<float>::all(-__builtin_huge_valf());
  return {{select(is_meant, middle.x - reach.x, most), select(is_meant, middle.y - reach.y, most),
           select(is_meant, middle.z - reach.z, most)},
          {select(is_meant, middle.x + reach.x, least), select(is_meant, middle.y + reach.y, least),
           select(is_meant, middle.z + reach.z, least)}};
}

inline Vector<float> offsetOf(const WideNode& from, const std::array<float, 3>& to) {
  return vectorOf<float>(to) - vectorOf<float>(from.origin);
}

/// Adds the corners of a node's packets to a box in another's orientation.
inline void addCorners(const WideNode& node, const TrianglePacket* packets, const WideNode& target,
                       LaneBox& box) {
  const std::uint32_t packet_count = node.lane_count - node.node_count;
  for (std::uint32_t i = 0; i < packet_count; ++i) {
    const TrianglePacket& packet = packets[node.first_packet + i];
    box.add(boxOfCorners(packet, offsetOf(target, packet.origin), turnOf(target)));
  }
}

/// The corners of all that is below one node, level by level: those of a level follow one another.
inline LaneBox boxOfAllCorners(const PlainTree& tree, const WideNode& target, std::uint32_t top) {
  LaneBox box = emptyLaneBox();
  std::uint32_t begin = top;
  std::uint32_t end = top + 1;
  while (begin != end) {
    for (std::uint32_t i = begin; i < end; ++i)
      addCorners(tree.nodes[i], tree.packets, target, box);
    begin = tree.nodes[begin].first_node;
    end = tree.nodes[end - 1].first_node + tree.nodes[end - 1].node_count;
  }
  return box;
}

/// The sets' boxes, lane by lane.
struct SetBoxes {
  Lanes<float> low[3][kLaneCount], high[3][kLaneCount];

  void set(std::uint32_t lane, const LaneBox& box) {
    low[0][lane] = box.low.x;
    low[1][lane] = box.low.y;
    low[2][lane] = box.low.z;
    high[0][lane] = box.high.x;
    high[1][lane] = box.high.y;
    high[2][lane] = box.high.z;
  }
  void add(std::uint32_t lane, const LaneBox& box) {
    low[0][lane] = smaller(low[0][lane], box.low.x);
    low[1][lane] = smaller(low[1][lane], box.low.y);
    low[2][lane] = smaller(low[2][lane], box.low.z);
    high[0][lane] = larger(high[0][lane], box.high.x);
    high[1][lane] = larger(high[1][lane], box.high.y);
    high[2][lane] = larger(high[2][lane], box.high.z);
  }
  void repeat(std::uint32_t source, std::uint32_t lane) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis][lane] = low[axis][source];
      high[axis][lane] = high[axis][source];
    }
  }
};

/// Adds the boxes that a node's are drawn around.
inline void addBoxes(const PlainTree& tree, std::uint32_t self, SetBoxes& boxes) {
  const WideNode& node = tree.nodes[self];
  const Turn turn = turnOf(node);
  for (std::uint32_t i = tree.first_parts[self]; i < tree.first_parts[self + 1]; ++i) {
    const NodePart& part = tree.parts[i];
    const WideNode& source = tree.nodes[part.node];
    const Vector<float> offset = offsetOf(node, source.origin);
    boxes.add(part.lane, boxOfLanes(source, part.first_lane,
                                    {dot(turn.x, offset), dot(turn.y, offset), dot(turn.z, offset)},
                                    {vectorOf<float>(part.turn[0]), vectorOf<float>(part.turn[1]),
                                     vectorOf<float>(part.turn[2])}));
  }
}

/// Places the origin and the boxes of a node.
inline void placeBoxes(const PlainTree& tree, std::uint32_t self, Fit fit) {
  WideNode& node = tree.nodes[self];
  node.origin = node.node_count > 0 ? tree.nodes[node.first_node].origin
                                    : tree.packets[node.first_packet].origin;
  SetBoxes boxes;
  for (std::uint32_t lane = 0; lane < node.node_count; ++lane)
    boxes.set(lane, fit == Fit::kBoxes ? emptyLaneBox()
                                       : boxOfAllCorners(tree, node, node.first_node + lane));
  if (fit == Fit::kBoxes) addBoxes(tree, self, boxes);
  for (std::uint32_t lane = node.node_count; lane < node.lane_count; ++lane) {
    const TrianglePacket& packet = tree.packets[node.first_packet + lane - node.node_count];
    boxes.set(lane, boxOfCorners(packet, offsetOf(node, packet.origin), turnOf(node)));
  }
  for (std::uint32_t lane = node.lane_count; lane < kLaneCount; ++lane)
    boxes.repeat(node.lane_count - 1U, lane);
  const LaneVector<float> low = {leastOfEach(boxes.low[0]), leastOfEach(boxes.low[1]),
                                 leastOfEach(boxes.low[2])};
  const LaneVector<float> high = {mostOfEach(boxes.high[0]), mostOfEach(boxes.high[1]),
                                  mostOfEach(boxes.high[2])};
  const LaneVector<float> farthest = {larger(Lanes<float>{} - low.x, high.x),
                                      larger(Lanes<float>{} - low.y, high.y),
                                      larger(Lanes<float>{} - low.z, high.z)};
  node.radius = rootOf(mostOf(dot(farthest, farthest))) * kRadiusRounding + kPlaceRounding;
  const Lanes<float> rounding = Lanes<float>::all(kBoxRounding * node.radius + kPlaceRounding);
  (low.x - rounding).store(&node.low[0][0]);
  (low.y - rounding).store(&node.low[1][0]);
  (low.z - rounding).store(&node.low[2][0]);
  (high.x + rounding).store(&node.high[0][0]);
  (high.y + rounding).store(&node.high[1][0]);
  (high.z + rounding).store(&node.high[2][0]);
}

/// Eight centroids that are anywhere, by their places.
inline LaneVector<float> centroidsIn(const PacketSplits* packets,
                                     const std::array<std::uint32_t, kLaneCount>& places) {
  const float* const first = packets->centroids.front().data();
  const auto along = [&](std::size_t axis) {
    return Lanes<float>::each(
        [&](std::uint32_t i) { return first[places[i] + axis * kLaneCount]; });
  };
  return {along(0), along(1), along(2)};
}

/// Takes over where the poles of a node's splits are.
inline void placeSplits(const PlainTree& tree, std::uint32_t self) {
  NodeSplits& node = tree.node_splits[self];
  const LaneVector<float> first = centroidsIn(tree.packet_splits, tree.poles[self][0]);
  const LaneVector<float> second = centroidsIn(tree.packet_splits, tree.poles[self][1]);
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
