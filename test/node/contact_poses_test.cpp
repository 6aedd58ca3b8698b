// What contacts make of poses: late, old, ahead of the clock, lost, of other frames.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "node/contact_cycle_fixture.h"

namespace organ_collision::node {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using ContactPosesTest = ContactCycleTest;

TEST_F(ContactPosesTest, HasNoStampThatIsStillToCome) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(3600.0));
  place("liver", "right_tip", {0.5, 0.5, 3.0}, ros::Time(3600.0));
  contacts(ros::Time(3600.0));
  buffer_.clear();  // time jumps back, and one tip returns
  place("world", "liver", {10, 0, 0}, ros::Time(0), true);
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(10.0));
  const ContactArray array = contacts(ros::Time(10.01));
  EXPECT_EQ(array.contacts[0].status, Contact::OK);
  EXPECT_EQ(array.contacts[1].status, Contact::STALE);
  EXPECT_EQ(array.contacts[1].stamp, ros::Time(3600.0));
  EXPECT_EQ(array.header.stamp, ros::Time(10.0));
}

TEST_F(ContactPosesTest, SaysNoPoseAndInfinityUntilTheFrameIsThere) {
  const Contact contact = contacts(ros::Time(1.0)).contacts[0];
  EXPECT_EQ(contact.status, Contact::NO_POSE);
  EXPECT_EQ(contact.nearest.distance, kInfinity);
  EXPECT_EQ(contact.nearest.upper_bound, kInfinity);
  EXPECT_EQ(contact.nearest.lower_bound, 0.0);
  EXPECT_FALSE(contact.colliding);
  EXPECT_FALSE(contact.colliding_certain);
  ASSERT_EQ(cycle_.complaints(ros::Time(1.0)).size(), 2U);
  EXPECT_NE(cycle_.complaints(ros::Time(1.0))[0].reason.find("left_tip"), std::string::npos);
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(1.0));
  EXPECT_EQ(contacts(ros::Time(1.01)).contacts[0].status, Contact::OK);
}

TEST_F(ContactPosesTest, RepeatsAnOldPosesAnswerAsStaleWithItsAge) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  EXPECT_EQ(contacts(ros::Time(100.09)).contacts[0].status, Contact::OK);
  const Contact stale = contacts(ros::Time(100.5)).contacts[0];
  EXPECT_EQ(stale.status, Contact::STALE);
  EXPECT_EQ(stale.nearest.distance, 2.0);
  EXPECT_EQ(stale.age.toSec(), 0.5);
}

TEST_F(ContactPosesTest, ComplainsOfTheFrameThatTfTellsNoMoreOf) {
  const auto complaint = [this](const ros::Time& now) {
    contacts(now);
    return cycle_.complaints(now)[0].reason;
  };
  place("world", "arm", {10, 0, 0}, ros::Time(100.0));
  place("arm", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  place("arm", "left_tip", {0.5, 0.5, 3.0}, ros::Time(105.0));
  EXPECT_EQ(complaint(ros::Time(105.0)),
            "the last pose is 5.000000 s old: of a later time tf has not told where 'arm' is");
  place("world", "arm", {10, 0, 0}, ros::Time(106.0));
  EXPECT_EQ(complaint(ros::Time(107.0)),
            "the last pose is 2.000000 s old: of a later time tf has not told where 'left_tip' is");
}

TEST_F(ContactPosesTest, AStaticTipThatIsTakenElsewhereIsNews) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(0), true);
  EXPECT_TRUE(cycle_.lookUpTips());
  EXPECT_FALSE(cycle_.lookUpTips());
  place("liver", "left_tip", {0.5, 0.5, 4.0}, ros::Time(0), true);
  EXPECT_TRUE(cycle_.lookUpTips());
}

TEST_F(ContactPosesTest, AStaticTipIsNewsWhenItMovesInTheScene) {
  scene_.frame = "room";
  ContactCycle cycle(scene_, instruments_, organs_, buffer_);
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(0), true);
  EXPECT_TRUE(cycle.lookUpTips());
  place("room", "world", {1, 0, 0}, ros::Time(100.0));
  EXPECT_TRUE(cycle.lookUpTips());  // its pose is known now
  EXPECT_FALSE(cycle.lookUpTips());
  place("room", "world", {2, 0, 0}, ros::Time(100.1));
  EXPECT_TRUE(cycle.lookUpTips());
  EXPECT_EQ(cycle.contacts(ros::Time(100.1), {}).contacts[0].instrument_point.x, 12.5);
}

TEST_F(ContactPosesTest, IsStaleAtOnceWhenTfForgetsTheTip) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  contacts(ros::Time(100.01));
  buffer_.clear();  // what tf's listener does when time jumps back
  const Contact stale = contacts(ros::Time(50.0)).contacts[0];
  EXPECT_EQ(stale.status, Contact::STALE);
  EXPECT_EQ(stale.nearest.distance, 2.0);
  place("world", "liver", {10, 0, 0}, ros::Time(0), true);
  place("liver", "left_tip", {0.5, 0.5, 2.0}, ros::Time(50.0));
  const Contact recovered = contacts(ros::Time(50.01)).contacts[0];
  EXPECT_EQ(recovered.status, Contact::OK);
  EXPECT_EQ(recovered.nearest.distance, 1.0);
}

TEST_F(ContactPosesTest, APoseAheadOfTheClockIsStale) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  EXPECT_EQ(contacts(ros::Time(99.95)).contacts[0].status, Contact::OK);  // clocks differ a little
  const Contact ahead = contacts(ros::Time(50.0)).contacts[0];            // the clock was set back
  EXPECT_EQ(ahead.status, Contact::STALE);
  EXPECT_EQ(ahead.age.toSec(), -50.0);
  EXPECT_NE(cycle_.complaints(ros::Time(50.0))[0].reason.find("ahead of the clock"),
            std::string::npos);
}

TEST_F(ContactPosesTest, NoAgeIsTooLargeForIt) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(1.0));
  for (const ros::Time& now : {ros::Time(0.0), ros::Time(4e9)}) {
    const Contact contact = contacts(now).contacts[0];
    EXPECT_EQ(contact.status, Contact::STALE);
    EXPECT_EQ(contact.nearest.distance, 2.0);
  }
  EXPECT_EQ(contacts(ros::Time(4e9)).contacts[0].age, ros::DURATION_MAX);
}

TEST_F(ContactPosesTest, APoseAtInfinityOrNearlyThereIsNoPose) {
  ros::Time now(100.0);
  for (const double at : {kInfinity, -kInfinity, 1e200, 1e9, -1e9}) {
    now += ros::Duration(0.01);
    place("liver", "left_tip", {0.5, at, 3.0}, now);
    const Contact contact = contacts(now).contacts[0];
    EXPECT_EQ(contact.status, Contact::NO_POSE);
    EXPECT_FALSE(contact.colliding);
    EXPECT_NE(cycle_.complaints(now)[0].reason.find("left_tip"), std::string::npos);
  }
}

TEST_F(ContactPosesTest, ComplainsOfAnOldPoseOfTheScenesFrame) {
  scene_.frame = "camera";
  ContactCycle cycle(scene_, instruments_, organs_, buffer_);
  place("world", "camera", {0, 0, 5}, ros::Time(100.0));
  for (const char* const tip : {"left_tip", "right_tip"})
    place("liver", tip, {0.5, 0.5, 3.0}, ros::Time(100.5));
  cycle.lookUpTips();
  const Contact stale = cycle.contacts(ros::Time(100.5), {}).contacts[0];
  EXPECT_EQ(stale.status, Contact::STALE);
  EXPECT_EQ(stale.age.toSec(), 0.0) << "of the tip's pose";
  const auto complaints = cycle.complaints(ros::Time(100.5));
  ASSERT_EQ(complaints.size(), 2U);
  EXPECT_NE(complaints[0].reason.find("the scene's frame is 0.5"), std::string::npos);
  place("world", "camera", {0, 0, 5}, ros::Time(100.5));
  cycle.lookUpTips();
  EXPECT_TRUE(cycle.complaints(ros::Time(100.5)).empty());
  EXPECT_EQ(cycle.contacts(ros::Time(100.5), {}).contacts[0].status, Contact::OK);
}

TEST_F(ContactPosesTest, ThatAreStaleStayWhereTheyWereWhateverMovesOn) {
  scene_.frame = "camera";
  ContactCycle cycle(scene_, instruments_, organs_, buffer_);
  const auto whereAt = [&cycle](double now) {
    cycle.lookUpTips();
    const Contact contact = cycle.contacts(ros::Time(now), {}).contacts[0];
    EXPECT_EQ(contact.stamp, ros::Time(100.0));
    return std::array{contact.nearest.point.x, contact.instrument_point.x};
  };
  const std::array there = {10.5, 10.5};
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  place("world", "camera", {0, 0, 0}, ros::Time(100.0));
  EXPECT_EQ(whereAt(100.0), there);
  for (const double now : {100.5, 105.0, 120.0}) {  // tf forgets what is older than ten seconds
    place("world", "camera", {now, 0, 0}, ros::Time(now));
    EXPECT_EQ(whereAt(now), there);
  }
  buffer_.clear();
  place("world", "camera", {130, 0, 0}, ros::Time(130.0));
  place("world", "liver", {20, 0, 0}, ros::Time(130.0));
  EXPECT_EQ(whereAt(130.0), there);
}

TEST_F(ContactPosesTest, AStaticTipIsNeverStale) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(5.0), true);
  const Contact contact = contacts(ros::Time(1e6)).contacts[0];
  EXPECT_EQ(contact.status, Contact::OK);
  EXPECT_TRUE(contact.stamp.isZero());
  EXPECT_TRUE(contact.age.isZero());
}

TEST_F(ContactPosesTest, AStaticTipThatTfLosesIsStale) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(0), true);
  EXPECT_EQ(contacts(ros::Time(100.0)).contacts[0].status, Contact::OK);
  place("liver", "left_tip", {0.5, 1e9, 3.0}, ros::Time(0), true);
  const Contact stale = contacts(ros::Time(100.0)).contacts[0];
  EXPECT_EQ(stale.status, Contact::STALE);
  EXPECT_EQ(stale.nearest.distance, 2.0);
}

TEST_F(ContactPosesTest, WithoutAWayToTheScenesFrameThereIsNoPose) {
  scene_.frame = "nowhere";
  ContactCycle cycle(scene_, instruments_, organs_, buffer_);
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  cycle.lookUpTips();
  EXPECT_EQ(cycle.contacts(ros::Time(100.0), {}).contacts[0].status, Contact::NO_POSE);
  EXPECT_NE(cycle.complaints(ros::Time(100.0))[0].reason.find("nowhere"), std::string::npos);
}

TEST_F(ContactPosesTest, NamesTheOrgansFrameWhereThatIsTheOneToldNoMore) {
  organs_[0] = std::make_unique<Organ>("liver", "bowel", test::cube());
  ContactCycle cycle(scene_, instruments_, organs_, buffer_);
  place("world", "bowel", {10, 0, 0}, ros::Time(100.0));
  for (const double now : {100.0, 105.0})
    place("world", "left_tip", {10.5, 0.5, 3.0}, ros::Time(now));
  cycle.lookUpTips();
  EXPECT_EQ(cycle.complaints(ros::Time(105.0))[0].reason,
            "the last pose is 5.000000 s old: of a later time tf has not told where 'bowel' is");
}

TEST_F(ContactPosesTest, HasTheStampOfATipWhoseClockIsALittleAhead) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  EXPECT_EQ(contacts(ros::Time(99.95)).header.stamp, ros::Time(100.0));
}

TEST_F(ContactPosesTest, HasNewsWhenTheScenesFrameIsThereAndWhereverThatIsLate) {
  scene_.frame = "camera";
  ContactCycle cycle(scene_, instruments_, organs_, buffer_);
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  EXPECT_TRUE(cycle.lookUpTips());
  EXPECT_FALSE(cycle.lookUpTips());
  place("world", "camera", {0, 0, 5}, ros::Time(100.0));
  EXPECT_TRUE(cycle.lookUpTips()) << "both are known now";
  EXPECT_FALSE(cycle.lookUpTips());
  place("liver", "left_tip", {0.5, 0.5, 2.0}, ros::Time(100.1));
  EXPECT_TRUE(cycle.lookUpTips()) << "though tf does not know the camera of then";
  EXPECT_EQ(cycle.contacts(ros::Time(100.1), {}).contacts[0].nearest.distance, 1.0);
}

TEST_F(ContactPosesTest, ComplainOfNoFrameInWordsThatATerminalWouldObey) {
  place("world", "bow\x1b[2Jel", {10, 0, 0}, ros::Time(100.0));
  for (const double now : {100.0, 105.0})
    place("bow\x1b[2Jel", "left_tip", {0.5, 0.5, 3.0}, ros::Time(now));
  instruments_[1].frame = "ti\np";
  ContactCycle cycle(scene_, instruments_, organs_, buffer_);
  cycle.lookUpTips();
  const auto complaints = cycle.complaints(ros::Time(105.0));
  ASSERT_EQ(complaints.size(), 2U);
  EXPECT_NE(complaints[0].reason.find("where 'bow?[2Jel' is"), std::string::npos);
  EXPECT_EQ(complaints[1].reason, "tf knows no frame 'ti p'");
}

}  // namespace
}  // namespace organ_collision::node
