#include "node/burst.h"

#include <gtest/gtest.h>

#include <string>

#include "allocated_memory.h"

namespace organ_collision::node {
namespace {

class BurstTest : public testing::Test {
 protected:
  bool isCompleteWith(const std::string& frame) {
    burst_.noteMove(frame);
    return burst_.isComplete();
  }

  /// Expects to hear of both.
  void hearOfBothTwice() {
    for (int answers = 0; answers < 2; ++answers) {
      EXPECT_FALSE(isCompleteWith("left"));
      EXPECT_FALSE(isCompleteWith("right"));
      burst_.noteAnswer();
    }
  }

  Burst burst_;
};

TEST_F(BurstTest, HoldsWhatHasMovedSinceTheLastAnswer) {
  EXPECT_FALSE(burst_.holds("left"));
  burst_.noteMove("left");
  EXPECT_TRUE(burst_.holds("left"));
  EXPECT_FALSE(burst_.holds("right"));
  burst_.noteAnswer();
  EXPECT_FALSE(burst_.holds("left"));
}

TEST_F(BurstTest, IsCompleteWhenAllHaveMovedThatDidBeforeEachOfTheLastTwoAnswers) {
  hearOfBothTwice();
  burst_.noteAnswer();  // nothing has moved in between
  EXPECT_FALSE(burst_.isComplete());
  EXPECT_FALSE(isCompleteWith("left"));
  EXPECT_FALSE(isCompleteWith("left"));
  EXPECT_TRUE(isCompleteWith("right"));
  burst_.noteAnswer();
  EXPECT_FALSE(isCompleteWith("right"));
  EXPECT_TRUE(isCompleteWith("left"));
}

TEST_F(BurstTest, DoesNotWaitForWhatMovesNowAndThen) {
  hearOfBothTwice();
  burst_.noteMove("camera");
  burst_.noteMove("left");
  EXPECT_TRUE(isCompleteWith("right"));
  burst_.noteAnswer();
  EXPECT_FALSE(isCompleteWith("left"));
  EXPECT_TRUE(isCompleteWith("right"));
}

TEST_F(BurstTest, IsNotTakenForWholeWhereTheLastOnesWereTornApart) {
  hearOfBothTwice();
  burst_.noteMove("left");
  burst_.noteAnswer();
  burst_.noteMove("right");
  burst_.noteAnswer();
  EXPECT_FALSE(isCompleteWith("left"));
  EXPECT_FALSE(isCompleteWith("right"));
}

TEST_F(BurstTest, ForgetsWhatMovesNoMore) {
  const std::size_t before = test::allocatedMemory();
  for (int i = 0; i < 10'000; ++i) {
    burst_.noteMove("object_" + std::to_string(i));
    burst_.noteAnswer();
  }
  EXPECT_LT(test::allocatedMemory(), before + 10'000);
}

}  // namespace
}  // namespace organ_collision::node
