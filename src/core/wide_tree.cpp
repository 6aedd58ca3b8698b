#include "organ_collision/core/wide_tree.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <climits>
#include <utility>

#include "core/collapse.h"
#include "core/for_each.h"
#include "core/kernels/kernels.h"
#include "core/node_splits.h"
#include "core/principal_axes.h"
#include "core/vertex_lists.h"
#include "organ_collision/core/predicates.h"

namespace organ_collision::core {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3f;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Set = WideTree::Set;

/// Axes are so much shorter than 1, or rounding them to single precision could make turning a
/// vector lengthen it.
constexpr double kShorter = 1.0 - 0x1p-20;
/// What rounding makes of a box's corner when it is turned back, for a reach of 1.
constexpr float kTurnBackRounding = 0x1p-18F;
/// What rounding makes of the volume of a closed mesh: this part of the squares of two edges of
/// each triangle. Products of a place, below 4, and two edges are off by 2^-20 of those squares;
/// to add up a node's, eleven times in single precision, is off by less, and to move each vertex by
/// kPlaceRounding moves the surface by as much, which is less, too.
constexpr double kVolumeRounding = 0x1p-18;
/// Of a sum of volumes below 64, twice.
constexpr double kSumRounding = 0x1p-46;

/// How deep refits look for boxes. More levels draw boxes closer, and let a partial refit take
/// longer: benchmark/update_figures tells both.
constexpr int kLevels = 2;

constexpr std::size_t kLeafGrain = 1024;    // so many are worth a task
constexpr std::size_t kNodeGrain = 16;      // so many to be turned, too
constexpr std::size_t kPacketGrain = 1024;  // so many to be numbered, too
constexpr std::size_t kFewPackets = 512;    // are filled sooner than another core has woken up
constexpr std::size_t kTasks = 12;          // are enough
constexpr std::size_t kTaskPackets = 1024;  // unless so many are in each: a core's cache holds them
constexpr std::size_t kTaskNodes = 2;       // share a task, or some tasks would be much larger

Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> axesOf(const WideTree::Node& node) {
  return Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(node.axes.front().data());
}

void store(const Matrix3f& matrix, std::array<std::array<float, 3>, 3>& rows) {
  Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(rows.front().data()) = matrix;
}

Eigen::Map<const Vector3f> vector(const std::array<float, 3>& values) {
  return Eigen::Map<const Vector3f>(values.data());
}

/// The same corners, in an order that turns as theirs does.
Corners longestEdgeFirst(const Corners& corners, const Triangle& triangle) {
  const double ab = (triangle.b - triangle.a).squaredNorm();
  const double bc = (triangle.c - triangle.b).squaredNorm();
  const double ca = (triangle.a - triangle.c).squaredNorm();
  // By arithmetic, as no branch could be foreseen.
  const std::size_t is_bc = static_cast<std::size_t>(ab < bc) & static_cast<std::size_t>(ca <= bc);
  const std::size_t is_ca = static_cast<std::size_t>(ab < ca) & static_cast<std::size_t>(bc < ca);
  const std::size_t first = is_bc + 2 * is_ca;
  const auto& [a, b, c] = corners;
  const std::array<VertexId, 5> turning = {a, b, c, a, b};
  return {turning[first], turning[first + 1], turning[first + 2]};
}

}  // namespace

WideTree::WideTree(const FarthestPairTree& tree, const TriangleMesh& mesh, const UnitFrame& frame)
    : frame_(frame), corners_(mesh.triangleCount()), slots_(mesh.triangleCount()) {
  Collapse::Centroids centroids(mesh.triangleCount());
  HugePageVector<Corners> longest_edges_first(mesh.triangleCount());
  forEach(centroids.size(), kLeafGrain, [&](std::size_t leaf) {
    corners_[leaf] = mesh.corners(tree.triangle(static_cast<Leaf>(leaf)));
    const Triangle triangle = mesh.triangle(corners_[leaf]);
    centroids[leaf] = frame(centroid(triangle));
    longest_edges_first[leaf] = longestEdgeFirst(corners_[leaf], triangle);
  });
  WideLayout layout = Collapse(tree, centroids).layout();
  levels_ = std::move(layout.levels);
  packets_.resize(layout.packets.size());
  nodes_.resize(layout.nodes.size());
  parents_.resize(nodes_.size());
  guide_.sets.resize(nodes_.size());
  guide_.nodes.resize(nodes_.size());
  guide_.packets.resize(packets_.size());
  poles_.resize(nodes_.size());
  sideBySide(
      [&] {
        forEach(nodes_.size(), kNodeGrain,
                [&](std::size_t self) { listNode(tree, layout, centroids, self); });
      },
      [&] {
        lists_ = listVertices(layout, longest_edges_first);
        forEach(packets_.size(), kPacketGrain,
                [&](std::size_t self) { listPacket(tree, layout, self); });
      });
  forEach(nodes_.size(), kPacketGrain,
          [&](std::size_t self) { poles_[self] = slotsOfPoles(tree, poles_[self]); });
  listParts();
  tallies_.resize(nodes_.size());
  touched_.resize(2 * nodes_.size());
  fitAll(mesh, Fit::kCorners);
}

/// Its poles as leaves: not all of their slots are known yet.
void WideTree::listNode(const FarthestPairTree& tree, const WideLayout& layout,
                        const HugePageVector<Vector3d>& centroids, std::size_t self) {
  const auto& [set, parent, first_node, first_packet, node_count, packet_count] =
      layout.nodes[self];
  Node& node = nodes_[self];
  node.first_node = first_node;
  node.first_packet = first_packet;
  node.node_count = node_count;
  node.lane_count = static_cast<std::uint8_t>(node_count + packet_count);
  store((kShorter * principalAxes(&centroids[set.begin], set.size())).cast<float>(), node.axes);
  parents_[self] = parent;
  guide_.sets[self] = set;
  poles_[self] = listSplits(tree, layout, static_cast<std::uint32_t>(self), guide_.nodes[self],
                            guide_.packets.data());
}

void WideTree::listPacket(const FarthestPairTree& tree, const WideLayout& layout,
                          std::size_t self) {
  const auto& [begin, end, parent] = layout.packets[self];
  Packet& packet = packets_[self];
  packet.first_leaf = begin;
  packet.lane_count = end - begin;
  packet.parent = parent;
  for (std::uint32_t lane = 0; lane < packet.lane_count; ++lane)
    slots_[index(tree.triangle(begin + lane))] =
        static_cast<std::uint32_t>(self) * kLaneCount + lane;
}

/// REQUIRES: all leaves are listed.
Poles WideTree::slotsOfPoles(const FarthestPairTree& tree, const Poles& leaves) const {
  Poles slots;
  for (std::size_t pole = 0; pole < leaves.size(); ++pole)
    for (std::size_t split = 0; split < kLaneCount; ++split)
      slots[pole][split] = slots_[index(tree.triangle(leaves[pole][split]))];
  return slots;
}

/// A node's box is drawn around those kLevels below it, and around packets' on the way there.
void WideTree::listParts() {
  first_parts_.reserve(nodes_.size() + 1);
  for (std::uint32_t self = 0; self < nodes_.size(); ++self) {
    first_parts_.push_back(static_cast<std::uint32_t>(parts_.size()));
    for (std::uint8_t lane = 0; lane < nodes_[self].node_count; ++lane) {
      const std::uint32_t child = nodes_[self].first_node + lane;
      Range level = {child, child + 1};
      for (int depth = 1; depth <= kLevels && level.begin != level.end; ++depth) {
        for (std::uint32_t node = level.begin; node < level.end; ++node)
          addPart(self, lane, node, depth == kLevels ? 0 : nodes_[node].node_count);
        level = childrenOf(level);
      }
    }
  }
  first_parts_.push_back(static_cast<std::uint32_t>(parts_.size()));
  parts_.shrink_to_fit();
}

/// The lanes of `below`, from one on, are a part of what is in a lane of `self`.
void WideTree::addPart(std::uint32_t self, std::uint8_t lane, std::uint32_t below,
                       std::uint8_t first_lane) {
  if (first_lane == nodes_[below].lane_count) return;
  NodePart& part = parts_.emplace_back(NodePart{below, first_lane, lane, {}});
  store(axesOf(nodes_[self]) * axesOf(nodes_[below]).transpose() /
            static_cast<float>(kShorter * kShorter),
        part.turn);
}

void WideTree::refit(const TriangleMesh& mesh, const UnitFrame& frame) {
  frame_ = frame;
  fitAll(mesh, Fit::kBoxes);
}

WideTree::Range WideTree::childrenOf(const Range& nodes) const {
  const Node& last = nodes_[nodes.end - 1];
  return {nodes_[nodes.begin].first_node, last.first_node + last.node_count};
}

WideTree::Range WideTree::packetsOf(const Range& nodes) const {
  const Node& last = nodes_[nodes.end - 1];
  return {nodes_[nodes.begin].first_packet, last.first_packet + last.lane_count - last.node_count};
}

/// Side by side what is below the nodes of a level, neighbours together; a node above is left to
/// whoever is done with the last one below it.
void WideTree::fitAll(const TriangleMesh& mesh, Fit fit) {
  const std::vector<std::uint32_t> begins = partsToFit();
  const std::size_t count = begins.size() - 1;
  const std::uint32_t above = begins.front();       // so many nodes
  std::vector<HealthTally> tallies(above + count);  // sums are to round the same each time
  std::vector<std::atomic<std::uint32_t>> waits_for(above);
  for (std::uint32_t node = 0; node < above; ++node) waits_for[node] = nodes_[node].node_count;
  const auto settle = [&](std::uint32_t node) {
    tallies[node] = fill(mesh, {node, node + 1});
    enclose({node, node + 1}, fit);
  };
  const auto climb = [&](std::uint32_t node) {
    while (node != 0 && --waits_for[parents_[node]] == 0) settle(node = parents_[node]);
  };
  forEachAlone(above > 0 ? count + 1 : count, [&](std::size_t part) {
    if (part < count) {
      tallies[above + part] = fitBelow(mesh, {begins[part], begins[part + 1]}, fit);
      for (std::uint32_t node = begins[part]; node < begins[part + 1]; ++node) climb(node);
      return;
    }
    for (std::uint32_t node = 0; node < above; ++node) {
      if (nodes_[node].node_count > 0) continue;  // it waits for those
      settle(node);
      climb(node);
    }
  });
  tally_ = {};
  for (const HealthTally& tally : tallies) tally_.add(tally);
}

/// The nodes of one level in parts with about as many triangles below each: where these begin, then
/// where the last one ends.
std::vector<std::uint32_t> WideTree::partsToFit() const {
  if (packets_.size() < kFewPackets) return {0, 1};
  const std::size_t wanted = std::max(kTasks, packets_.size() / kTaskPackets);
  std::size_t level = 0;
  while (level + 1 < levels_.size() && nodesOn(level).size() < kTaskNodes * wanted) ++level;
  const Range nodes = nodesOn(level);
  std::size_t all = 0;
  for (std::uint32_t node = nodes.begin; node < nodes.end; ++node) all += guide_.sets[node].size();
  std::vector<std::uint32_t> begins = {nodes.begin};
  std::size_t below = 0;
  for (std::uint32_t node = nodes.begin; node + 1 < nodes.end; ++node) {
    below += guide_.sets[node].size();
    if (below * wanted >= all * begins.size()) begins.push_back(node + 1);
  }
  begins.push_back(nodes.end);
  return begins;
}

WideTree::Range WideTree::nodesOn(std::size_t level) const {
  const auto begin = [this](std::size_t number) {
    return static_cast<std::uint32_t>(number < levels_.size() ? levels_[number] : nodes_.size());
  };
  return {begin(level), begin(level + 1)};
}

/// Neighbours of one level and all that is below them. Returns what the triangles add to the
/// health.
HealthTally WideTree::fitBelow(const TriangleMesh& mesh, const Range& nodes, Fit fit) {
  HealthTally tally;
  std::vector<Range> levels;
  for (Range level = nodes; level.begin != level.end; level = childrenOf(level)) {
    levels.push_back(level);
    tally.add(fill(mesh, level));
  }
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) enclose(*level, fit);
  return tally;
}

void WideTree::refit(const TriangleMesh& mesh, const std::vector<TriangleId>& touched) {
  std::vector<std::uint32_t> parents;  // of packets that have moved
  std::vector<std::uint32_t> nodes;    // and all above them
  // Nothing is changed yet, should there be no memory.
  parents.reserve(std::min(touched.size(), nodes_.size()));
  nodes.reserve(std::min(touched.size() * levels_.size(), nodes_.size()));
  const auto touch = [this](std::vector<std::uint32_t>& list, std::uint32_t node,
                            std::size_t place) {
    if (touched_[place]) return false;
    touched_[place] = true;
    list.push_back(node);
    return true;
  };
  for (const TriangleId triangle : touched) {
    std::uint32_t node = packets_[slots_[index(triangle)] / kLaneCount].parent;
    if (!touch(parents, node, nodes_.size() + node)) continue;
    while (touch(nodes, node, node) && node != 0) node = parents_[node];
  }
  for (const std::uint32_t node : parents) {
    tally_.subtract(tallyOf({node, node + 1}));
    tally_.add(fill(mesh, {node, node + 1}));
    tally_.rounding += kSumRounding;
    touched_[nodes_.size() + node] = false;
  }
  std::sort(nodes.rbegin(), nodes.rend());  // children before parents
  for (const std::uint32_t node : nodes) {
    enclose({node, node + 1}, Fit::kBoxes);
    touched_[node] = false;
  }
}

PlainTree WideTree::plain() {
  return {nodes_.data(),   guide_.nodes.data(), poles_.data(),      packets_.data(),
          tallies_.data(), parts_.data(),       first_parts_.data()};
}

/// Fills the packets of some nodes of one level; returns what their triangles add to the health.
HealthTally WideTree::fill(const TriangleMesh& mesh, const Range& nodes) {
  const auto& [centre, scale] = frame();
  kernels().fill({mesh.positions().front().data(),
                  {{centre.x(), centre.y(), centre.z()}, scale},
                  lists_.vertices.data(),
                  lists_.firsts.data(),
                  lists_.corners.data()},
                 plain(), nodes.begin, nodes.end);
  for (std::uint32_t node = nodes.begin; node < nodes.end; ++node)
    if (tallies_[node].flat != 0) tallies_[node].flat = flatBelow(mesh, node);
  return tallyOf(nodes);
}

/// How many triangles of a node's packets are flat exactly.
std::uint32_t WideTree::flatBelow(const TriangleMesh& mesh, std::uint32_t node) const {
  std::uint32_t flat = 0;
  const Range packets = packetsOf({node, node + 1});
  for (std::uint32_t number = packets.begin; number < packets.end; ++number) {
    const Packet& packet = packets_[number];
    for (Leaf leaf = packet.first_leaf; leaf < packet.first_leaf + packet.lane_count; ++leaf) {
      const auto& [a, b, c] = mesh.triangle(corners_[leaf]);
      flat += collinear(a, b, c) ? 1 : 0;
    }
  }
  return flat;
}

HealthTally WideTree::tallyOf(const Range& nodes) const {
  HealthTally tally;
  double squared_edges = 0.0;
  for (std::uint32_t node = nodes.begin; node < nodes.end; ++node) {
    tally.volume += double{tallies_[node].volume};
    squared_edges += double{tallies_[node].squared_edges};
    tally.degenerate_triangles += tallies_[node].flat;
  }
  tally.rounding = kVolumeRounding * squared_edges;
  return tally;
}

void WideTree::enclose(const Range& nodes, Fit fit) {
  kernels().enclose(plain(), nodes.begin, nodes.end, fit);
}

Box WideTree::boxOf(const Node& node, std::uint32_t lane) const {
  const Matrix3d back = axesOf(node).transpose().cast<double>() / (kShorter * kShorter);
  const auto corner = [lane](const LanePoints& points) {
    return Vector3d(points[0][lane], points[1][lane], points[2][lane]);
  };
  const Vector3d middle =
      vector(node.origin).cast<double>() + back * (0.5 * (corner(node.low) + corner(node.high)));
  const Vector3d half = back.cwiseAbs() * (0.5 * (corner(node.high) - corner(node.low))) +
                        Vector3d::Constant(kTurnBackRounding * node.radius);
  return {middle - half, middle + half};
}

std::size_t WideTree::searchMemory() const {
  return nodes_.capacity() * sizeof(Node) + packets_.capacity() * sizeof(Packet) +
         corners_.capacity() * sizeof(Corners) + guide_.sets.capacity() * sizeof(Set) +
         guide_.nodes.capacity() * sizeof(NodeSplits) +
         guide_.packets.capacity() * sizeof(PacketSplits);
}

std::size_t WideTree::memory() const {
  return searchMemory() + lists_.vertices.capacity() * sizeof(VertexId) +
         lists_.corners.capacity() * sizeof(PacketCorners) +
         tallies_.capacity() * sizeof(NodeTally) + touched_.capacity() / CHAR_BIT +
         parts_.capacity() * sizeof(NodePart) + poles_.capacity() * sizeof(Poles) +
         (lists_.firsts.capacity() + first_parts_.capacity() + parents_.capacity() +
          slots_.capacity() + levels_.capacity()) *
             sizeof(std::uint32_t);
}

}  // namespace organ_collision::core
