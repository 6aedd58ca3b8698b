#pragma once

#include "core/kernels/frontier.h"
#include "core/kernels/pair_search.h"

// What a walk through two trees has before it on each side.
namespace organ_collision::core {
namespace {

/// Some of the boxes of a node: all, or that of one packet.
struct Boxes {
  const WideNode& node;
  std::uint32_t begin, end;  ///< lanes
};

/// A node or a packet of one of the surfaces.
class OpenSet {
 public:
  OpenSet(const SearchedTree& tree, std::uint32_t number)
      : tree_(tree), number_(number), is_packet_((number & kPacketBit) != 0) {}

  bool isPacket() const { return is_packet_; }
  const TrianglePacket& packet() const { return tree_.packets[number_ & ~kPacketBit]; }
  const WideNode& node() const { return tree_.nodes[number_]; }
  std::uint32_t number() const { return number_; }
  float radius() const { return is_packet_ ? packet().radius : node().radius; }

  /// A packet's is the one around it in its parent.
  Boxes boxes() const {
    if (!is_packet_) return {node(), 0, node().lane_count};
    const WideNode& parent = tree_.nodes[packet().parent];
    const std::uint32_t lane = parent.node_count + (number_ & ~kPacketBit) - parent.first_packet;
    return {parent, lane, lane + 1};
  }
  /// What is in a lane of its boxes: a packet stays whole.
  std::uint32_t child(std::uint32_t lane) const {
    return is_packet_ ? number_ : setIn(node(), lane);
  }

 private:
  const SearchedTree& tree_;
  std::uint32_t number_;
  bool is_packet_;
};

}  // namespace
}  // namespace organ_collision::core
