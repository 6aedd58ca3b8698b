#include "organ_collision/core/wide_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "every_vector_unit.h"
#include "organ_collision/core/collision_mesh.h"
#include "organs_and_tips.h"

namespace organ_collision::core {
namespace {

using test::organs;

using Lane = std::function<void(const WideNode& node, std::uint32_t lane)>;

void forEachLane(const WideTree& tree, const Lane& action) {
  for (const WideNode& node : tree.nodes())
    for (std::uint32_t lane = 0; lane < node.lane_count; ++lane) action(node, lane);
}

/// REQUIRES: there is one.
const TrianglePacket& packetIn(const WideTree& tree, const WideNode& node, std::uint32_t lane) {
  return tree.packets()[node.first_packet + lane - node.node_count];
}

/// The leaves below a lane, each as often as it is there.
std::vector<WideTree::Leaf> leavesBelow(const WideTree& tree, const WideNode& node,
                                        std::uint32_t lane) {
  std::vector<WideTree::Leaf> leaves;
  if (lane >= node.node_count) {
    const TrianglePacket& packet = packetIn(tree, node, lane);
    for (std::uint32_t i = 0; i < packet.lane_count; ++i) leaves.push_back(packet.first_leaf + i);
    return leaves;
  }
  const WideNode& child = tree.nodes()[node.first_node + lane];
  for (std::uint32_t i = 0; i < child.lane_count; ++i) {
    const std::vector<WideTree::Leaf> below = leavesBelow(tree, child, i);
    leaves.insert(leaves.end(), below.begin(), below.end());
  }
  return leaves;
}

/// Corners below a lane, in the unit frame.
Points cornersBelow(const CollisionMesh& organ, const WideNode& node, std::uint32_t lane) {
  const WideTree& tree = organ.wideTree();
  Points corners;
  for (const WideTree::Leaf leaf : leavesBelow(tree, node, lane)) {
    const Triangle triangle = organ.mesh().triangle(organ.tree().triangle(leaf));
    for (const Eigen::Vector3d& corner : {triangle.a, triangle.b, triangle.c})
      corners.push_back(tree.frame()(corner));
  }
  return corners;
}

Eigen::Vector3d vectorOf(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

Eigen::Vector3d turned(const WideNode& node, const Eigen::Vector3d& point) {
  const Eigen::Vector3d offset = point - vectorOf(node.origin);
  return {vectorOf(node.axes[0]).dot(offset), vectorOf(node.axes[1]).dot(offset),
          vectorOf(node.axes[2]).dot(offset)};
}

Box turnedBox(const WideNode& node, std::uint32_t lane) {
  return {{node.low[0][lane], node.low[1][lane], node.low[2][lane]},
          {node.high[0][lane], node.high[1][lane], node.high[2][lane]}};
}

/// No tolerance: boxes and radii are widened by far more than doubles round.
void expectBoxesAroundWhatIsBelow(const CollisionMesh& organ) {
  const WideTree& tree = organ.wideTree();
  forEachLane(tree, [&](const WideNode& node, std::uint32_t lane) {
    for (const Eigen::Vector3d& corner : cornersBelow(organ, node, lane)) {
      EXPECT_TRUE(turnedBox(node, lane).contains(turned(node, corner)));
      EXPECT_TRUE(tree.boxOf(node, lane).contains(corner));
      EXPECT_LE((corner - vectorOf(node.origin)).norm(), node.radius);
    }
    if (lane < node.node_count) return;
    const TrianglePacket& packet = packetIn(tree, node, lane);
    const Points corners = cornersBelow(organ, node, lane);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector3d& next = corners[i - i % 3 + (i + 1) % 3];
      EXPECT_LE((corners[i] - vectorOf(packet.origin)).norm(), packet.radius);
      EXPECT_LE((corners[i] - next).norm(), packet.radius);  // packet_range.h relies on it
    }
  });
}

TEST(WideTree, HoldsEveryLeafInOneLaneOfOnePacket) {
  for (const CollisionMesh& organ : organs()) {
    const WideTree& tree = organ.wideTree();
    std::vector<int> times(organ.mesh().triangleCount(), 0);
    for (const TrianglePacket& packet : tree.packets()) {
      EXPECT_LE(packet.lane_count, kLaneCount);
      for (std::uint32_t lane = 0; lane < packet.lane_count; ++lane)
        ++times.at(packet.first_leaf + lane);
    }
    EXPECT_EQ(times, std::vector<int>(times.size(), 1));
    for (WideTree::Leaf leaf = 0; leaf < times.size(); ++leaf)
      EXPECT_EQ(tree.leafOf(organ.tree().triangle(leaf)), leaf);
  }
}

/// In clusters, so that sets of a few triangles are nodes, between packets of one.
TriangleMesh clusters(std::uint32_t seed) {
  std::mt19937 generator(seed);
  Points centres;
  for (std::size_t count = 12 + generator() % 12; count > 0; --count) {
    centres.push_back(test::randomPoint(generator, 1.0));
    if (generator() % 2 == 0) continue;
    const Eigen::Vector3d beside = centres.back() + test::randomPoint(generator, 0.4);
    centres.push_back(beside);
  }
  Points points;
  std::vector<Corners> triangles;
  const std::size_t count = centres.size() + generator() % 60;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t centre = i < centres.size() ? i : generator() % centres.size();
    const Eigen::Vector3d a = centres[centre] + test::randomPoint(generator, 1e-3);
    points.insert(points.end(),
                  {a, a + Eigen::Vector3d(1e-4, 0, 0), a + Eigen::Vector3d(0, 1e-4, 0)});
    triangles.push_back(test::corners(3 * i, 3 * i + 1, 3 * i + 2));
  }
  return {points, triangles};
}

TEST(WideTree, HoldsEveryLeafOnceWhereSetsOfAFewAreNodes) {
  for (std::uint32_t seed = 0; seed < 2000; ++seed) {
    const CollisionMesh organ(clusters(seed));
    std::vector<int> times(organ.mesh().triangleCount(), 0);
    for (const TrianglePacket& packet : organ.wideTree().packets())
      for (std::uint32_t lane = 0; lane < packet.lane_count; ++lane)
        ++times.at(packet.first_leaf + lane);
    ASSERT_EQ(times, std::vector<int>(times.size(), 1)) << seed;
  }
}

TEST(WideTree, NeighbouringPacketsOfANodeShareOneIfThereIsRoom) {
  for (const CollisionMesh& organ : organs()) {
    const auto& packets = organ.wideTree().packets();
    for (std::size_t i = 1; i < packets.size(); ++i) {
      const TrianglePacket& one = packets[i - 1];
      const TrianglePacket& next = packets[i];
      if (one.parent == next.parent && one.first_leaf + one.lane_count == next.first_leaf) {
        EXPECT_GT(one.lane_count + next.lane_count, kLaneCount);
      }
    }
  }
}

TEST(WideTree, StoresLevelAfterLevelAndKnowsItsDepth) {
  for (const CollisionMesh& organ : organs()) {
    const WideTree& tree = organ.wideTree();
    std::uint32_t next_node = 1;
    std::uint32_t next_packet = 0;
    std::vector<std::size_t> depths = {1};
    for (std::uint32_t i = 0; i < tree.nodes().size(); ++i) {
      const WideNode& node = tree.nodes()[i];
      EXPECT_GE(node.lane_count, 1U);
      EXPECT_LE(node.lane_count, kLaneCount);
      EXPECT_EQ(node.first_node, next_node);
      EXPECT_EQ(node.first_packet, next_packet);
      for (std::uint32_t lane = node.node_count; lane < node.lane_count; ++lane)
        EXPECT_EQ(tree.packets()[next_packet++].parent, i);
      next_node += node.node_count;
      depths.resize(next_node, depths[i] + 1);
    }
    EXPECT_EQ(next_node, tree.nodes().size());
    EXPECT_EQ(next_packet, tree.packets().size());
    EXPECT_EQ(tree.depth(), depths.back());
  }
}

TEST(WideTree, LanesThatAreNotInUseRepeatOthers) {
  for (const CollisionMesh& organ : organs()) {
    for (const WideNode& node : organ.wideTree().nodes()) {
      for (std::uint32_t lane = node.lane_count; lane < kLaneCount; ++lane) {
        EXPECT_EQ(turnedBox(node, lane).low, turnedBox(node, node.lane_count - 1U).low);
        EXPECT_EQ(turnedBox(node, lane).high, turnedBox(node, node.lane_count - 1U).high);
      }
    }
    for (const TrianglePacket& packet : organ.wideTree().packets()) {
      for (std::uint32_t lane = packet.lane_count; lane < kLaneCount; ++lane) {
        for (const LanePoints* points : {&packet.centroid, &packet.along, &packet.up})
          for (const LaneFloats& coordinates : *points)
            EXPECT_EQ(coordinates[lane], coordinates[0]);
        for (const LaneFloats* lengths : {&packet.before, &packet.beyond, &packet.height})
          EXPECT_EQ((*lengths)[lane], lengths->front());
      }
    }
  }
}

TEST(WideTree, OfOneTriangleIsANodeAndAPacket) {
  const CollisionMesh organ(
      TriangleMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {test::corners(0, 1, 2)}));
  EXPECT_EQ(organ.wideTree().nodes().size(), 1U);
  EXPECT_EQ(organ.wideTree().packets().size(), 1U);
  EXPECT_EQ(organ.wideTree().depth(), 1U);
  EXPECT_GE(organ.wideTree().memory(), sizeof(WideNode) + sizeof(TrianglePacket));
}

class WideTreeBoxes : public test::EveryVectorUnit {};
ORGAN_COLLISION_ON_EVERY_VECTOR_UNIT(WideTreeBoxes);

TEST_P(WideTreeBoxes, HoldWhatIsBelowWhenBuiltAndWhenRefitted) {
  for (const CollisionMesh& built : organs()) {
    CollisionMesh organ(built.mesh());
    expectBoxesAroundWhatIsBelow(organ);
    Points positions = organ.mesh().positions();
    for (Eigen::Vector3d& point : positions)
      point = Eigen::AngleAxisd(point.x(), Eigen::Vector3d::UnitX()) * point;
    organ.refit(positions);
    expectBoxesAroundWhatIsBelow(organ);
    organ.refit({VertexId{0}, VertexId{1}}, {positions[2], 0.5 * (positions[0] + positions[2])});
    expectBoxesAroundWhatIsBelow(organ);
  }
}

TEST_P(WideTreeBoxes, AreTheSameWhetherAFewVerticesAreRefittedOrAll) {
  const std::vector<VertexId> moved = {VertexId{7}, VertexId{90}, VertexId{300}};
  CollisionMesh few(test::blob(4));
  few.refit(few.mesh().positions());  // boxes around boxes, as partial refits draw them
  CollisionMesh all = few;
  Points positions = all.mesh().positions();
  Points places;
  for (const VertexId vertex : moved)
    places.push_back(positions[index(vertex)] *= 0.5);  // into the organ
  few.refit(moved, places);
  all.refit(positions);
  for (std::size_t i = 0; i < all.wideTree().nodes().size(); ++i) {
    EXPECT_EQ(few.wideTree().nodes()[i].low, all.wideTree().nodes()[i].low);
    EXPECT_EQ(few.wideTree().nodes()[i].high, all.wideTree().nodes()[i].high);
    EXPECT_EQ(few.wideTree().nodes()[i].radius, all.wideTree().nodes()[i].radius);
  }
  for (std::size_t i = 0; i < all.wideTree().packets().size(); ++i) {
    EXPECT_EQ(few.wideTree().packets()[i].centroid, all.wideTree().packets()[i].centroid);
    EXPECT_EQ(few.wideTree().packets()[i].radius, all.wideTree().packets()[i].radius);
  }
}

}  // namespace
}  // namespace organ_collision::core
