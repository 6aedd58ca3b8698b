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

TEST(CyclePace, AllowsTheRateAndAHundredthMore) {
  CyclePace pace(1000.0, kStart);
  EXPECT_EQ(pace.allowed(), kStart);
  int cycles = 0;
  for (int i = 0; i < 4000; ++i) cycles += cyclesAt(pace, after(0.00025 * i));
  EXPECT_NEAR(cycles, 1010, 1);  // a hundredth more, for clocks that differ
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
    EXPECT_NEAR((pace.due() - after(0.008 * i)).toSec(), 0.01, 1e-9);
    pace.noteAnswer(after(0.008 * (i + 1)), after(0.008 * (i + 1)));
  }
  pace.noteAnswer(after(0.095), after(0.095));
  EXPECT_EQ(pace.due(), pace.heartbeat());
}

TEST(CyclePace, OwesAMessageAnAnswerAsSoonAsTheRateAllows) {
  CyclePace pace(100.0, kStart);
  pace.noteMessage(after(0.001));
  EXPECT_EQ(pace.due(), pace.allowed());
  EXPECT_LE(pace.due(), after(0.001));
  cyclesAt(pace, after(0.001));
  pace.noteMessage(after(0.002));
  EXPECT_EQ(pace.due(), pace.allowed());
  EXPECT_GT(pace.due(), after(0.002));
  EXPECT_FALSE(pace.isGathering());  // too many cycles, but not too many messages
}

class CrowdedPace : public testing::Test {
 protected:
  /// Eight messages each millisecond, 20 us after one another, for a second; answered when it is
  /// due, at most 10 us late. Returns how many of the last hundred bursts were answered whole, by
  /// one answer before the next burst.
  int burstsAnsweredWhole() {
    int whole = 0;
    for (int burst = 0; burst < 1000; ++burst) {
      int heard = 0, answers = 0, answered_last = 0;
      for (int tick = 0; tick < 100; ++tick) {  // of 10 us
        const ros::SteadyTime now = after(0.001 * burst + 0.00001 * tick);
        if (tick % 2 == 0 && tick < 16) {
          pace_.noteMessage(now);
          ++heard;
        }
        if (now < pace_.due()) continue;
        if (pace_.isPrompt(now)) ++prompt_;
        pace_.noteCycle(now);
        pace_.noteAnswer(now, now);
        ++answers;
        answered_last = heard;
      }
      whole += burst >= 900 && answers == 1 && answered_last == 8 ? 1 : 0;
    }
    return whole;
  }

  CyclePace pace_{1000.0, kStart};
  int prompt_ = 0;
};

TEST_F(CrowdedPace, AnswersWhatComesTogetherTogether) {
  EXPECT_EQ(burstsAnsweredWhole(), 100);
  EXPECT_LT(prompt_, 200);  // while the rate had room for an answer to each
}

TEST_F(CrowdedPace, EndsWithTheCrowd) {
  burstsAnsweredWhole();
  pace_.noteMessage(after(1.0));
  EXPECT_TRUE(pace_.isGathering());
  EXPECT_FALSE(pace_.isPrompt(after(1.0005)));
  pace_.noteAnswer(after(1.0005), after(1.0005));
  for (int i = 0; i < 50; ++i) {
    pace_.noteMessage(after(1.1 + 0.005 * i));
    pace_.noteAnswer(after(1.1 + 0.005 * i), after(1.1 + 0.005 * i));
  }
  EXPECT_TRUE(pace_.isPrompt(after(1.4)));
}

TEST_F(CrowdedPace, WaitsNoLongerThanACycle) {
  burstsAnsweredWhole();
  for (int i = 0; i <= 10; ++i) pace_.noteMessage(after(1.0 + 0.00009 * i));  // never quiet
  EXPECT_TRUE(pace_.isGathering());
  EXPECT_NEAR((pace_.due() - after(1.0)).toSec(), 0.00099, 0.00002);
}

TEST_F(CrowdedPace, WaitsForTheRestHalfACycleAndHalfAMillisecondAtMost) {
  burstsAnsweredWhole();
  pace_.noteMessage(after(1.0));
  pace_.noteMessage(after(1.0001));
  EXPECT_NEAR((pace_.due() - after(1.0001)).toSec(), 0.5 / 1010.0, 1e-6);
  CyclePace slow(100.0, kStart);
  for (int i = 0; i < 300; ++i) {
    slow.noteMessage(after(0.001 * i));
    cyclesAt(slow, after(0.001 * i));
  }
  slow.noteAnswer(after(0.299), after(0.299));
  slow.noteMessage(after(0.35));  // the rate allows an answer
  ASSERT_TRUE(slow.isGathering());
  EXPECT_NEAR((slow.due() - after(0.35)).toSec(), 0.0005, 1e-6);
}

TEST_F(CrowdedPace, AnswersWhatIsCompleteAtOnce) {
  burstsAnsweredWhole();
  pace_.noteMessage(after(1.0));
  EXPECT_GT(pace_.due(), after(1.0));
  EXPECT_FALSE(pace_.isPrompt(after(1.0)));
  pace_.noteComplete();
  EXPECT_LE(pace_.due(), after(1.0));
  EXPECT_TRUE(pace_.isPrompt(after(1.0)));
  EXPECT_FALSE(pace_.isGathering());
  EXPECT_TRUE(pace_.hasRoomBetween(after(1.0045)));  // should the next ones come before
  pace_.noteAnswer(after(1.0), after(1.0));
  pace_.noteMessage(after(1.001));
  EXPECT_GT(pace_.due(), after(1.001));
  EXPECT_TRUE(pace_.isGathering());
}

TEST_F(CrowdedPace, HasRoomBetweenWhereTheRateAllowsTwoAndAnswersAreShort) {
  burstsAnsweredWhole();
  cyclesAt(pace_, after(1.0));
  pace_.noteMessage(after(1.0));
  EXPECT_FALSE(pace_.hasRoomBetween(after(1.0005)));
  EXPECT_TRUE(pace_.hasRoomBetween(after(1.0045)));
  const auto has_room_after_a_long_answer = [&](double began) {
    pace_.noteCycle(after(began));
    pace_.noteAnswer(after(began), after(began + 0.0006));
    pace_.noteMessage(after(began + 0.001));
    return pace_.hasRoomBetween(after(began + 0.01));
  };
  EXPECT_TRUE(has_room_after_a_long_answer(1.0045));  // the machine may have stalled
  EXPECT_FALSE(has_room_after_a_long_answer(1.0145));
}

TEST(CyclePace, IsPromptWhereAnswersAreShortAndTheRateAllowsOne) {
  CyclePace pace(100.0, kStart);
  const auto answer = [&pace](double began, double length) {
    pace.noteCycle(after(began));
    pace.noteAnswer(after(began), after(began + length));
  };
  EXPECT_TRUE(pace.isPrompt(kStart));
  answer(1.0, 0.0004);
  EXPECT_FALSE(pace.isPrompt(after(1.0007)));
  EXPECT_TRUE(pace.isPrompt(after(1.0009)));
  answer(2.0, 0.0006);
  EXPECT_TRUE(pace.isPrompt(after(2.01)));  // the machine may have stalled
  answer(2.1, 0.0006);
  EXPECT_FALSE(pace.isPrompt(after(3.0)));
  pace.noteAnswer(after(3.0), after(3.00001));  // a look without a cycle
  EXPECT_FALSE(pace.isPrompt(after(3.1)));
  answer(3.2, 0.0001);
  EXPECT_TRUE(pace.isPrompt(after(4.0)));
  cyclesAt(pace, after(4.0));
  EXPECT_FALSE(pace.isPrompt(after(4.0)));
  EXPECT_TRUE(pace.isPrompt(after(4.02)));
}

TEST(CyclePace, IsNotCrowdedByMessagesWithoutNews) {
  CyclePace pace(1000.0, kStart);
  for (int i = 0; i < 4000; ++i) {
    const ros::SteadyTime now = after(0.00025 * i);
    pace.noteMessage(now);
    ASSERT_FALSE(pace.isGathering()) << i;
    ASSERT_TRUE(pace.isPrompt(now)) << i;
    pace.noteAnswer(now, now);  // a look without a cycle
  }
}

}  // namespace
}  // namespace organ_collision::node
