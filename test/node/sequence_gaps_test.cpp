#include "node/sequence_gaps.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace organ_collision::node {
namespace {

/// Lost before the last of these messages of one publisher, and before the others.
std::uint32_t lostIn(std::initializer_list<std::uint32_t> sequences) {
  SequenceGaps gaps;
  std::uint32_t lost = 0;
  for (const std::uint32_t sequence : sequences) lost += gaps.before("simulator", sequence);
  return lost;
}

TEST(SequenceGaps, AreWhatIsMissingBetweenTwoMessages) {
  EXPECT_EQ(lostIn({1, 2, 3}), 0U);
  EXPECT_EQ(lostIn({1, 2, 5, 6, 8}), 3U);
}

TEST(SequenceGaps, BeforeTheFirstMessageAreNotKnown) { EXPECT_EQ(lostIn({17, 18}), 0U); }

TEST(SequenceGaps, AreThoseOfEachPublisher) {
  SequenceGaps gaps;
  gaps.before("one", 1);
  gaps.before("other", 8);
  EXPECT_EQ(gaps.before("one", 2), 0U);
  EXPECT_EQ(gaps.before("other", 11), 2U);
}

TEST(SequenceGaps, AreCountedOnAfterAPublisherHasStartedAnew) {
  EXPECT_EQ(lostIn({7, 8, 0, 1, 4}), 2U);
  EXPECT_EQ(lostIn({7, 8, 1, 4}), 2U);
}

TEST(SequenceGaps, AreNoneInTheNumbersOfTwoRecordedPublishers) {
  EXPECT_EQ(lostIn({1000, 5, 1001, 6, 1002, 7}), 0U);
}

TEST(SequenceGaps, AreCountedOnAfterManyPublishersHaveComeAndGone) {
  SequenceGaps gaps;
  for (int i = 0; i < 1000; ++i) gaps.before("anonymous " + std::to_string(i), 1);
  gaps.before("one", 1);
  EXPECT_EQ(gaps.before("one", 4), 2U);
}

TEST(SequenceGaps, OfTensOfThousandsAreNoLoss) {
  EXPECT_EQ(lostIn({1, 9000}), 8998U);
  EXPECT_EQ(lostIn({1, 20000}), 0U);
}

}  // namespace
}  // namespace organ_collision::node
