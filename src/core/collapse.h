#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "organ_collision/core/farthest_pair_tree.h"
#include "organ_collision/core/huge_pages.h"
#include "organ_collision/core/wide_node.h"

namespace organ_collision::core {

/// What the hierarchy's sets become, level by level; the children of each node follow one another.
struct WideLayout {
  using Set = FarthestPairTree::Set;

  struct Node {
    Set set;
    std::uint32_t parent, first_node, first_packet;
    std::uint8_t node_count, packet_count;
  };
  struct Packet {
    FarthestPairTree::Leaf begin, end;
    std::uint32_t parent;
  };
  /// Of a node. Packets may hold neighbouring sets.
  struct Children {
    std::array<Set, kLaneCount> nodes, packets;
    std::uint8_t node_count = 0;
    std::uint8_t packet_count = 0;

    void addPacket(const Set& set);
  };

  std::vector<Node> nodes;
  std::vector<Packet> packets;
  std::vector<std::uint32_t> levels;  ///< the first node of each

  void add(const Children& children, std::uint32_t parent);
};

/// Which sets of the hierarchy become wide nodes and packets, so that the expected cost of a search
/// is least: a set is visited as often as the square of its reach, and the tip's, tells; a visit
/// costs the same for every node and a little more for a packet. Source: H. Ylitie, T. Karras,
/// S. Laine, "Efficient incoherent ray traversal on GPUs through compressed wide BVHs" (2017),
/// section 4.1.
class Collapse {
 public:
  using Leaf = FarthestPairTree::Leaf;
  using Set = FarthestPairTree::Set;
  using Centroids = HugePageVector<Eigen::Vector3d>;

  static constexpr float kPacketCost = 1.3F;      ///< times a node's
  static constexpr double kUsualDistance = 0.05;  ///< of tips, in the unit frame

  /// `centroids` of the leaves, in the unit frame. O(n), on all cores.
  Collapse(const FarthestPairTree& tree, const Centroids& centroids);

  WideLayout layout() const;

 private:
  /// Of a set in up to 1, 2, ... 8 lanes. Which lanes, and whether it is a packet, follows from
  /// them.
  using Costs = LaneFloats;
  struct Weighed {
    Costs costs;
    float weight;  ///< what it costs to look at a node of that size
  };

  WideLayout::Children childrenOf(const Set& whole) const;
  bool isPacket(const Set& set) const;
  const Costs& costsOf(const Set& child, const Costs& of_leaf) const;
  std::uint32_t lanesUsed(const Set& set, std::uint32_t lanes) const;
  std::uint32_t lanesOfFirst(const Set& set, std::uint32_t lanes) const;
  std::vector<Set> nodesOf(const Set& top) const;
  void weighUpwards(const std::vector<Set>& sets, const Centroids& centroids);
  void weigh(const Set& set, const Centroids& centroids);

  const FarthestPairTree& tree_;
  HugePageVector<Weighed> weighed_;  // by node of the hierarchy
};

}  // namespace organ_collision::core
