#include "organ_collision/core/vector_unit.h"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <tuple>

#include "every_vector_unit.h"
#include "organ_collision/core/nearest_pair.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/tracking.h"
#include "organs_and_tips.h"

namespace organ_collision::core {
namespace {

using test::organs;

TEST(VectorUnit, IsTheWidestThatTheMachineHas) {
  EXPECT_EQ(availableVectorUnits().front(), VectorUnit::kBaseline);
  EXPECT_EQ(vectorUnit(), availableVectorUnits().back());
}

TEST(VectorUnit, RefusesOneThatIsNotThereAndKeepsTheOneInUse) {
  EXPECT_THROW(useVectorUnit(VectorUnit{3}), std::invalid_argument);
  EXPECT_EQ(vectorUnit(), availableVectorUnits().back());
}

/// What a hierarchy is made of, as the vector units write it.
auto contents(const WideNode& node) {
  return std::tie(node.low, node.high, node.axes, node.origin, node.radius, node.first_node,
                  node.first_packet, node.node_count, node.lane_count);
}

auto contents(const TrianglePacket& packet) {
  return std::tie(packet.origin, packet.radius, packet.first_leaf, packet.lane_count, packet.parent,
                  packet.centroid, packet.along, packet.up, packet.before, packet.beyond,
                  packet.height);
}

auto contents(const NodeSplits& splits) {
  return std::tie(splits.apart, splits.middle, splits.origin, splits.radius, splits.sets,
                  splits.paths.above, splits.paths.firsts);
}

auto contents(const PacketSplits& splits) {
  return std::tie(splits.paths.above, splits.paths.firsts, splits.poles);
}

auto contents(const NearestTriangle& nearest) {
  return std::tie(nearest.triangle, nearest.closest.point, nearest.closest.offset,
                  nearest.closest.barycentric, nearest.closest.squared_distance,
                  nearest.closest.feature, nearest.tip_point, nearest.normal, nearest.distance,
                  nearest.lower_bound, nearest.upper_bound, nearest.distance_signed,
                  nearest.work.bounds, nearest.work.triangles);
}

/// Runs `action` with the baseline, then again with the unit that the test is about.
template <class Action>
auto onBoth(VectorUnit unit, const Action& action) {
  useVectorUnit(VectorUnit::kBaseline);
  auto expected = action();
  useVectorUnit(unit);
  return std::pair(std::move(expected), action());
}

class EachVectorUnit : public test::EveryVectorUnit {};
ORGAN_COLLISION_ON_EVERY_VECTOR_UNIT(EachVectorUnit);

TEST_P(EachVectorUnit, IsInUseOnceChosen) { EXPECT_EQ(vectorUnit(), GetParam()); }

TEST_P(EachVectorUnit, ChangesNoBitOfAHierarchy) {
  const auto expect_same = [](const CollisionMesh& expected, const CollisionMesh& found) {
    const auto expect_same_parts = [](const auto& expected_parts, const auto& parts) {
      ASSERT_EQ(parts.size(), expected_parts.size());
      for (std::size_t i = 0; i < parts.size(); ++i)
        ASSERT_EQ(contents(parts[i]), contents(expected_parts[i]));
    };
    expect_same_parts(expected.wideTree().nodes(), found.wideTree().nodes());
    expect_same_parts(expected.wideTree().packets(), found.wideTree().packets());
    expect_same_parts(expected.wideTree().guide().nodes, found.wideTree().guide().nodes);
    expect_same_parts(expected.wideTree().guide().packets, found.wideTree().guide().packets);
    EXPECT_EQ(found.wideTree().tally().volume, expected.wideTree().tally().volume);
    EXPECT_EQ(found.health().box.low, expected.health().box.low);
    EXPECT_EQ(found.health().box.high, expected.health().box.high);
    EXPECT_EQ(warnings(found.health()), warnings(expected.health()));
  };
  for (const CollisionMesh& organ : organs()) {
    const auto built = onBoth(GetParam(), [&] { return CollisionMesh(organ.mesh()); });
    ASSERT_NO_FATAL_FAILURE(expect_same(built.first, built.second));
    const auto refitted = onBoth(GetParam(), [&] {
      CollisionMesh moved = organ;
      Points positions = organ.mesh().positions();
      for (Eigen::Vector3d& point : positions) point.z() += 0.1 * point.x() * point.y();
      moved.refit(positions);
      moved.refit({VertexId{0}, VertexId{2}}, {positions[1], positions[0]});
      return moved;
    });
    ASSERT_NO_FATAL_FAILURE(expect_same(refitted.first, refitted.second));
  }
}

/// The same answer from the baseline and from the unit.
template <class Query>
void expectSameBits(VectorUnit unit, const Query& query) {
  const auto [expected, found] = onBoth(unit, query);
  ASSERT_EQ(contents(found), contents(expected));
}

TEST_P(EachVectorUnit, ChangesNoBitOfANearestTriangle) {
  std::mt19937 generator(71);
  for (const CollisionMesh& organ : organs()) {
    for (std::size_t i = 0; i < test::queryCount(300); ++i) {
      const Eigen::Vector3d point = test::randomTip(generator, organ);
      const Triangle triangle = test::randomTriangle(generator, organ);
      const Triangle segment = {triangle.a, triangle.b, triangle.b};
      for (const Accuracy& accuracy :
           {Accuracy{0, 0, 1}, Accuracy{0, 0, 16}, Accuracy{0.05, 0, 0}, Accuracy::exact()}) {
        expectSameBits(GetParam(), [&] { return nearestTriangle(organ, point, accuracy); });
        expectSameBits(GetParam(), [&] { return nearestTriangle(organ, triangle, accuracy); });
        expectSameBits(GetParam(), [&] { return nearestTriangle(organ, segment, accuracy); });
      }
    }
  }
}

TEST_P(EachVectorUnit, ChangesNoBitOfWhatIsFollowed) {
  std::mt19937 generator(72);
  for (const CollisionMesh& organ : organs()) {
    Eigen::Vector3d tip = test::randomTip(generator, organ);
    const double step = 0.01 * (organ.health().box.high - organ.health().box.low).maxCoeff();
    std::array<Tracker, 2> trackers;  // of the baseline, of the unit
    for (std::size_t i = 0; i < test::queryCount(300); ++i) {
      tip += test::randomPoint(generator, step);
      auto tracker = trackers.begin();
      expectSameBits(GetParam(), [&] { return (tracker++)->nearestTriangle(organ, {}, tip); });
    }
  }
}

TEST_P(EachVectorUnit, ChangesNoBitOfTheNearestPairOfSurfaces) {
  std::mt19937 generator(73);
  const CollisionMesh jaw(test::blob(2));
  for (const CollisionMesh& organ : organs()) {
    for (std::size_t i = 0; i < test::queryCount(30); ++i) {
      Eigen::Isometry3d pose(Eigen::Translation3d(test::randomTip(generator, organ)));
      pose.rotate(Eigen::AngleAxisd(0.1 * static_cast<double>(i), Eigen::Vector3d::UnitY()));
      for (const Accuracy& accuracy : {Accuracy{0, 0, 16}, Accuracy{0.05, 0, 0}, Accuracy::exact()})
        expectSameBits(GetParam(), [&] { return nearestPair(jaw, pose, organ, accuracy).nearest; });
    }
  }
}

}  // namespace
}  // namespace organ_collision::core
