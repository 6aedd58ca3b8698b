// On the baseline; that other vector units give the same bits is in vector_unit_test.
#include "core/kernels/front_keeper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/kernels/frontier.h"
#include "core/nearest_search.h"
#include "organs_and_tips.h"

namespace organ_collision::core {
namespace {

using test::queryCount;

/// Corners of a tip, in the unit frame.
template <std::uint32_t kCorners>
using Tip = std::array<Eigen::Vector3d, kCorners>;

template <std::uint32_t kCorners>
WalkingTip<float, kCorners> walkingTip(const CollisionMesh& organ, const Tip<kCorners>& tip) {
  Search search;
  search.nodes = organ.wideTree().nodes().data();
  for (std::uint32_t i = 0; i < kCorners; ++i)
    search.corners[i] = {tip[i].x(), tip[i].y(), tip[i].z()};
  return WalkingTip<float, kCorners>(search);
}

double distance(const Tip<1>& tip, const Triangle& triangle) {
  return std::sqrt(closestPointOnTriangle(tip[0], triangle).squared_distance);
}
double distance(const Tip<2>& tip, const Triangle& triangle) {
  return std::sqrt(closestPoints({tip[0], tip[1], tip[1]}, triangle).on_second.squared_distance);
}
double distance(const Tip<3>& tip, const Triangle& triangle) {
  return std::sqrt(closestPoints({tip[0], tip[1], tip[2]}, triangle).on_second.squared_distance);
}

/// Moves by what single precision holds, as the front is told.
template <std::uint32_t kCorners>
Tip<kCorners> moved(const Tip<kCorners>& tip, std::mt19937& generator, Front& front) {
  std::uniform_real_distribution<double> digits(0.0, 7.0);
  Tip<kCorners> there = tip;
  for (std::uint32_t i = 0; i < kCorners; ++i) {
    const Eigen::Vector3f shift =
        test::randomPoint(generator, std::pow(10.0, -digits(generator))).cast<float>();
    front.shift[i] = {shift.x(), shift.y(), shift.z()};
    there[i] += shift.cast<double>();
  }
  return there;
}

template <std::uint32_t kCorners>
Tip<kCorners> randomTip(std::mt19937& generator, const CollisionMesh& organ) {
  Tip<kCorners> tip;
  do {
    tip[0] = organ.wideTree().frame()(test::randomTip(generator, organ));
  } while (!(largestCoordinate(tip[0]) < kFar - 1));
  for (std::uint32_t i = 1; i < kCorners; ++i) tip[i] = tip[0] + test::randomPoint(generator, 0.1);
  return tip;
}

/// Triangles of the packets of a node, and the node's boxes around them.
class Kept {
 public:
  explicit Kept(const CollisionMesh& organ) : organ_(organ) {}

  Triangle triangle(const TrianglePacket& packet, std::uint32_t lane) const {
    const UnitFrame& frame = organ_.wideTree().frame();
    const Triangle corners =
        organ_.mesh().triangle(organ_.wideTree().corners()[packet.first_leaf + lane]);
    return {frame(corners.a), frame(corners.b), frame(corners.c)};
  }

  /// From one tip to the next, whatever lies between: no bound says that something is farther than
  /// it is. Returns how far bounds of triangles are too low, where the tip has not moved.
  template <std::uint32_t kCorners>
  double hold(std::mt19937& generator) const {
    const WideTree& tree = organ_.wideTree();
    const WideNode& node = tree.nodes()[generator() % tree.nodes().size()];
    const Tip<kCorners> there = randomTip<kCorners>(generator, organ_);
    Front front;
    const Tip<kCorners> then = moved<kCorners>(there, generator, front);
    FrontKeeper<kCorners> keeper;
    keeper.start(front);
    const WalkingTip<float, kCorners> tip = walkingTip<kCorners>(organ_, then);
    KeptSets boxes;
    keeper.keepBoxes(node, tip, lanesOf((1U << node.lane_count) - 1), boxes);
    double most_below = 0.0;
    for (std::uint32_t lane = node.node_count; lane < node.lane_count; ++lane) {
      const TrianglePacket& packet = tree.packets()[setIn(node, lane) & ~kPacketBit];
      float rounding = 0;
      Planes<float> planes;
      tip.rangeOf(packet, rounding, &planes);
      KeptSets triangles;
      keeper.keepTriangles(planes, rounding, lanesInUse<float>(packet), triangles);
      for (std::uint32_t i = 0; i < packet.lane_count; ++i) {
        const double bound = keeper.boundsOf(triangles)[i];
        most_below = std::max(most_below, distance(then, triangle(packet, i)) - bound);
      }
      const Tip<kCorners> now = moved<kCorners>(there, generator, front);
      FrontKeeper<kCorners> later;
      later.start(front);
      for (std::uint32_t i = 0; i < packet.lane_count; ++i) {
        const auto reach = static_cast<float>(distance(now, triangle(packet, i)));
        EXPECT_LE(later.boundsOf(triangles)[i], later.allowed(reach)[i]);
        EXPECT_LE(later.boundsOf(boxes)[lane], later.allowed(reach)[lane]);
      }
    }
    return most_below;
  }

 private:
  const CollisionMesh& organ_;
};

TEST(FrontKeeper, TellsNothingToBeFartherThanItIsWhereverTheTipGoes) {
  std::mt19937 generator(51);
  for (const CollisionMesh& organ : test::organs()) {
    for (std::size_t i = 0; i < queryCount(500); ++i) {
      Kept(organ).hold<1>(generator);
      Kept(organ).hold<2>(generator);
      Kept(organ).hold<3>(generator);
      ASSERT_FALSE(HasFailure());
    }
  }
}

TEST(FrontKeeper, TellsHowFarWellShapedTrianglesAre) {
  constexpr double kRoom = 6e-5;  // twice 16 roundings of tips up to seven sizes of the organ away
  std::mt19937 generator(52);
  const CollisionMesh organ(test::blob(4));
  for (int i = 0; i < 1000; ++i) EXPECT_LT(Kept(organ).hold<1>(generator), kRoom);
}

TEST(FrontKeeper, ChainsWhatIsWithinReachInItsOrder) {
  constexpr float kReach = 0.5F;
  std::mt19937 generator(53);
  for (std::uint32_t count = 0; count <= Front::kMost; ++count) {
    Front front;
    FrontKeeper<1> keeper;
    keeper.start(front);
    std::vector<std::uint32_t> within;  // places and lanes
    for (std::uint32_t i = 0; i < count; ++i) {
      KeptSets& kept = *keeper.roomFor(i);
      kept.direction = {};
      const std::uint32_t lanes = generator() % 3 == 0 ? generator() & 0xFFU : 0U;
      for (std::uint32_t lane = 0; lane < kLaneCount; ++lane)
        kept.bound[lane] = (lanes >> lane & 1U) != 0 ? 0.0F : 1.0F;
      if (lanes != 0) within.insert(within.end(), {i, lanes});
    }
    std::vector<std::uint32_t> chained;
    for (std::uint32_t i = keeper.chainWithin(keeper.allowed(kReach)); i != KeptSets::kNone;
         i = front.kept[i].next)
      chained.insert(chained.end(), {i, front.kept[i].within});
    EXPECT_EQ(chained, within);
  }
}

TEST(FrontKeeper, LosesTheFrontWhereThereIsNoRoom) {
  Front front;
  FrontKeeper<1> keeper;
  keeper.start(front);
  for (std::uint32_t set = 0; set < Front::kMost; ++set) EXPECT_NE(keeper.roomFor(set), nullptr);
  EXPECT_EQ(keeper.roomFor(0), nullptr);
  EXPECT_EQ(keeper.roomFor(0), nullptr);
  EXPECT_EQ(front.count, 0U);
}

}  // namespace
}  // namespace organ_collision::core
