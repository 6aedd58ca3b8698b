// On the baseline; that other vector units give the same bits is in vector_unit_test.
#include "core/kernels/candidates.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace organ_collision::core {
namespace {

using testing::ElementsAre;

/// Squares of distances of which the first is the least, each next one farther by 1.
Lanes<float> squaresFrom(float least) {
  const Lanes<float> distances = Lanes<float>::all(least) + Lanes<float>::numbers();
  return distances * distances;
}

Truth<float> firstLanes(float count) {
  return Lanes<float>::numbers() <= Lanes<float>::all(count - 1);
}

template <bool kExact>
class CandidatesFor : public testing::Test {
 protected:
  static constexpr float kRounding = 0.125F;

  /// The bounds of its triangles and, half a unit farther, what they are not farther than.
  void add(float least, float count, std::uint32_t first_leaf) {
    candidates_.add(firstLanes(count), {squaresFrom(least), squaresFrom(least + 0.5F)}, kRounding,
                    first_leaf);
  }

  std::vector<std::uint32_t> takenWithin(float reach) {
    typename Candidates<float, kExact>::Leaves leaves;
    const std::uint32_t count = candidates_.takeWithin(reach, leaves);
    return {leaves, leaves + count};
  }

  typename Candidates<float, kExact>::Room room_;
  Candidates<float, kExact> candidates_{room_};
};

using CandidatesOfPackets = CandidatesFor<false>;
using CandidatesOfExactSearches = CandidatesFor<true>;

TEST_F(CandidatesOfPackets, AreNotFartherThanTheNearest) {
  EXPECT_EQ(candidates_.notFarther(), kFloatInfinity);
  add(5.0F, 8, 100);
  add(2.0F, 3, 200);
  add(3.0F, 8, 300);
  EXPECT_NEAR(candidates_.notFarther(), 2.5F + kRounding, 1e-5F);
  EXPECT_GE(candidates_.notFarther(), 2.5F + kRounding);
  EXPECT_EQ(candidates_.nearestLeaf(), 200U);
}

TEST_F(CandidatesOfPackets, AreTakenWhereTheirBoundsLessRoundingAreWithinReach) {
  add(5.0F, 8, 100);
  add(2.0F, 3, 200);
  add(9.0F, 8, 300);
  EXPECT_THAT(takenWithin(5.9F), ElementsAre(100, 101, 200, 201, 202));  // 6 less 1/8
  EXPECT_EQ(candidates_.packetCount(), 0U);
  EXPECT_EQ(candidates_.notFarther(), kFloatInfinity);
  EXPECT_NEAR(candidates_.leftOut(), 7.0F - kRounding, 1e-5F);
}

TEST_F(CandidatesOfPackets, KeepTheirLeavesWhereOthersAreDropped) {
  add(9.0F, 8, 100);
  add(2.0F, 8, 200);
  add(4.0F, 1, 300);
  candidates_.dropBeyond(4.0F);
  EXPECT_EQ(candidates_.packetCount(), 2U);
  EXPECT_EQ(candidates_.notFarther(), kFloatInfinity);
  EXPECT_NEAR(candidates_.leftOut(), 5.0F - kRounding, 1e-5F);
  add(1.0F, 8, 400);
  EXPECT_EQ(candidates_.nearestLeaf(), 400U);
  EXPECT_THAT(takenWithin(3.0F), ElementsAre(200, 201, 400, 401, 402));
}

TEST_F(CandidatesOfPackets, LeaveNothingOutThatIsNoCandidate) {
  add(2.0F, 1, 100);
  EXPECT_THAT(takenWithin(2.0F), ElementsAre(100));
  EXPECT_EQ(candidates_.leftOut(), kFloatInfinity);
  candidates_.leaveOut(firstLanes(2), squaresFrom(3.0F));
  EXPECT_NEAR(candidates_.leftOut(), 3.0F - kRounding, 1e-5F);
}

TEST_F(CandidatesOfExactSearches, AreToldWhetherOneIsAlone) {
  add(5.0F, 8, 100);
  add(2.0F, 8, 200);
  EXPECT_FALSE(candidates_.takeOnlyWithin(2.9F));  // 201, too: 3 less 1/8
  EXPECT_FALSE(candidates_.takeOnlyWithin(9.0F));
  add(1.0F, 8, 300);
  EXPECT_FALSE(candidates_.takeOnlyWithin(1.9F));  // 301; and 200, in the lane of 300
  EXPECT_TRUE(candidates_.takeOnlyWithin(1.8F));
  EXPECT_EQ(candidates_.packetCount(), 0U);
  add(4.0F, 1, 400);
  EXPECT_TRUE(candidates_.takeOnlyWithin(9.0F));
}

TEST_F(CandidatesOfExactSearches, AreNotAloneBesideOneInTheSameLane) {
  add(4.0F, 1, 100);
  add(4.5F, 1, 200);
  EXPECT_FALSE(candidates_.takeOnlyWithin(4.4F));
  EXPECT_THAT(takenWithin(4.4F), ElementsAre(100, 200));
  add(4.5F, 1, 100);
  add(4.0F, 1, 200);
  EXPECT_FALSE(candidates_.takeOnlyWithin(4.4F));
  EXPECT_TRUE(candidates_.takeOnlyWithin(4.3F));
}

TEST_F(CandidatesOfExactSearches, AreNotTakenForAloneWhereOthersWereDropped) {
  add(4.0F, 8, 100);
  add(2.0F, 1, 200);
  candidates_.dropBeyond(4.0F);
  EXPECT_FALSE(candidates_.takeOnlyWithin(4.0F));
  EXPECT_TRUE(candidates_.takeOnlyWithin(2.0F));
}

}  // namespace
}  // namespace organ_collision::core
