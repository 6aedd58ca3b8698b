#include "node/cycle_pace.h"

#include <gtest/gtest.h>

namespace organ_collision::node {
namespace {

const ros::SteadyTime kStart(100.0);

ros::SteadyTime after(double seconds) { return kStart + ros::WallDuration(seconds); }

/// How many cycles the rate allows at once.
int cyclesAt(CyclePace& pace, ros::SteadyTime now) {
  int cycles = 0;
  for (; pace.allowed() <= now; ++cycles) pace.noteCycle(now);
  return cycles;
}

TEST(CyclePace, AllowsTheRateAndNoMore) {
  CyclePace pace(1000.0, kStart);
  EXPECT_EQ(pace.allowed(), kStart);
  int cycles = 0;
  for (int i = 0; i < 4000; ++i) cycles += cyclesAt(pace, after(0.00025 * i));
  EXPECT_NEAR(cycles, 1000, 1);
}

TEST(CyclePace, MakesUpForATenthOfASecondAndNoMore) {
  CyclePace pace(100.0, kStart);
  EXPECT_EQ(cyclesAt(pace, after(0.055)), 6);
  EXPECT_EQ(cyclesAt(pace, after(10.0)), 11);
  EXPECT_EQ(cyclesAt(pace, after(10.005)), 0);
}

TEST(CyclePace, MakesUpForOneCycleOfASlowRate) {
  CyclePace pace(0.1, kStart);  // slower than the heartbeat, which it does not slow down
  EXPECT_EQ(cyclesAt(pace, after(1.0)), 2);
  EXPECT_EQ(cyclesAt(pace, after(1.1)), 1);
}

TEST(CyclePace, BeatsTenTimesASecondWhereNothingIsNew) {
  CyclePace pace(1000.0, kStart);
  int beats = 0;
  for (int i = 0; i < 1000; ++i) {
    const ros::SteadyTime now = after(0.001 * i);
    if (now < pace.heartbeat()) continue;
    pace.noteCycle(now);
    ++beats;
  }
  EXPECT_EQ(beats, 10);
}

TEST(CyclePace, IsBehindWhenSomethingHasWaitedForAFifthOfASecond) {
  CyclePace pace(1000.0, kStart);
  EXPECT_FALSE(pace.isBehind(after(0.199)));
  EXPECT_TRUE(pace.isBehind(after(0.201)));
  pace.noteCycle(after(0.201));
  EXPECT_TRUE(pace.isBehind(after(0.202)));
  pace.noteCaughtUp(after(0.202));
  EXPECT_FALSE(pace.isBehind(after(0.4)));
}

TEST(CyclePace, LooksByItselfAHundredthOfASecondAfterTheLastAnswerOrAtTheHeartbeat) {
  CyclePace pace(1000.0, kStart);
  for (int i = 0; i < 9; ++i) {  // who answers poses all the time needs no other look
    EXPECT_NEAR((pace.look() - after(0.008 * i)).toSec(), 0.01, 1e-9);
    pace.noteAnswer(after(0.008 * (i + 1)), after(0.008 * (i + 1)));
  }
  pace.noteAnswer(after(0.095), after(0.095));
  EXPECT_EQ(pace.look(), pace.heartbeat());
}

TEST(CyclePace, IsPromptWhereAnswersAreShortAndTheRateAllowsOne) {
  CyclePace pace(100.0, kStart);
  EXPECT_TRUE(pace.isPrompt(kStart));
  pace.noteAnswer(after(1.0), after(1.0004));
  EXPECT_FALSE(pace.isPrompt(after(1.0007)));
  EXPECT_TRUE(pace.isPrompt(after(1.0009)));
  pace.noteAnswer(after(2.0), after(2.0006));
  EXPECT_FALSE(pace.isPrompt(after(3.0)));
  pace.noteAnswer(after(3.0), after(3.0001));
  EXPECT_TRUE(pace.isPrompt(after(4.0)));
  cyclesAt(pace, after(4.0));
  EXPECT_FALSE(pace.isPrompt(after(4.0)));
  EXPECT_TRUE(pace.isPrompt(after(4.02)));
}

}  // namespace
}  // namespace organ_collision::node
