#include "core/node_splits.h"

#include <cstddef>
#include <vector>

namespace organ_collision::core {
namespace {

using Set = FarthestPairTree::Set;

/// Splits of neighbouring sets, and what they end in, in the order of the leaves.
struct SplitList {
  SplitPaths paths = {0, ~std::uint64_t{0}};
  Poles poles;  // as leaves
  std::uint32_t split_count = 0;
  std::uint32_t end_count = 0;

  explicit SplitList(FarthestPairTree::Leaf unused) {
    for (auto& leaves : poles) leaves.fill(unused);
  }

  /// Splits a set down to those of which it is true that they are ends.
  template <class IsEnd>
  void divide(const FarthestPairTree& tree, const Set& whole, const IsEnd& is_end) {
    struct Pending {
      Set set;
      SplitPaths path;
    };
    std::array<Pending, kLaneCount> pending;
    std::size_t count = 0;
    Set set = whole;
    SplitPaths path = {0, 0};
    while (true) {
      if (is_end(set)) {
        paths.above |= path.above << (8 * end_count);
        paths.firsts ^= (path.firsts ^ 0xFFU) << (8 * end_count);
        ++end_count;
        if (count == 0) return;
        --count;
        set = pending[count].set;
        path = pending[count].path;
        continue;
      }
      const std::uint64_t self = std::uint64_t{1} << split_count;
      const auto [first, second] = tree.children(set);
      for (std::size_t i = 0; i < poles.size(); ++i) poles[i][split_count] = tree.poles(set)[i];
      ++split_count;
      path.above |= self;
      pending[count++] = {second, path};
      set = first;
      path.firsts |= self;
    }
  }
};

bool isSame(const Set& one, const Set& other) {
  return one.begin == other.begin && one.end == other.end;
}

/// The lanes of poles that are in a packet, three bits each.
std::uint32_t lanesOf(const std::array<FarthestPairTree::Leaf, kLaneCount>& poles,
                      FarthestPairTree::Leaf first_leaf) {
  std::uint32_t lanes = 0;
  for (std::uint32_t i = 0; i < kLaneCount; ++i) lanes |= (poles[i] - first_leaf) << (3 * i);
  return lanes;
}

}  // namespace

Poles listSplits(const FarthestPairTree& tree, const WideLayout& layout, std::uint32_t number,
                 NodeSplits& splits, PacketSplits* packets) {
  const WideLayout::Node& node = layout.nodes[number];
  splits.sets.fill(0);
  SplitList list(node.set.begin);
  std::uint32_t child = node.first_node;
  std::uint32_t packet = node.first_packet;
  std::vector<SplitList> in_packets;
  in_packets.reserve(node.packet_count);
  for (std::uint32_t i = 0; i < node.packet_count; ++i)
    in_packets.emplace_back(layout.packets[packet + i].begin);
  list.divide(tree, node.set, [&](const Set& set) {
    std::uint32_t& end = splits.sets[list.end_count];
    if (child < node.first_node + node.node_count && isSame(set, layout.nodes[child].set)) {
      end = child++;
      return true;
    }
    while (packet < node.first_packet + node.packet_count &&
           layout.packets[packet].end <= set.begin)
      ++packet;
    if (packet == node.first_packet + node.packet_count) return false;
    const auto& [begin, packet_end, parent] = layout.packets[packet];
    if (set.begin < begin || packet_end < set.end) return false;
    end = kPacketBit | (packet * kLaneCount + set.begin - begin);
    in_packets[packet - node.first_packet].divide(tree, set,
                                                  [](const Set& part) { return part.isLeaf(); });
    return true;
  });
  splits.paths = list.paths;
  for (std::uint32_t i = 0; i < node.packet_count; ++i) {
    const auto& [paths, poles, split_count, end_count] = in_packets[i];
    const FarthestPairTree::Leaf first_leaf = layout.packets[node.first_packet + i].begin;
    packets[node.first_packet + i].paths = paths;
    packets[node.first_packet + i].poles = {lanesOf(poles[0], first_leaf),
                                            lanesOf(poles[1], first_leaf)};
  }
  return list.poles;
}

}  // namespace organ_collision::core
