#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "organ_collision/core/farthest_pair_tree.h"
#include "organ_collision/core/huge_pages.h"
#include "organ_collision/core/mesh_health.h"
#include "organ_collision/core/triangle_mesh.h"
#include "organ_collision/core/unit_frame.h"
#include "organ_collision/core/wide_node.h"

namespace organ_collision::core {

enum class Fit : std::uint8_t;
struct PlainTree;
struct WideLayout;

/// What leads the paper's search, as well as single precision can tell.
struct GreedyGuide {
  HugePageVector<FarthestPairTree::Set> sets;  ///< of the nodes
  HugePageVector<NodeSplits> nodes;
  HugePageVector<PacketSplits> packets;
};

/// The vertices that each node's packets have. A refit rounds each of them once a node, right where
/// it is needed: what one core has written takes another long to read here and there.
struct VertexLists {
  HugePageVector<VertexId> vertices;      ///< one node's after another's
  std::vector<std::uint32_t> firsts;      ///< of each node and, one more, their end
  HugePageVector<PacketCorners> corners;  ///< of the packets
};

/// The farthest-pair hierarchy as the exact search walks it: its sets, up to eight to a node, with
/// their boxes in the node's own orientation (seen from outside, a surface looks equidistant to
/// boxes along the axes), and below them packets of up to eight triangles. All in single precision,
/// relative to an origin close by; eight lanes are measured at a time. Beside them, what leads the
/// paper's search through the same nodes and packets.
///
/// Invariants: every leaf of the hierarchy is in one lane of one packet; a lane's box holds what is
/// below it, moved to the node's origin and turned into its orientation, in exact arithmetic;
/// children come after parents, level by level; lanes that are not in use repeat others.
/// Sources: A. Dammertz et al., "Shallow bounding volume hierarchies" (2008), for wide nodes;
/// S. Gottschalk et al., "OBBTree" (1996), for the orientation.
class WideTree {
 public:
  using Leaf = FarthestPairTree::Leaf;
  using Set = FarthestPairTree::Set;
  using Node = WideNode;
  using Packet = TrianglePacket;

  WideTree(const FarthestPairTree& tree, const TriangleMesh& mesh, const UnitFrame& frame);

  /// Takes over the positions of `mesh`; sets and orientations stay. O(n), of large ones on all
  /// cores.
  /// Source: G. van den Bergen, "Efficient collision detection of complex deformable models using
  /// AABB trees" (1997).
  void refit(const TriangleMesh& mesh, const UnitFrame& frame);

  /// The same where only these triangles have moved, in the frame of the last refit. O(k log n) for
  /// k triangles.
  void refit(const TriangleMesh& mesh, const std::vector<TriangleId>& touched);

  /// What the triangles add to their mesh's health.
  const HealthTally& tally() const { return tally_; }

  /// A box along the axes of the unit frame around what is in a lane of a node.
  Box boxOf(const Node& node, std::uint32_t lane) const;

  Leaf leafOf(TriangleId triangle) const {
    const std::uint32_t slot = slots_[index(triangle)];
    return packets_[slot / kLaneCount].first_leaf + slot % kLaneCount;
  }
  const UnitFrame& frame() const { return frame_; }
  const GreedyGuide& guide() const { return guide_; }
  const HugePageVector<Node>& nodes() const { return nodes_; }  ///< the root first
  const HugePageVector<Packet>& packets() const { return packets_; }
  const HugePageVector<Corners>& corners() const { return corners_; }  ///< of each leaf

  std::size_t depth() const { return levels_.size(); }  ///< nodes on the longest path to a packet
  std::size_t memory() const;                           ///< [bytes]
  std::size_t searchMemory() const;  ///< [bytes] of them, what searches for a tip read

 private:
  struct Range {
    std::uint32_t begin, end;
    std::uint32_t size() const { return end - begin; }
  };

  Range nodesOn(std::size_t level) const;
  Range childrenOf(const Range& nodes) const;
  Range packetsOf(const Range& nodes) const;
  void listNode(const FarthestPairTree& tree, const WideLayout& layout,
                const HugePageVector<Eigen::Vector3d>& centroids, std::size_t self);
  void listPacket(const FarthestPairTree& tree, const WideLayout& layout, std::size_t self);
  Poles slotsOfPoles(const FarthestPairTree& tree, const Poles& leaves) const;
  void listParts();
  void addPart(std::uint32_t self, std::uint8_t lane, std::uint32_t below, std::uint8_t first_lane);
  void fitAll(const TriangleMesh& mesh, Fit fit);
  std::vector<std::uint32_t> partsToFit() const;
  HealthTally fitBelow(const TriangleMesh& mesh, const Range& nodes, Fit fit);
  HealthTally fill(const TriangleMesh& mesh, const Range& nodes);
  std::uint32_t flatBelow(const TriangleMesh& mesh, std::uint32_t node) const;
  HealthTally tallyOf(const Range& nodes) const;
  PlainTree plain();
  void enclose(const Range& nodes, Fit fit);

  UnitFrame frame_;
  GreedyGuide guide_;
  HugePageVector<Node> nodes_;
  HugePageVector<Packet> packets_;
  std::vector<NodeTally> tallies_;  // of the nodes' packets
  HealthTally tally_;
  std::vector<bool> touched_;  // nodes, then nodes' packets; none but while some are refitted

  // The rest stays as it was built.
  HugePageVector<Corners> corners_;  // of each leaf
  VertexLists lists_;
  std::vector<NodePart> parts_;             // one node's after another's
  std::vector<std::uint32_t> first_parts_;  // of each node and, one more, their end
  std::vector<std::uint32_t> parents_;      // of the nodes
  HugePageVector<std::uint32_t> slots_;     // of each triangle: its packet * 8 + its lane
  std::vector<Poles> poles_;                // of the nodes' splits, by their slots
  std::vector<std::uint32_t> levels_;       // the first node of each
};

}  // namespace organ_collision::core
