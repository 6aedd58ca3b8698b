#include "organ_collision/core/wide_tree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <bitset>
#include <climits>
#include <cmath>
#include <utility>

#include "core/collapse.h"
#include "core/for_each.h"
#include "core/kernels.h"
#include "core/node_splits.h"
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
/// to move each vertex by kPlaceRounding moves the surface by as much, which is less.
constexpr double kVolumeRounding = 0x1p-19;
/// Of a sum of volumes below 64, twice.
constexpr double kSumRounding = 0x1p-46;

/// How deep refits look for boxes. More levels draw boxes closer, and let a partial refit take
/// longer: benchmark/update_figures tells both.
constexpr int kLevels = 3;

/// Of a node's centroids, at most so many are asked for its axes.
constexpr std::size_t kAxesPoints = 256;

constexpr std::size_t kLeafGrain = 1024;    // so many are worth a task
constexpr std::size_t kNodeGrain = 16;      // so many to be turned, too
constexpr std::size_t kPacketGrain = 32;    // so many, too
constexpr std::size_t kVertexGrain = 4096;  // so many, too
constexpr std::size_t kTasks = 32;          // are enough; larger ones read memory in longer runs

Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> axesOf(const WideTree::Node& node) {
  return Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(node.axes.front().data());
}

void store(const Matrix3f& matrix, std::array<std::array<float, 3>, 3>& rows) {
  Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(rows.front().data()) = matrix;
}

Eigen::Map<const Vector3f> vector(const std::array<float, 3>& values) {
  return Eigen::Map<const Vector3f>(values.data());
}

/// The principal axes of points, in rows; of many, those of every so many-th. Sums in the points'
/// order, whatever their alignment.
Matrix3d principalAxes(const Vector3d* points, std::size_t count) {
  const std::size_t step = 1 + count / kAxesPoints;
  Vector3d mean = Vector3d::Zero();
  for (std::size_t i = 0; i < count; i += step) mean += points[i];
  const std::size_t added = (count + step - 1) / step;
  mean /= static_cast<double>(added);
  Vector3d squares = Vector3d::Zero();
  Vector3d products = Vector3d::Zero();  // y*z, z*x, x*y
  for (std::size_t i = 0; i < count; i += step) {
    const Vector3d offset = points[i] - mean;
    squares += offset.cwiseAbs2();
    products += Vector3d(offset.y() * offset.z(), offset.z() * offset.x(), offset.x() * offset.y());
  }
  Matrix3d covariance;
  covariance << squares.x(), products.z(), products.y(),  //
      products.z(), squares.y(), products.x(),            //
      products.y(), products.x(), squares.z();
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).eigenvectors().transpose();
}

}  // namespace

WideTree::WideTree(const FarthestPairTree& tree, const TriangleMesh& mesh, const UnitFrame& frame)
    : frame_(frame),
      vertices_(mesh.positions().size()),
      corners_(mesh.triangleCount()),
      slots_(mesh.triangleCount()) {
  Collapse::Centroids centroids(mesh.triangleCount());
  forEach(centroids.size(), kLeafGrain, [&](std::size_t leaf) {
    corners_[leaf] = mesh.corners(tree.triangle(static_cast<Leaf>(leaf)));
    centroids[leaf] = frame(centroid(mesh.triangle(corners_[leaf])));
  });
  Collapse::Layout layout = Collapse(tree, centroids).layout();
  levels_ = std::move(layout.levels);
  nodes_.resize(layout.nodes.size());
  parents_.resize(nodes_.size());
  packets_.resize(layout.packets.size());
  forEach(packets_.size(), kPacketGrain, [&](std::size_t self) {
    const auto& [begin, end, parent] = layout.packets[self];
    packets_[self].first_leaf = begin;
    packets_[self].lane_count = end - begin;
    packets_[self].parent = parent;
    const auto slot = static_cast<std::uint32_t>(self) * kLaneCount;
    for (Leaf leaf = begin; leaf < end; ++leaf)
      slots_[index(tree.triangle(leaf))] = slot + leaf - begin;
  });
  guide_.sets.resize(nodes_.size());
  guide_.nodes.resize(nodes_.size());
  guide_.packets.resize(packets_.size());
  poles_.resize(nodes_.size());
  forEach(nodes_.size(), kNodeGrain, [&](std::size_t self) {
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
    poles_[self] = slotsOf(tree, listSplits(tree, layout, static_cast<std::uint32_t>(self),
                                            guide_.nodes[self], guide_.packets.data()));
  });
  listParts();
  tallies_.resize(packets_.size());
  touched_.resize(nodes_.size() + packets_.size());
  fitAll(mesh, Fit::kCorners);
}

/// REQUIRES: all leaves are listed.
Poles WideTree::slotsOf(const FarthestPairTree& tree, const Poles& leaves) const {
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

/// Side by side what is below some nodes of one level, each node above as soon as that is done;
/// then the rest.
void WideTree::fitAll(const TriangleMesh& mesh, Fit fit) {
  placeAll(mesh);
  const std::size_t wanted = std::min(kTasks, packets_.size() / kPacketGrain);
  std::size_t level = 0;
  while (level + 1 < levels_.size() && nodesOn(level).size() < wanted) ++level;
  if (level == 0) {
    tally_ = fitBelow(mesh, nodesOn(0), fit);
    return;
  }
  const std::size_t grain = 1 + nodesOn(level).size() / (2 * wanted + 1);
  const Range above = nodesOn(level - 1);
  std::vector<HealthTally> tallies(above.size());  // sums are to round the same each time
  forEachAlone(tallies.size(), [&](std::size_t i) {
    tallies[i] = fitWith(mesh, above.begin + static_cast<std::uint32_t>(i), grain, fit);
  });
  tally_ = fill(mesh, {0, nodes_[above.begin].first_packet});
  for (const HealthTally& tally : tallies) tally_.add(tally);
  enclose({0, above.begin}, fit);
}

/// A node and, side by side, all that is below its children, so many of them at a time.
HealthTally WideTree::fitWith(const TriangleMesh& mesh, std::uint32_t node, std::size_t grain,
                              Fit fit) {
  const Range self = {node, node + 1};
  const Range children = childrenOf(self);
  std::array<HealthTally, kLaneCount> tallies;
  const std::size_t tasks = (children.size() + grain - 1) / grain;
  forEachAlone(tasks, [&](std::size_t i) {
    const auto begin = static_cast<std::uint32_t>(children.begin + i * grain);
    const auto end = static_cast<std::uint32_t>(std::min<std::size_t>(begin + grain, children.end));
    tallies[i] = fitBelow(mesh, {begin, end}, fit);
  });
  HealthTally tally = fill(mesh, packetsOf(self));
  for (std::size_t i = 0; i < tasks; ++i) tally.add(tallies[i]);
  enclose(self, fit);
  return tally;
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
    tally.add(fill(mesh, packetsOf(level)));
  }
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) enclose(*level, fit);
  return tally;
}

void WideTree::refit(const TriangleMesh& mesh, const std::vector<VertexId>& moved,
                     const std::vector<TriangleId>& touched) {
  std::vector<std::uint32_t> packets;
  std::vector<std::uint32_t> nodes;
  packets.reserve(touched.size());  // nothing is changed yet, should there be no memory
  nodes.reserve(std::min(touched.size() * levels_.size(), nodes_.size()));
  for (const VertexId vertex : moved) place(mesh, index(vertex), index(vertex) + 1);
  const auto touch = [this](std::vector<std::uint32_t>& list, std::uint32_t number,
                            std::size_t place) {
    if (touched_[place]) return false;
    touched_[place] = true;
    list.push_back(number);
    return true;
  };
  for (const TriangleId triangle : touched) {
    const std::uint32_t packet = slots_[index(triangle)] / kLaneCount;
    if (!touch(packets, packet, nodes_.size() + packet)) continue;
    std::uint32_t node = packets_[packet].parent;
    while (touch(nodes, node, node) && node != 0) node = parents_[node];
  }
  std::sort(nodes.rbegin(), nodes.rend());  // children before parents
  for (const std::uint32_t packet : packets) {
    tally_.subtract(tallyOf(packet));
    tally_.add(fill(mesh, {packet, packet + 1}));
    tally_.rounding += kSumRounding;
    touched_[nodes_.size() + packet] = false;
  }
  for (const std::uint32_t node : nodes) {
    enclose({node, node + 1}, Fit::kBoxes);
    touched_[node] = false;
  }
}

void WideTree::placeAll(const TriangleMesh& mesh) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, vertices_.size(), kVertexGrain),
                    [&](const auto& some) { place(mesh, some.begin(), some.end()); });
}

/// Takes over where some vertices are.
void WideTree::place(const TriangleMesh& mesh, std::size_t begin, std::size_t end) {
  const auto& [centre, scale] = frame();
  kernels().place(mesh.positions()[begin].data(), end - begin,
                  {{centre.x(), centre.y(), centre.z()}, scale}, &vertices_[begin]);
}

/// Returns what their triangles add to the health.
HealthTally WideTree::fill(const TriangleMesh& mesh, const Range& packets) {
  kernels().fill({vertices_.data(), corners_.data()}, packets_.data() + packets.begin,
                 packets.end - packets.begin, guide_.packets.data() + packets.begin,
                 tallies_.data() + packets.begin);
  HealthTally tally;
  double squared_edges = 0.0;
  for (std::uint32_t number = packets.begin; number < packets.end; ++number) {
    const PacketTally& packet = tallies_[number];
    tally.volume += double{packet.volume};
    squared_edges += double{packet.squared_edges};
    if (packet.flat != 0) tally.degenerate_triangles += keepFlat(mesh, number);
  }
  tally.rounding = kVolumeRounding * squared_edges;
  return tally;
}

/// Leaves those of a packet's flat triangles that are so exactly; returns their number.
std::size_t WideTree::keepFlat(const TriangleMesh& mesh, std::uint32_t number) {
  const Packet& packet = packets_[number];
  std::uint32_t& flat = tallies_[number].flat;
  for (std::uint32_t lane = 0; lane < packet.lane_count; ++lane) {
    const auto& [a, b, c] = mesh.triangle(corners_[packet.first_leaf + lane]);
    if ((flat >> lane & 1U) != 0 && !collinear(a, b, c)) flat &= ~(1U << lane);
  }
  return std::bitset<kLaneCount>(flat).count();
}

HealthTally WideTree::tallyOf(std::uint32_t packet) const {
  const PacketTally& tally = tallies_[packet];
  return {std::bitset<kLaneCount>(tally.flat).count(), double{tally.volume},
          kVolumeRounding * double{tally.squared_edges}};
}

void WideTree::enclose(const Range& nodes, Fit fit) {
  kernels().enclose({nodes_.data(), packets_.data(), parts_.data(), first_parts_.data()},
                    nodes.begin, nodes.end, fit);
  kernels().placeSplits(guide_.packets.data(), poles_.data() + nodes.begin, nodes.end - nodes.begin,
                        guide_.nodes.data() + nodes.begin);
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
  return searchMemory() + vertices_.capacity() * sizeof(VertexPlace) +
         tallies_.capacity() * sizeof(PacketTally) + touched_.capacity() / CHAR_BIT +
         parts_.capacity() * sizeof(NodePart) + poles_.capacity() * sizeof(Poles) +
         (first_parts_.capacity() + parents_.capacity() + slots_.capacity() + levels_.capacity()) *
             sizeof(std::uint32_t);
}

}  // namespace organ_collision::core
