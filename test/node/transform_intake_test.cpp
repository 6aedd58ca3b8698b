#include "node/transform_intake.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "node/frame_lookup.h"

namespace organ_collision::node {
namespace {

using testing::HasSubstr;

class TransformIntakeTest : public testing::Test {
 protected:
  /// Empty if there is none.
  static std::string onlyOf(const std::vector<std::string>& complaints) {
    EXPECT_LE(complaints.size(), 1U);
    return complaints.empty() ? "" : complaints.front();
  }

  /// What is complained of when it is heard at `now` that `child` was at (x, 0, 0) in `parent` at
  /// `stamp`.
  std::string hear(const std::string& child, double x, const ros::Time& stamp, const ros::Time& now,
                   bool is_static = false, const std::string& parent = "liver") {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    geometry_msgs::TransformStamped& transform = message.transforms.front();
    transform.header.frame_id = parent;
    transform.header.stamp = stamp;
    transform.child_frame_id = child;
    transform.transform.translation.x = x;
    transform.transform.rotation.w = 1.0;
    return onlyOf(intake_.take(message, "test", is_static, now));
  }

  bool knows(const std::string& frame) const {
    return buffer_.canTransform("liver", frame, ros::Time(0));
  }

  double latest(const std::string& frame) const {
    return buffer_.lookupTransform("liver", frame, ros::Time(0)).transform.translation.x;
  }

  tf2::BufferCore buffer_;
  TransformIntake intake_{buffer_};
};

TEST_F(TransformIntakeTest, TakesWhatMovesAndWhatDoesNot) {
  EXPECT_EQ(hear("tip", 1.0, ros::Time(100.0), ros::Time(100.01)), "");
  EXPECT_EQ(hear("fixed", 2.0, ros::Time(0), ros::Time(100.02), true), "");
  EXPECT_EQ(latest("tip"), 1.0);
  EXPECT_EQ(latest("fixed"), 2.0);
}

TEST_F(TransformIntakeTest, ForgetsWhatMovesWhenTimeJumpsBackAndGoesOnAtOnce) {
  hear("tip", 1.0, ros::Time(100.0), ros::Time(100.0));
  hear("fixed", 2.0, ros::Time(0), ros::Time(100.0), true);
  EXPECT_THAT(hear("other", 3.0, ros::Time(5.0), ros::Time(5.0)), HasSubstr("jumped back by 95"));
  EXPECT_FALSE(knows("tip"));
  EXPECT_EQ(latest("fixed"), 2.0);
  EXPECT_EQ(latest("other"), 3.0);
  EXPECT_EQ(hear("tip", 4.0, ros::Time(5.1), ros::Time(5.1)), "");
  EXPECT_EQ(latest("tip"), 4.0);
}

TEST_F(TransformIntakeTest, ForgetsWhatMovesWhenTimeJumpsBackThoughTfIsSilent) {
  hear("tip", 1.0, ros::Time(100.0), ros::Time(100.0));
  EXPECT_EQ(intake_.noteTime(ros::Time(100.0)), "");
  EXPECT_EQ(intake_.noteTime(ros::Time(100.2)), "");
  EXPECT_TRUE(knows("tip"));
  EXPECT_THAT(intake_.noteTime(ros::Time(99.9)), HasSubstr("jumped back by 0.3"));
  EXPECT_FALSE(knows("tip"));
  EXPECT_EQ(hear("tip", 2.0, ros::Time(100.0), ros::Time(100.0)), "");
}

TEST_F(TransformIntakeTest, KnowsWhichMessageWouldOvertakeOneWithoutAnAnswer) {
  tf2_msgs::TFMessage next;
  next.transforms.resize(2);
  next.transforms[0].child_frame_id = "other";
  next.transforms[1].child_frame_id = "/tip";
  EXPECT_FALSE(intake_.overtakes(next));
  hear("tip", 1.0, ros::Time(100.0), ros::Time(100.0));
  EXPECT_TRUE(intake_.overtakes(next));
  intake_.noteAnswer();
  EXPECT_FALSE(intake_.overtakes(next));
  hear("third", 1.0, ros::Time(100.0), ros::Time(100.0));
  EXPECT_FALSE(intake_.overtakes(next));
}

TEST_F(TransformIntakeTest, WhatIsRefusedDoesNotStandInTheWayOfWhatIsTrue) {
  EXPECT_THAT(hear("/tip", 1.0, ros::Time(0), ros::Time(100.0), true, "tip"), HasSubstr("itself"));
  EXPECT_EQ(hear("tip", 2.0, ros::Time(100.0), ros::Time(100.0)), "");
  EXPECT_EQ(latest("tip"), 2.0);
}

TEST_F(TransformIntakeTest, WhatTfWouldDropIsRefusedByName) {
  hear("tip", 1.0, ros::Time(100.0), ros::Time(100.0));
  EXPECT_THAT(hear("tip", 2.0, ros::Time(100.0), ros::Time(100.1)),
              AllOf(HasSubstr("'tip'"), HasSubstr("one of that time already")));
  EXPECT_THAT(hear("/tip", 2.0, ros::Time(100.0), ros::Time(100.1)), HasSubstr("already"));
  EXPECT_THAT(hear("tip", 2.0, ros::Time(89.9), ros::Time(100.1)), HasSubstr("older than what tf"));
  EXPECT_EQ(hear("tip", 2.0, ros::Time(99.0), ros::Time(100.1)), "");  // late, but of use
  EXPECT_THAT(hear("tip", 2.0, ros::Time(89.9), ros::Time(100.1)), HasSubstr("older than what tf"));
  EXPECT_THAT(hear("tip", 3.0, ros::Time(99.0), ros::Time(100.1)), HasSubstr("already"));
  EXPECT_EQ(latest("tip"), 1.0);
  EXPECT_EQ(hear("tip", 3.0, ros::Time(100.1), ros::Time(100.1)), "");
  EXPECT_EQ(latest("tip"), 3.0);
  hear("tip", 4.0, ros::Time(5.0), ros::Time(5.0));  // time jumped back
  EXPECT_EQ(hear("tip", 5.0, ros::Time(100.1), ros::Time(100.1)), "");
}

TEST_F(TransformIntakeTest, OneTransformFromTheFutureDoesNotShutOutTheTrueOnes) {
  hear("tip", 1.0, ros::Time(100.0), ros::Time(100.0));
  const double late = 100.0 + 60.0;
  EXPECT_THAT(hear("tip", 9.0, ros::Time(late), ros::Time(100.0)),
              AllOf(HasSubstr("'tip'"), HasSubstr("60")));
  hear("tip", 2.0, ros::Time(100.1), ros::Time(100.1));
  EXPECT_EQ(latest("tip"), 2.0);
}

TEST_F(TransformIntakeTest, WhatWasSentBeforeAResetAndComesAfterItIsRefused) {
  hear("tip", 1.0, ros::Time(100.0), ros::Time(100.0));
  hear("other", 1.0, ros::Time(0.1), ros::Time(0.1));
  EXPECT_NE(hear("tip", 9.0, ros::Time(100.1), ros::Time(0.2)), "");
  EXPECT_FALSE(knows("tip"));
  hear("tip", 2.0, ros::Time(0.3), ros::Time(0.3));
  EXPECT_EQ(latest("tip"), 2.0);
}

TEST_F(TransformIntakeTest, WhatMovesMustSayWhen) {
  EXPECT_THAT(hear("tip", 1.0, ros::Time(0), ros::Time(100.0)), HasSubstr("'tip'"));
  EXPECT_FALSE(knows("tip"));
  EXPECT_EQ(hear("tip", 2.0, ros::Time(100.0), ros::Time(100.0)), "");
  EXPECT_EQ(latest("tip"), 2.0);
}

TEST_F(TransformIntakeTest, ARotationThatIsRoundedScalesNothing) {
  for (const double part : {0.71, 0.7071}) {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    geometry_msgs::TransformStamped& transform = message.transforms.front();
    transform.header.frame_id = "liver";
    transform.child_frame_id = "rounded";
    transform.transform.rotation.z = part;
    transform.transform.rotation.w = part;
    EXPECT_EQ(onlyOf(intake_.take(message, "test", true, ros::Time(1.0))), "");
    const auto pose = lookUpFrame(buffer_, "liver", "rounded").pose;
    ASSERT_TRUE(pose);
    EXPECT_NEAR((pose->target_from_source * Eigen::Vector3d(0.3, 0.0, 0.0)).norm(), 0.3, 1e-15);
  }
}

TEST_F(TransformIntakeTest, WhatIsNoTransformIsRefusedByName) {
  const auto refusal = [this](const auto& spoil) {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    geometry_msgs::TransformStamped& transform = message.transforms.front();
    transform.header.frame_id = "liver";
    transform.header.stamp = ros::Time(1.0);
    transform.child_frame_id = "tip";
    transform.transform.rotation.w = 1.0;
    spoil(transform);
    return onlyOf(intake_.take(message, "/arm", false, ros::Time(1.0)));
  };
  using Transform = geometry_msgs::TransformStamped;
  EXPECT_EQ(
      refusal([](Transform& t) { t.transform.rotation.w = 0.0; }),
      "refused where '/arm' says that 'tip' is in 'liver': its rotation (0, 0, 0, 0) is not of "
      "length 1");
  for (const double w : {0.994, 1.006})
    EXPECT_THAT(refusal([w](Transform& t) { t.transform.rotation.w = w; }),
                HasSubstr("is not of length 1"));
  EXPECT_THAT(refusal([](Transform& t) { t.transform.rotation.x = 2.0; }),
              HasSubstr("(2, 0, 0, 1)"));
  EXPECT_THAT(refusal([](Transform& t) { t.transform.translation.y = std::nan(""); }),
              HasSubstr("not finite"));
  EXPECT_THAT(refusal([](Transform& t) { t.transform.translation.z = std::nan(""); }),
              HasSubstr("not finite"));
  EXPECT_THAT(refusal([](Transform& t) { t.child_frame_id = "liver"; }), HasSubstr("itself"));
  EXPECT_THAT(refusal([](Transform& t) { t.header.frame_id = "/tip"; }), HasSubstr("itself"));
  EXPECT_THAT(refusal([](Transform& t) { t.child_frame_id = "/liver"; }), HasSubstr("itself"));
  EXPECT_THAT(refusal([](Transform& t) { t.header.frame_id = ""; }), HasSubstr("no name"));
  EXPECT_THAT(refusal([](Transform& t) { t.child_frame_id = "/"; }), HasSubstr("no name"));
  EXPECT_FALSE(knows("tip"));
  EXPECT_EQ(refusal([](Transform&) {}), "");
  EXPECT_TRUE(knows("tip"));
}

TEST_F(TransformIntakeTest, WhatIsRefusedTakesNothingElseOfItsMessageWithIt) {
  tf2_msgs::TFMessage message;
  for (const char* const child : {"first", "bad", "last"}) {
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = "liver";
    transform.header.stamp = ros::Time(1.0);
    transform.child_frame_id = child;
    transform.transform.rotation.w = child == std::string("bad") ? 0.0 : 1.0;
    message.transforms.push_back(transform);
  }
  EXPECT_THAT(onlyOf(intake_.take(message, "test", false, ros::Time(1.0))), HasSubstr("'bad'"));
  EXPECT_TRUE(knows("first"));
  EXPECT_FALSE(knows("bad"));
  EXPECT_TRUE(knows("last"));
}

TEST_F(TransformIntakeTest, TellsAllThatThereIsToComplainOf) {
  hear("tip", 1.0, ros::Time(100.0), ros::Time(100.0));
  tf2_msgs::TFMessage message;
  for (const char* const child : {"first", "second"}) {
    message.transforms.emplace_back();  // rotated by nothing
    message.transforms.back().header.frame_id = "liver";
    message.transforms.back().header.stamp = ros::Time(1.0);
    message.transforms.back().child_frame_id = child;
  }
  EXPECT_THAT(
      intake_.take(message, "test", false, ros::Time(1.0)),
      testing::ElementsAre(HasSubstr("jumped back"), HasSubstr("'first'"), HasSubstr("'second'")));
}

/// tf2 would keep calling the first one static, and so never old.
TEST_F(TransformIntakeTest, AFrameIsStaticOrMovesButNotBoth) {
  hear("fixed", 1.0, ros::Time(0), ros::Time(100.0), true);
  EXPECT_THAT(hear("fixed", 2.0, ros::Time(100.0), ros::Time(100.0)),
              HasSubstr("it was on /tf_static before"));
  EXPECT_THAT(hear("/fixed", 2.0, ros::Time(100.0), ros::Time(100.0)), HasSubstr("/tf_static"));
  EXPECT_EQ(latest("fixed"), 1.0);
  EXPECT_EQ(hear("fixed", 3.0, ros::Time(0), ros::Time(100.0), true), "");
  hear("tip", 1.0, ros::Time(100.0), ros::Time(100.0));
  EXPECT_THAT(hear("tip", 2.0, ros::Time(0), ros::Time(100.1), true),
              HasSubstr("it was on /tf before"));
  EXPECT_EQ(hear("tip", 3.0, ros::Time(100.1), ros::Time(100.1)), "");
  EXPECT_EQ(latest("tip"), 3.0);
}

TEST_F(TransformIntakeTest, TimesThatAreTooFarApartForTfAreNoPose) {
  hear("tip", 1.0, ros::Time(1.0), ros::Time(1.0));
  EXPECT_NE(lookUpFrame(buffer_, "liver", "tip", ros::TIME_MAX).reason, "");
}

TEST_F(TransformIntakeTest, AFrameThatNobodyToldOfIsNamed) {
  hear("tip", 1.0, ros::Time(1.0), ros::Time(1.0));
  EXPECT_EQ(lookUpFrame(buffer_, "tip", "probe").reason, "tf knows no frame 'probe'");
  EXPECT_EQ(lookUpFrame(buffer_, "lever", "tip").reason, "tf knows no frame 'lever'");
}

TEST_F(TransformIntakeTest, ALoopIsToldInOneLine) {
  hear("fixed", 1.0, ros::Time(0), ros::Time(100.0), true);
  hear("tip", 1.0, ros::Time(100.0), ros::Time(100.0), false, "arm");
  geometry_msgs::TransformStamped back;  // not by the intake
  back.header.frame_id = "tip";
  back.header.stamp = ros::Time(100.0);
  back.child_frame_id = "arm";
  back.transform.rotation.w = 1.0;
  buffer_.setTransform(back, "test");
  const std::string reason = lookUpFrame(buffer_, "fixed", "tip").reason;
  EXPECT_THAT(reason, AllOf(HasSubstr("loop"), Not(HasSubstr("\n"))));
}

TEST_F(TransformIntakeTest, WhatWouldCloseALoopIsRefusedByName) {
  hear("arm", 1.0, ros::Time(100.0), ros::Time(100.0), false, "base");
  hear("tip", 2.0, ros::Time(100.0), ros::Time(100.0), false, "arm");
  for (const char* const parent : {"arm", "tip"}) {
    EXPECT_EQ(hear("base", 3.0, ros::Time(100.1), ros::Time(100.1), false, parent),
              "refused where 'test' says that 'base' is in '" + std::string(parent) +
                  "': that would close a loop: '" + parent +
                  "' is in 'base', as it was told before; if that was a mistake, start this node "
                  "anew");
  }
  EXPECT_EQ(hear("base", 1.0, ros::Time(100.1), ros::Time(100.1)), "");
  EXPECT_EQ(hear("arm", 1.0, ros::Time(100.1), ros::Time(100.1), false, "base"), "");
  EXPECT_EQ(hear("tip", 2.0, ros::Time(100.1), ros::Time(100.1), false, "arm"), "");
  EXPECT_EQ(latest("tip"), 4.0);
  hear("fixed", 1.0, ros::Time(0), ros::Time(100.1), true, "tip");
  // Once it is in another, or forgotten, its former parent may be in it.
  EXPECT_EQ(hear("arm", 1.0, ros::Time(100.2), ros::Time(100.2), false, "liver"), "");
  EXPECT_EQ(hear("base", 3.0, ros::Time(100.2), ros::Time(100.2), false, "tip"), "");
  EXPECT_THAT(hear("liver", 1.0, ros::Time(5.0), ros::Time(5.0), false, "fixed"),
              HasSubstr("jumped back"));
  EXPECT_THAT(hear("tip", 1.0, ros::Time(5.0), ros::Time(5.0), false, "fixed"), HasSubstr("loop"));
}

TEST_F(TransformIntakeTest, AStaticTransformMayHaveBeenSentAtAnyTime) {
  for (const ros::Time& stamp : {ros::Time(1.0), ros::Time(1e6), ros::TIME_MAX}) {
    EXPECT_EQ(hear("fixed", stamp.toSec(), stamp, ros::Time(100.0), true), "");
    EXPECT_EQ(latest("fixed"), stamp.toSec());
  }
}

TEST_F(TransformIntakeTest, ClocksMayDifferALittle) {
  const double ahead = 0.9 * TransformIntake::kFarthestAhead;
  EXPECT_EQ(hear("tip", 1.0, ros::Time(100.0 + ahead), ros::Time(100.0)), "");
  EXPECT_EQ(latest("tip"), 1.0);
}

TEST_F(TransformIntakeTest, NothingThatTfSaysThrows) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ros::Time now(100.0);
  for (const ros::Time& stamp : {ros::Time(0.0), ros::Time(100.0), ros::TIME_MAX}) {
    for (const bool is_static : {false, true}) {
      EXPECT_NO_THROW(hear("", 1.0, stamp, now, is_static));
      EXPECT_NO_THROW(hear("liver", 1.0, stamp, now, is_static));  // its own parent
      EXPECT_NO_THROW(hear("tip", nan, stamp, now, is_static));
      EXPECT_NO_THROW(hear("tip", 1.0, stamp, now, is_static, ""));
      EXPECT_NO_THROW(hear("/tip", 1.0, stamp, now, is_static, "/liver"));
      EXPECT_NO_THROW(hear("tip", 1.0, stamp, now, is_static));
    }
  }
}

}  // namespace
}  // namespace organ_collision::node
