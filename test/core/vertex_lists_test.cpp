#include "core/vertex_lists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "organs_and_tips.h"

namespace organ_collision::core {
namespace {

VertexLists listsOf(const CollisionMesh& organ) {
  Collapse::Centroids centroids;
  for (FarthestPairTree::Leaf leaf = 0; leaf < organ.tree().root().size(); ++leaf)
    centroids.push_back(
        organ.wideTree().frame()(centroid(organ.mesh().triangle(organ.tree().triangle(leaf)))));
  return listVertices(Collapse(organ.tree(), centroids).layout(), organ.wideTree().corners());
}

TEST(VertexLists, HoldTheCornersOfEachNodesPackets) {
  for (const CollisionMesh& organ : test::organs()) {
    const WideTree& tree = organ.wideTree();
    const VertexLists lists = listsOf(organ);
    ASSERT_EQ(lists.firsts.size(), tree.nodes().size() + 1);
    ASSERT_EQ(lists.corners.size(), tree.packets().size());
    EXPECT_EQ(lists.firsts.back(), lists.vertices.size());
    for (std::size_t number = 0; number < tree.packets().size(); ++number) {
      const TrianglePacket& packet = tree.packets()[number];
      for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) {
        const std::uint32_t leaf = packet.first_leaf + (lane < packet.lane_count ? lane : 0);
        for (std::size_t corner = 0; corner < 3; ++corner) {
          ASSERT_EQ(lists.corners[number][corner][lane] % sizeof(VertexPlace), 0);
          const std::size_t place = lists.firsts[packet.parent] +
                                    lists.corners[number][corner][lane] / sizeof(VertexPlace);
          ASSERT_LT(place, lists.firsts[packet.parent + 1]);
          ASSERT_EQ(lists.vertices[place], tree.corners()[leaf][corner]);
        }
      }
    }
  }
}

TEST(VertexLists, HoldMostVerticesOnceANode) {
  const CollisionMesh organ(test::blob(4));
  const WideTree& tree = organ.wideTree();
  const VertexLists lists = listsOf(organ);
  std::size_t distinct = 0;
  for (std::size_t node = 0; node < tree.nodes().size(); ++node) {
    const auto begin = lists.vertices.begin() + lists.firsts[node];
    std::vector<VertexId> vertices(begin, lists.vertices.begin() + lists.firsts[node + 1]);
    std::sort(vertices.begin(), vertices.end());
    distinct += std::unique(vertices.begin(), vertices.end()) - vertices.begin();
  }
  EXPECT_LT(lists.vertices.size(), 1.2 * distinct);
  EXPECT_LT(distinct, 1.2 * organ.mesh().triangleCount());  // three times as many corners
}

TEST(VertexLists, HaveRoomForAsManyVerticesAsANodeCanHave) {
  // Triangles that share none, in numbers that all meet in one place of what was seen.
  constexpr std::uint32_t kApart = 1024;
  WideLayout layout;
  layout.nodes.push_back({{}, 0, 0, 0, 0, kLaneCount});
  HugePageVector<Corners> corners;
  for (std::uint32_t leaf = 0; leaf < kLaneCount * kLaneCount; ++leaf) {
    if (leaf % kLaneCount == 0) layout.packets.push_back({leaf, leaf + kLaneCount, 0});
    corners.push_back({VertexId{3 * leaf * kApart}, VertexId{(3 * leaf + 1) * kApart},
                       VertexId{(3 * leaf + 2) * kApart}});
  }
  const VertexLists lists = listVertices(layout, corners);
  ASSERT_EQ(lists.vertices.size(), 3U * kLaneCount * kLaneCount);
  EXPECT_EQ(lists.vertices.back(), corners.back()[2]);
  EXPECT_EQ(lists.corners.back()[2].back(), (lists.vertices.size() - 1) * sizeof(VertexPlace));
}

}  // namespace
}  // namespace organ_collision::core
