#include "core/collapse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "core/kernels/kernels.h"
#include "every_vector_unit.h"
#include "organs_and_tips.h"

namespace organ_collision::core {
namespace {

using Set = FarthestPairTree::Set;

Collapse::Centroids centroidsOf(const CollisionMesh& organ) {
  Collapse::Centroids centroids;
  for (FarthestPairTree::Leaf leaf = 0; leaf < organ.tree().root().size(); ++leaf)
    centroids.push_back(
        organ.wideTree().frame()(centroid(organ.mesh().triangle(organ.tree().triangle(leaf)))));
  return centroids;
}

/// What sets cost, by definition.
class Costs {
 public:
  explicit Costs(const CollisionMesh& organ)
      : tree_(organ.tree()), centroids_(centroidsOf(organ)) {}

  double ofNode(const Set& set) const {
    const auto [one, other] = tree_.poles(set);
    const double visited = (centroids_[one] - centroids_[other]).norm() + Collapse::kUsualDistance;
    return visited * visited;
  }

  /// A leaf's is that of its parent.
  double ofPacket(const Set& set, const Set& parent) const {
    return Collapse::kPacketCost * ofNode(set.isLeaf() ? parent : set);
  }

  /// The least that the sets below a node can cost, if it has so many lanes.
  double leastBelow(const Set& set, std::uint32_t lanes) {
    const auto [known, is_new] = known_.insert({{set.node, lanes}, 0.0});
    if (!is_new) return known->second;
    double least = std::numeric_limits<double>::infinity();
    const auto [one, other] = tree_.children(set);
    for (std::uint32_t of_one = 1; of_one < lanes; ++of_one)
      least = std::min(least, leastOf(one, set, of_one) + leastOf(other, set, lanes - of_one));
    return known_[{set.node, lanes}] = least;
  }

  /// The least that the leaves [begin, end), in a packet, cost as one or several sets: neighbours
  /// share packets.
  double ofPacket(const Set& set, const Set& parent, FarthestPairTree::Leaf begin,
                  FarthestPairTree::Leaf end) const {
    if (set.end <= begin || end <= set.begin) return 0.0;
    const bool is_within = begin <= set.begin && set.end <= end;
    const double whole =
        is_within ? ofPacket(set, parent) : std::numeric_limits<double>::infinity();
    if (set.isLeaf()) return whole;
    const auto [one, other] = tree_.children(set);
    return std::min(whole, ofPacket(one, set, begin, end) + ofPacket(other, set, begin, end));
  }

 private:
  double leastOf(const Set& set, const Set& parent, std::uint32_t lanes) {
    if (set.isLeaf()) return ofPacket(set, parent);
    double least = ofNode(set) + leastBelow(set, kLaneCount);
    if (set.size() <= kLaneCount) least = std::min(least, ofPacket(set, parent));
    return lanes > 1 ? std::min(least, leastBelow(set, lanes)) : least;
  }

  const FarthestPairTree& tree_;
  Collapse::Centroids centroids_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> known_;
};

TEST(Collapse, LaysSetsOutAsCheaplyAsCanBe) {
  for (const CollisionMesh& organ : test::organs()) {
    if (organ.mesh().triangleCount() <= kLaneCount) continue;  // no more than a packet
    Costs costs(organ);
    const Set root = organ.tree().root();
    const WideLayout layout = Collapse(organ.tree(), centroidsOf(organ)).layout();
    double cost = 0.0;
    for (const WideLayout::Node& node : layout.nodes) cost += costs.ofNode(node.set);
    for (const auto& [begin, end, parent] : layout.packets)
      cost += costs.ofPacket(root, root, begin, end);
    const double least = costs.ofNode(root) + costs.leastBelow(root, kLaneCount);
    EXPECT_LE(cost, least * (1 + 1e-5));  // sums in single precision
  }
}

class CollapseCosts : public test::EveryVectorUnit {};
ORGAN_COLLISION_ON_EVERY_VECTOR_UNIT(CollapseCosts);

TEST_P(CollapseCosts, AreTheLeastOfAllWaysToShareLanes) {
  constexpr float kNone = std::numeric_limits<float>::infinity();
  std::mt19937 generator(16);
  std::uniform_real_distribution<float> cost(1.0F, 2.0F);
  const auto less_and_less = [&] {
    LaneFloats costs;
    for (float& of_lanes : costs) of_lanes = cost(generator);
    std::sort(costs.rbegin(), costs.rend());
    return costs;
  };
  for (int i = 0; i < 1000; ++i) {
    const LaneFloats one = less_and_less();
    const LaneFloats other = less_and_less();
    LaneFloats expected;
    expected.fill(kNone);
    for (std::size_t lanes = 2; lanes <= kLaneCount; ++lanes)
      for (std::size_t of_one = 1; of_one < lanes; ++of_one)
        expected[lanes - 1] =
            std::min(expected[lanes - 1], one[of_one - 1] + other[lanes - of_one - 1]);
    const float weight = cost(generator) - 1.0F;
    const float as_packet = i % 2 == 0 ? kNone : 2.0F * cost(generator);
    const float whole = std::min(as_packet, weight + expected.back());
    for (float& of_lanes : expected) of_lanes = std::min(of_lanes, whole);
    LaneFloats costs;
    kernels().weigh(one, other, as_packet, weight, costs);
    ASSERT_EQ(costs, expected);
  }
}

}  // namespace
}  // namespace organ_collision::core
