#pragma once

#include "core/kernels.h"
#include "core/lane_vector.h"

// Boxes of wide nodes, for whichever vector unit includes it.
//
// Rounding: with r the node's radius and u the unit roundoff, moving a point to the node's origin
// and turning it, be it in two steps, is off by less than 32*u*r; axes turn back by their
// transpose but for 2^-20*r. All boxes are widened by more than both.
namespace organ_collision::core {
namespace {

constexpr float kBoxRounding = 0x1p-18F;
constexpr float kRadiusRounding = 1.0F + 0x1p-20F;
/// Axes are so much shorter than 1, or rounding them could make turning a vector lengthen it.
constexpr float kShorter = 1.0F - 0x1p-20F;

/// How deep Fit::kBoxes looks for boxes. More levels draw boxes closer, and let a partial refit
/// take longer: benchmark/update_figures tells both.
constexpr int kLevels = 3;

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

  LaneVector<float> operator()(const LaneVector<float>& v) const {
    return {dot(everywhere(x), v), dot(everywhere(y), v), dot(everywhere(z), v)};
  }
  Turn magnitudes() const {
    const auto magnitude = [](const Vector<float>& v) {
      return Vector<float>{v.x < 0 ? -v.x : v.x, v.y < 0 ? -v.y : v.y, v.z < 0 ? -v.z : v.z};
    };
    return {magnitude(x), magnitude(y), magnitude(z)};
  }
};

inline Vector<float> vectorOf(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

inline Turn turnOf(const WideNode& node) {
  return {vectorOf(node.axes[0]), vectorOf(node.axes[1]), vectorOf(node.axes[2])};
}

/// From one node's axes to another's.
inline Turn turnBetween(const WideNode& from, const WideNode& to) {
  const float inverse = 1.0F / (kShorter * kShorter);
  const auto row = [&](const std::array<float, 3>& axis) {
    const auto along = [&](const std::array<float, 3>& other) {
      return inverse * dot(vectorOf(axis), vectorOf(other));
    };
    return Vector<float>{along(from.axes[0]), along(from.axes[1]), along(from.axes[2])};
  };
  return {row(to.axes[0]), row(to.axes[1]), row(to.axes[2])};
}

inline LaneBox boxOfCorners(const TrianglePacket& packet, const Vector<float>& offset,
                            const Turn& turn) {
  const LaneVector<float> a = load<float>(packet.corner) + everywhere(offset);
  LaneBox box = emptyLaneBox();
  box.add(turn(a));
  box.add(turn(a + load<float>(packet.edge1)));
  box.add(turn(a + load<float>(packet.edge2)));
  return box;
}

/// Of a node's boxes from a lane on, seen from another node.
inline LaneBox boxOfLanes(const WideNode& node, std::uint32_t first_lane,
                          const Vector<float>& offset, const Turn& turn) {
  const LaneVector<float> low = load<float>(node.low);
  const LaneVector<float> high = load<float>(node.high);
  const Lanes<float> half = Lanes<float>::all(0.5F);
  const LaneVector<float> middle = everywhere(offset) + turn(half * (low + high));
  const LaneVector<float> reach = turn.magnitudes()(half * (high - low));
  const Truth<float> is_meant =
      Lanes<float>::all(static_cast<float>(first_lane)) <= Lanes<float>::numbers();
  const LaneBox box = {middle - reach, middle + reach};
  const LaneBox none = emptyLaneBox();
  return {{select(is_meant, box.low.x, none.low.x), select(is_meant, box.low.y, none.low.y),
           select(is_meant, box.low.z, none.low.z)},
          {select(is_meant, box.high.x, none.high.x), select(is_meant, box.high.y, none.high.y),
           select(is_meant, box.high.z, none.high.z)}};
}

inline Vector<float> offsetOf(const WideNode& from, const std::array<float, 3>& to) {
  return vectorOf(to) - vectorOf(from.origin);
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

/// Adds a node's boxes from a lane on to a box in another's orientation.
inline void addBoxes(const WideNode& node, std::uint32_t first_lane, const WideNode& target,
                     LaneBox& box) {
  if (first_lane == node.lane_count) return;
  const Turn turn = turnOf(target);
  const Vector<float> offset = offsetOf(target, node.origin);
  box.add(boxOfLanes(node, first_lane,
                     {dot(turn.x, offset), dot(turn.y, offset), dot(turn.z, offset)},
                     turnBetween(node, target)));
}

/// Adds what is below one node, level by level: those of a level follow one another. With
/// Fit::kBoxes not deeper than kLevels, or refitting a node would take the longer the more is
/// below.
inline void addBelow(const WideNode* nodes, const TrianglePacket* packets, const WideNode& target,
                     std::uint32_t top, Fit fit, LaneBox& box) {
  std::uint32_t begin = top;
  std::uint32_t end = top + 1;
  for (int level = 1; begin != end; ++level) {
    const bool is_last = fit == Fit::kBoxes && level == kLevels;
    for (std::uint32_t i = begin; i < end; ++i) {
      if (fit == Fit::kCorners) {
        addCorners(nodes[i], packets, target, box);
      } else {
        addBoxes(nodes[i], is_last ? 0 : nodes[i].node_count, target, box);
      }
    }
    if (is_last) return;
    begin = nodes[begin].first_node;
    end = nodes[end - 1].first_node + nodes[end - 1].node_count;
  }
}

inline void enclose(WideNode* nodes, const TrianglePacket* packets, std::uint32_t self, Fit fit) {
  WideNode& node = nodes[self];
  node.origin =
      node.node_count > 0 ? nodes[node.first_node].origin : packets[node.first_packet].origin;
  node.radius = 0.0F;
  const auto reach = [&node](const std::array<float, 3>& origin, float radius) {
    const Vector<float> offset = offsetOf(node, origin);
    const float farthest = (rootOf(dot(offset, offset)) + radius) * kRadiusRounding;
    node.radius = farthest > node.radius ? farthest : node.radius;
  };
  LaneBox boxes[kLaneCount];
  for (std::uint32_t lane = 0; lane < node.lane_count; ++lane) {
    if (lane < node.node_count) {
      const std::uint32_t child = node.first_node + lane;
      reach(nodes[child].origin, nodes[child].radius);
      boxes[lane] = emptyLaneBox();
      addBelow(nodes, packets, node, child, fit, boxes[lane]);
    } else {
      const TrianglePacket& packet = packets[node.first_packet + lane - node.node_count];
      reach(packet.origin, packet.radius);
      boxes[lane] = boxOfCorners(packet, offsetOf(node, packet.origin), turnOf(node));
    }
  }
  const float rounding = kBoxRounding * node.radius;
  for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) {
    const std::uint32_t source = lane < node.lane_count ? lane : node.lane_count - 1U;
    const LaneBox& box = boxes[source];
    const Lanes<float> none{};
    node.low[0][lane] = leastOf(box.low.x) - rounding;
    node.low[1][lane] = leastOf(box.low.y) - rounding;
    node.low[2][lane] = leastOf(box.low.z) - rounding;
    node.high[0][lane] = rounding - leastOf(none - box.high.x);
    node.high[1][lane] = rounding - leastOf(none - box.high.y);
    node.high[2][lane] = rounding - leastOf(none - box.high.z);
  }
}

}  // namespace
}  // namespace organ_collision::core
