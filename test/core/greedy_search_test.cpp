#include "core/greedy_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "brute_force.h"
#include "core/kernels/descend.h"
#include "core/kernels/kernels.h"
#include "every_vector_unit.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organs_and_tips.h"

namespace organ_collision::core {
namespace {

using test::queryCount;

class GreedySearch : public test::EveryVectorUnit {
 protected:
  /// As by the poles themselves.
  static void expectSamePath(const CollisionMesh& organ, const Eigen::Vector3d& tip) {
    const auto [end, splits] = test::greedyPath(organ.tree(), organ.mesh(), tip);
    const GreedyPath path = greedySearch(organ, tip);
    ASSERT_EQ(path.end, end);
    ASSERT_EQ(path.splits, splits);
  }
};
ORGAN_COLLISION_ON_EVERY_VECTOR_UNIT(GreedySearch);

TEST_P(GreedySearch, EndsWhereThePolesThemselvesLead) {
  std::mt19937 generator(6);
  for (const CollisionMesh& organ : test::organs()) {
    for (std::size_t i = 0; i < queryCount(1000); ++i)
      ASSERT_NO_FATAL_FAILURE(expectSamePath(organ, test::randomTip(generator, organ)));
  }
}

/// Between two poles, or as little as single precision can tell on one side.
TEST_P(GreedySearch, IsNotMistakenAboutTipsBetweenPoles) {
  std::mt19937 generator(7);
  for (const CollisionMesh& organ : test::organs()) {
    if (organ.tree().root().isLeaf()) continue;
    for (std::size_t i = 0; i < queryCount(1000); ++i) {
      FarthestPairTree::Set set = organ.tree().root();
      for (std::size_t depth = generator() % organ.tree().depth(); depth > 0; --depth) {
        const FarthestPairTree::Set child = organ.tree().children(set)[generator() % 2];
        if (!child.isLeaf()) set = child;
      }
      const auto pole = [&](std::size_t number) {
        return centroid(
            organ.mesh().triangle(organ.tree().triangle(organ.tree().poles(set)[number])));
      };
      const Eigen::Vector3d apart = pole(1) - pole(0);
      const Eigen::Vector3d along = test::randomPoint(generator, 2 * apart.norm()).cross(apart);
      const double aside = std::ldexp(static_cast<double>(generator() % 3) - 1.0,
                                      -static_cast<int>(generator() % 60));
      ASSERT_NO_FATAL_FAILURE(
          expectSamePath(organ, 0.5 * (pole(0) + pole(1)) + along + aside * apart));
    }
  }
}

TEST_P(GreedySearch, IsSeldomInDoubt) {
  std::mt19937 generator(10);
  const CollisionMesh organ(test::blob(5));
  std::size_t sure = 0;
  const std::size_t count = std::max<std::size_t>(1000, queryCount(1000));  // fewer tell no share
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d tip = test::randomPoint(generator, 2.0);
    Descent descent = descentTo(organ, tip);
    if (!kernels().descend(descent)) continue;
    ++sure;
    ASSERT_EQ(descent.leaf, test::greedyPath(organ.tree(), organ.mesh(), tip).first);
  }
  EXPECT_GT(sure, count * 98 / 100) << sure;
}

/// Exact searches go down the same way, whose turns they do not prove.
TEST_P(GreedySearch, LeadsToThePacketThatTheSplitsOfNodesLeadTo) {
  std::mt19937 generator(11);
  const CollisionMesh organ(test::blob(5));
  const WideTree& tree = organ.wideTree();
  const std::size_t count = std::max<std::size_t>(1000, queryCount(1000));
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d tip = test::randomPoint(generator, 2.0);
    const Eigen::Vector3f place = tree.frame()(tip).cast<float>();
    std::uint32_t set = 0;
    while ((set & kPacketBit) == 0)
      set = setTowards({place.x(), place.y(), place.z()}, tree.guide().nodes[set]);
    const TrianglePacket& packet = tree.packets()[set & ~kPacketBit];
    found += greedySearch(organ, tip).end - packet.first_leaf < packet.lane_count ? 1 : 0;
  }
  EXPECT_GT(found, count * 98 / 100) << found;
}

TEST_P(GreedySearch, FollowsTheTrianglesThroughRefits) {
  std::mt19937 generator(8);
  for (const CollisionMesh& original : test::organs()) {
    CollisionMesh organ(original.mesh());
    Points moved = organ.mesh().positions();
    for (Eigen::Vector3d& point : moved)
      point = Eigen::Vector3d(point.y() + 1.0, -2.0 * point.x(), point.z() * point.x());
    organ.refit(moved);
    for (std::size_t i = 0; i < queryCount(300); ++i) {
      if (i % 10 == 0) {
        const std::size_t vertex = generator() % moved.size();
        organ.refit({static_cast<VertexId>(vertex)}, {moved[generator() % moved.size()]});
      }
      ASSERT_NO_FATAL_FAILURE(expectSamePath(organ, test::randomTip(generator, organ)));
    }
  }
}

TEST_P(GreedySearch, FindsItsWayWhereverTheOrganIsAndHoweverFarTheTip) {
  std::mt19937 generator(9);
  for (const int exponent : {-300, -64, 0, 64, 300}) {
    for (const double offset : {0.0, 1e3, 1e9}) {
      Points positions = test::blob(3).positions();
      for (Eigen::Vector3d& point : positions)
        point = std::ldexp(1.0, exponent) * (point + Eigen::Vector3d(offset, -offset, offset));
      const CollisionMesh organ(TriangleMesh(positions, test::blob(3).triangles()));
      for (std::size_t i = 0; i < queryCount(100); ++i) {
        const Eigen::Vector3d tip = test::randomTip(generator, organ);
        ASSERT_NO_FATAL_FAILURE(expectSamePath(organ, tip));
        ASSERT_NO_FATAL_FAILURE(expectSamePath(organ, std::ldexp(1.0, 2 * i % 160) * tip));
      }
    }
  }
}

/// Squares overflow there in single precision, and a single triangle has no poles to ask instead.
TEST_P(GreedySearch, AnswersWhereOneTriangleIsFarAway) {
  const CollisionMesh organ(
      TriangleMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {test::corners(0, 1, 2)}));
  for (const double far : {1e17, 1e20, 1e140}) {
    const Eigen::Vector3d tip(far, 0, 0);
    EXPECT_EQ(greedyTriangle(organ, tip), TriangleId{0});
    EXPECT_EQ(nearestTriangle(organ, tip, Accuracy::greedy()).distance, far);
  }
}

}  // namespace
}  // namespace organ_collision::core
