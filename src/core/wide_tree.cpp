#include "organ_collision/core/wide_tree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/kernels.h"
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
/// What rounding makes of a box's corner, for a reach of 1.
constexpr float kBoxRounding = 0x1p-18F;

// So many are worth a task.
constexpr std::size_t kPacketGrain = 256;
constexpr std::size_t kNodeGrain = 64;
using Range = tbb::blocked_range<std::size_t>;

Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> axesOf(const WideTree::Node& node) {
  return Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(node.axes.front().data());
}

Eigen::Map<const Vector3f> vector(const std::array<float, 3>& values) {
  return Eigen::Map<const Vector3f>(values.data());
}

/// The principal axes of points, in rows. Sums in the points' order, whatever their alignment.
Matrix3d principalAxes(const Vector3d* points, std::size_t count) {
  Vector3d mean = Vector3d::Zero();
  for (std::size_t i = 0; i < count; ++i) mean += points[i];
  mean /= static_cast<double>(count);
  Matrix3d covariance = Matrix3d::Zero();
  for (std::size_t i = 0; i < count; ++i)
    covariance += (points[i] - mean) * (points[i] - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).eigenvectors().transpose();
}

Points centroidsOf(const FarthestPairTree& tree, const TriangleMesh& mesh, const UnitFrame& frame) {
  Points centroids(mesh.triangleCount());
  for (std::uint32_t leaf = 0; leaf < centroids.size(); ++leaf)
    centroids[leaf] = frame(centroid(mesh.triangle(tree.triangle(leaf))));
  return centroids;
}

}  // namespace

/// Which sets of the hierarchy become nodes and packets, so that the expected cost of a search is
/// least: a set is visited as often as the square of its reach, and the tip's,
/// tells; a visit costs the same for every
/// node and a little more for a packet. Source: H. Ylitie, T. Karras, S. Laine, "Efficient
/// incoherent ray traversal on GPUs through compressed wide BVHs" (2017), section 4.1.
class WideTree::Collapse {
 public:
  Collapse(const FarthestPairTree& tree, const Points& centroids)
      : tree_(tree), costs_(centroids.size() - 1) {
    std::vector<Set> sets;
    std::vector<Set> pending = {tree.root()};
    while (!pending.empty()) {
      const Set set = pending.back();
      pending.pop_back();
      if (set.isLeaf()) continue;
      sets.push_back(set);
      for (const Set& child : tree.children(set)) pending.push_back(child);
    }
    for (auto set = sets.rbegin(); set != sets.rend(); ++set) weigh(*set, centroids);
  }

  /// The parts of a set that becomes a node, those that are nodes themselves first.
  std::vector<Set> partsOf(const Set& whole) const {
    if (isPacket(whole)) return {whole};
    std::vector<Set> parts;
    std::vector<std::pair<Set, std::uint32_t>> pending = {{whole, kLaneCount}};
    bool first = true;
    while (!pending.empty()) {
      const auto [set, slots] = pending.back();
      pending.pop_back();
      const std::uint32_t used = set.isLeaf() ? 1 : costs_[set.node].slots[slots - 1];
      if (!first && used == 1) {
        parts.push_back(set);
        continue;
      }
      const auto [one, other] = tree_.children(set);
      const std::uint32_t total = first ? kLaneCount : used;
      const std::uint32_t for_first = costs_[set.node].first_slots[total - 1];
      pending.emplace_back(other, total - for_first);
      pending.emplace_back(one, for_first);
      first = false;
    }
    std::stable_partition(parts.begin(), parts.end(),
                          [&](const Set& set) { return !isPacket(set); });
    return parts;
  }

  bool isPacket(const Set& set) const {
    return set.isLeaf() || (set.size() <= kLaneCount && costs_[set.node].is_packet);
  }

 private:
  static constexpr float kPacketCost = 1.3F;
  static constexpr double kUsualDistance = 0.05;  // of tips, in the unit frame

  struct Costs {
    std::array<float, kLaneCount> cost;                // of the set in up to 1, 2, ... 8 lanes
    std::array<std::uint8_t, kLaneCount> slots;        // that it then takes
    std::array<std::uint8_t, kLaneCount> first_slots;  // of them, its first child's, if 2 or more
    float weight;
    bool is_packet;
  };

  float costOf(const Set& set, std::uint32_t slots, float weight) const {
    return set.isLeaf() ? kPacketCost * weight : costs_[set.node].cost[slots - 1];
  }

  void weigh(const Set& set, const Points& centroids) {
    Costs& costs = costs_[set.node];
    const auto [a, b] = tree_.poles(set);
    const double visited = (centroids[a] - centroids[b]).norm() + kUsualDistance;
    costs.weight = static_cast<float>(visited * visited);
    const auto [one, other] = tree_.children(set);
    std::array<float, kLaneCount> divided;
    for (std::uint32_t slots = 2; slots <= kLaneCount; ++slots) {
      divided[slots - 1] = std::numeric_limits<float>::infinity();
      for (std::uint32_t first = 1; first < slots; ++first) {
        const float cost =
            costOf(one, first, costs.weight) + costOf(other, slots - first, costs.weight);
        if (cost < divided[slots - 1]) {
          divided[slots - 1] = cost;
          costs.first_slots[slots - 1] = static_cast<std::uint8_t>(first);
        }
      }
    }
    const float as_node = costs.weight + divided[kLaneCount - 1];
    const float as_packet = set.size() <= kLaneCount ? kPacketCost * costs.weight
                                                     : std::numeric_limits<float>::infinity();
    costs.is_packet = as_packet <= as_node;
    costs.cost[0] = std::min(as_node, as_packet);
    costs.slots[0] = 1;
    for (std::uint32_t slots = 2; slots <= kLaneCount; ++slots) {
      const bool divide = divided[slots - 1] < costs.cost[slots - 2];
      costs.cost[slots - 1] = divide ? divided[slots - 1] : costs.cost[slots - 2];
      costs.slots[slots - 1] = divide ? static_cast<std::uint8_t>(slots) : costs.slots[slots - 2];
    }
  }

  const FarthestPairTree& tree_;
  std::vector<Costs> costs_;  // of the hierarchy's nodes
};

WideTree::WideTree(const FarthestPairTree& tree, const TriangleMesh& mesh, const UnitFrame& frame)
    : frame_(frame), places_(mesh.triangleCount()) {
  const Points centroids = centroidsOf(tree, mesh, frame);
  const Collapse collapse(tree, centroids);
  std::vector<Set> sets = {tree.root()};  // of the nodes
  std::vector<std::size_t> depths = {1};
  nodes_.emplace_back();
  parents_.push_back(0);
  for (std::uint32_t self = 0; self < nodes_.size(); ++self) {
    addChildren(tree, collapse, self, sets);
    if (depths[self] > levels_.size()) levels_.push_back(self);
    depths.resize(nodes_.size(), depths[self] + 1);
    const Matrix3f axes =
        (kShorter * principalAxes(&centroids[sets[self].begin], sets[self].size())).cast<float>();
    for (Eigen::Index row = 0; row < 3; ++row)
      for (Eigen::Index column = 0; column < 3; ++column)
        nodes_[self].axes[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] =
            axes(row, column);
  }
  nodes_.shrink_to_fit();
  packets_.shrink_to_fit();
  parents_.shrink_to_fit();
  fillAll(tree, mesh);
  encloseAll(Fit::kCorners);
}

void WideTree::addChildren(const FarthestPairTree& tree, const Collapse& collapse,
                           std::uint32_t self, std::vector<Set>& sets) {
  nodes_[self].first_node = static_cast<std::uint32_t>(nodes_.size());
  nodes_[self].first_packet = static_cast<std::uint32_t>(packets_.size());
  for (const Set& part : collapse.partsOf(sets[self])) {
    ++nodes_[self].lane_count;
    if (!collapse.isPacket(part)) {
      ++nodes_[self].node_count;
      sets.push_back(part);
      nodes_.emplace_back();
      parents_.push_back(self);
      continue;
    }
    const auto packet_number = static_cast<std::uint32_t>(packets_.size());
    for (std::uint32_t lane = 0; lane < part.size(); ++lane)
      places_[index(tree.triangle(part.begin + lane))] = packet_number * kLaneCount + lane;
    Packet& packet = packets_.emplace_back();
    packet.first_leaf = part.begin;
    packet.lane_count = part.size();
    packet.parent = self;
  }
}

HealthTally WideTree::refit(const FarthestPairTree& tree, const TriangleMesh& mesh,
                            const UnitFrame& frame) {
  frame_ = frame;
  const HealthTally tally = fillAll(tree, mesh);
  encloseAll(Fit::kBoxes);
  return tally;
}

HealthTally WideTree::fillAll(const FarthestPairTree& tree, const TriangleMesh& mesh) {
  // In the same parts each time, so that sums round the same way.
  return tbb::parallel_deterministic_reduce(
      Range(0, packets_.size(), kPacketGrain), HealthTally(),
      [&](const Range& some, HealthTally tally) {
        for (std::size_t i = some.begin(); i < some.end(); ++i) tally.add(fill(i, tree, mesh));
        return tally;
      },
      [](HealthTally first, const HealthTally& second) {
        first.add(second);
        return first;
      });
}

void WideTree::encloseAll(Fit fit) {
  std::size_t end = nodes_.size();
  for (auto level = levels_.rbegin(); level != levels_.rend(); end = *level++) {
    tbb::parallel_for(Range(*level, end, kNodeGrain), [&](const Range& some) {
      for (std::size_t i = some.begin(); i < some.end(); ++i) enclose(i, fit);
    });
  }
}

void WideTree::refit(const FarthestPairTree& tree, const TriangleMesh& mesh,
                     const std::vector<Leaf>& moved) {
  std::vector<std::uint32_t> touched;  // nodes
  std::size_t last = packets_.size();
  for (const Leaf leaf : moved) {
    const std::size_t packet = places_[index(tree.triangle(leaf))] / kLaneCount;
    if (packet == last) continue;
    last = packet;
    fill(packet, tree, mesh);
    for (std::uint32_t node = packets_[packet].parent;; node = parents_[node]) {
      touched.push_back(node);
      if (node == 0) break;
    }
  }
  std::sort(touched.rbegin(), touched.rend());  // children before parents
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  for (const std::uint32_t node : touched) enclose(node, Fit::kBoxes);
}

/// Returns what its triangles add to the mesh's health, but for parted corners.
HealthTally WideTree::fill(std::size_t number, const FarthestPairTree& tree,
                           const TriangleMesh& mesh) {
  Packet& packet = packets_[number];
  PacketCorners corners;
  for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) {
    const Leaf leaf = packet.first_leaf + (lane < packet.lane_count ? lane : 0);
    const Corners& vertices = mesh.corners(tree.triangle(leaf));
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Vector3d& position = mesh.position(vertices[corner]);
      for (std::size_t axis = 0; axis < 3; ++axis)
        corners.position[corner][axis][lane] = position[static_cast<Eigen::Index>(axis)];
    }
  }
  const auto [center, scale] = frame_;
  const PacketTally found =
      kernels().fill(corners, {{center.x(), center.y(), center.z()}, scale}, packet);

  HealthTally tally;
  tally.volume = found.volume;
  tally.rounding = packet.lane_count * HealthTally::kVolumeRounding;
  for (std::uint32_t lane = 0; lane < packet.lane_count && found.maybe_no_area != 0; ++lane) {
    if ((found.maybe_no_area >> lane & 1U) == 0) continue;
    const Triangle triangle = mesh.triangle(tree.triangle(packet.first_leaf + lane));
    if (collinear(triangle.a, triangle.b, triangle.c)) ++tally.degenerate_triangles;
  }
  return tally;
}

void WideTree::enclose(std::size_t node, Fit fit) {
  kernels().enclose(nodes_.data(), packets_.data(), static_cast<std::uint32_t>(node), fit);
}

Box WideTree::boxOf(const Node& node, std::uint32_t lane) const {
  const Matrix3d back = axesOf(node).transpose().cast<double>() / (kShorter * kShorter);
  const auto corner = [lane](const LanePoints& points) {
    return Vector3d(points[0][lane], points[1][lane], points[2][lane]);
  };
  const Vector3d middle =
      vector(node.origin).cast<double>() + back * (0.5 * (corner(node.low) + corner(node.high)));
  const Vector3d half = back.cwiseAbs() * (0.5 * (corner(node.high) - corner(node.low))) +
                        Vector3d::Constant(kBoxRounding * node.radius);
  return {middle - half, middle + half};
}

std::size_t WideTree::memory() const {
  return nodes_.capacity() * sizeof(Node) + packets_.capacity() * sizeof(Packet) +
         parents_.capacity() * sizeof(std::uint32_t) +
         (places_.capacity() + levels_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace organ_collision::core
