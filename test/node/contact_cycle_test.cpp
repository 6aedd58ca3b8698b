#include "node/contact_cycle.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <thread>

#include "node/cube_organ.h"
#include "node/frames.h"
#include "node/moves.h"
#include "test_meshes.h"

namespace organ_collision::node {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A unit cube in frame `liver` and two point tips, without a master.
class ContactCycleTest : public testing::Test {
 protected:
  ContactCycleTest() { place("world", "liver", {10, 0, 0}, ros::Time(0), true); }

  void place(const std::string& parent, const std::string& child, const Eigen::Vector3d& at,
             const ros::Time& stamp, bool is_static = false) {
    ASSERT_TRUE(test::place(buffer_, parent, child, at, stamp, is_static));
  }

  ContactArray contacts(const ros::Time& now) {
    cycle_.lookUpTips();
    return cycle_.contacts(now, {});
  }

  static io::Scene twoInstruments() {
    io::Scene scene;
    scene.frame = "world";
    scene.organs = {{"liver", "liver", io::MeshFile{"unused", 1.0}}};
    scene.pairs = {{0, 0}, {1, 0}};
    return scene;
  }

  static Organs oneCube() {
    Organs organs;
    organs.push_back(std::make_unique<Organ>("liver", "liver", test::cube()));
    return organs;
  }

  static Instruments twoPoints() {
    const core::Shapes origin = {Eigen::Vector3d(0, 0, 0)};
    return {{"left", "left_tip", origin}, {"right", "right_tip", origin}};
  }

  io::Scene scene_ = twoInstruments();
  Instruments instruments_ = twoPoints();
  Organs organs_ = oneCube();
  tf2::BufferCore buffer_;
  ContactCycle cycle_{scene_, instruments_, organs_, buffer_};
};

TEST_F(ContactCycleTest, TellsContactsInTheScenesFrameWithTheStampOfTheTip) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  place("world", "right_tip", {10.25, 0.5, 0.5}, ros::Time(100.5));
  const ContactArray array = contacts(ros::Time(100.52));
  ASSERT_EQ(array.contacts.size(), 2U);
  EXPECT_EQ(array.header.frame_id, "world");
  EXPECT_EQ(array.header.stamp, ros::Time(100.5));
  const Contact& left = array.contacts[0];
  EXPECT_EQ(left.instrument, "left");
  EXPECT_EQ(left.organ, "liver");
  EXPECT_EQ(left.stamp, ros::Time(100.0));
  EXPECT_EQ(left.nearest.distance, 2.0);
  EXPECT_EQ(left.nearest.point.x, 10.5);
  EXPECT_EQ(left.nearest.normal.z, 1.0);
  EXPECT_EQ(left.instrument_point.x, 10.5);
  EXPECT_EQ(left.instrument_point.z, 3.0);
  EXPECT_FALSE(left.colliding);
  const Contact& right = array.contacts[1];
  EXPECT_EQ(right.status, Contact::OK);
  EXPECT_NEAR(right.age.toSec(), 0.02, 1e-9);
  EXPECT_EQ(right.nearest.distance, -0.25);
  EXPECT_TRUE(right.colliding);
  EXPECT_TRUE(right.colliding_certain);
}

TEST_F(ContactCycleTest, HasNoStampThatIsStillToCome) {
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

TEST_F(ContactCycleTest, SaysNoPoseAndInfinityUntilTheFrameIsThere) {
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

TEST_F(ContactCycleTest, RepeatsAnOldPosesAnswerAsStaleWithItsAge) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  EXPECT_EQ(contacts(ros::Time(100.09)).contacts[0].status, Contact::OK);
  const Contact stale = contacts(ros::Time(100.5)).contacts[0];
  EXPECT_EQ(stale.status, Contact::STALE);
  EXPECT_EQ(stale.nearest.distance, 2.0);
  EXPECT_EQ(stale.age.toSec(), 0.5);
}

TEST_F(ContactCycleTest, ComplainsOfTheFrameThatTfTellsNoMoreOf) {
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

TEST_F(ContactCycleTest, AStaticTipThatIsTakenElsewhereIsNews) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(0), true);
  EXPECT_TRUE(cycle_.lookUpTips());
  EXPECT_FALSE(cycle_.lookUpTips());
  place("liver", "left_tip", {0.5, 0.5, 4.0}, ros::Time(0), true);
  EXPECT_TRUE(cycle_.lookUpTips());
}

TEST_F(ContactCycleTest, AStaticTipIsNewsWhenItMovesInTheScene) {
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

TEST_F(ContactCycleTest, IsStaleAtOnceWhenTfForgetsTheTip) {
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

TEST_F(ContactCycleTest, APoseAheadOfTheClockIsStale) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  EXPECT_EQ(contacts(ros::Time(99.95)).contacts[0].status, Contact::OK);  // clocks differ a little
  const Contact ahead = contacts(ros::Time(50.0)).contacts[0];            // the clock was set back
  EXPECT_EQ(ahead.status, Contact::STALE);
  EXPECT_EQ(ahead.age.toSec(), -50.0);
  EXPECT_NE(cycle_.complaints(ros::Time(50.0))[0].reason.find("ahead of the clock"),
            std::string::npos);
}

TEST_F(ContactCycleTest, NoAgeIsTooLargeForIt) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(1.0));
  for (const ros::Time& now : {ros::Time(0.0), ros::Time(4e9)}) {
    const Contact contact = contacts(now).contacts[0];
    EXPECT_EQ(contact.status, Contact::STALE);
    EXPECT_EQ(contact.nearest.distance, 2.0);
  }
  EXPECT_EQ(contacts(ros::Time(4e9)).contacts[0].age, ros::DURATION_MAX);
}

TEST_F(ContactCycleTest, APoseAtInfinityOrNearlyThereIsNoPose) {
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

TEST_F(ContactCycleTest, ComplainsOfAnOldPoseOfTheScenesFrame) {
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

TEST_F(ContactCycleTest, ThatAreStaleStayWhereTheyWereWhateverMovesOn) {
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

TEST_F(ContactCycleTest, AStaticTipIsNeverStale) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(5.0), true);
  const Contact contact = contacts(ros::Time(1e6)).contacts[0];
  EXPECT_EQ(contact.status, Contact::OK);
  EXPECT_TRUE(contact.stamp.isZero());
  EXPECT_TRUE(contact.age.isZero());
}

TEST_F(ContactCycleTest, AStaticTipThatTfLosesIsStale) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(0), true);
  EXPECT_EQ(contacts(ros::Time(100.0)).contacts[0].status, Contact::OK);
  place("liver", "left_tip", {0.5, 1e9, 3.0}, ros::Time(0), true);
  const Contact stale = contacts(ros::Time(100.0)).contacts[0];
  EXPECT_EQ(stale.status, Contact::STALE);
  EXPECT_EQ(stale.nearest.distance, 2.0);
}

TEST_F(ContactCycleTest, BeyondTheLargestDistanceTellsTheProvenBoundOnly) {
  scene_.max_distance = 1.0;
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  const Contact contact = contacts(ros::Time(100.0)).contacts[0];
  EXPECT_EQ(contact.status, Contact::OUT_OF_RANGE);
  EXPECT_EQ(contact.nearest.distance, kInfinity);
  EXPECT_EQ(contact.nearest.lower_bound, 2.0);
  EXPECT_FALSE(contact.colliding);
  EXPECT_TRUE(contact.colliding_certain);
}

TEST_F(ContactCycleTest, IsNotOutOfRangeWhereItMayBeDeepInside) {
  organs_[0] =
      std::make_unique<Organ>("liver", "liver", test::placed(test::blob(4), 50.0, {0, 0, 0}));
  scene_.max_distance = 0.1;
  place("liver", "left_tip", {0.5, 0.0, 0.0}, ros::Time(100.0));
  EXPECT_TRUE(contacts(ros::Time(100.0)).contacts[0].colliding);
  std::size_t unsure = 0;
  for (std::uint32_t leaves = 1; leaves < 1000; ++leaves) {
    const Contact contact = cycle_.contacts(ros::Time(100.0), {0, 0, leaves}).contacts[0];
    EXPECT_EQ(contact.status, Contact::OK);
    EXPECT_EQ(contact.colliding, contact.colliding_certain);
    if (!contact.colliding && contact.nearest.lower_bound > scene_.max_distance) ++unsure;
  }
  EXPECT_GT(unsure, 0U) << "these were told to be out of range";
}

TEST_F(ContactCycleTest, IsStaleRatherThanOutOfRange) {
  scene_.max_distance = 1.0;
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  EXPECT_EQ(contacts(ros::Time(100.0)).contacts[0].status, Contact::OUT_OF_RANGE);
  EXPECT_EQ(contacts(ros::Time(100.5)).contacts[0].status, Contact::STALE);
}

TEST_F(ContactCycleTest, IsCulledByBoxesBeforeAnyTriangleIsLookedAt) {
  scene_.max_distance = 1.0;
  instruments_[0].shapes = {core::Sphere{{0, 0, 0}, 0.5}};
  place("liver", "left_tip", {2.5, 2.5, 0.5}, ros::Time(100.0));
  const Contact contact = contacts(ros::Time(100.0)).contacts[0];
  EXPECT_EQ(contact.status, Contact::OUT_OF_RANGE);
  EXPECT_EQ(contact.nearest.lower_bound, std::sqrt(2.0)) << "of the boxes; the sphere is farther";
  EXPECT_TRUE(contact.colliding_certain);
  EXPECT_EQ(contact.instrument_point.x, 12.5);
}

TEST_F(ContactCycleTest, CountsAsAQuestionThatTellsWear) {
  organs_[0] = std::make_unique<Organ>("liver", "liver", test::blob(4));
  organs_[0]->update({{}, crushed(test::blob(4).positions())}, UpdateMode::kRefit, 0);
  place("liver", "left_tip", {0.0, 0.02, 0.2}, ros::Time(100.0));
  for (int i = 0; i < 1024; ++i) contacts(ros::Time(100.0));
  organs_[0]->work();
  EXPECT_NE(organs_[0]->costRatio(), 1.0);
}

TEST_F(ContactCycleTest, CountsAsAQuestionOfTheAccuracyThatItHad) {
  ros::Time now(100.0);
  for (const bool is_greedy : {false, true}) {
    organs_[0] = std::make_unique<Organ>("liver", "liver", test::blob(4));
    organs_[0]->update({{}, crushed(test::blob(4).positions())}, UpdateMode::kRefit, 0);
    for (int i = 0; i < 1024; ++i) {
      now += ros::Duration(0.01);
      place("liver", "left_tip", {0.0, 1e-4 * i, 0.05}, now);
      cycle_.lookUpTips();
      cycle_.contacts(now, is_greedy ? core::Accuracy::greedy() : core::Accuracy::exact());
    }
    organs_[0]->work();
    const std::string figures = organs_[0]->builds().figures;
    EXPECT_EQ(figures.find(", 0 % more answers wrong") == std::string::npos, is_greedy) << figures;
  }
}

TEST_F(ContactCycleTest, AreOfOneVersionOfAnOrganAtATime) {
  std::atomic<bool> done{false};
  std::thread updates([&] {
    while (!done) organs_[0]->update(test::movesOf({7}, {{1, 1, 1}}), UpdateMode::kRefit, 0);
  });
  int mixed = 0;
  while (organs_[0]->snapshot()->version < 1000) {
    const ContactArray array = cycle_.contacts(ros::Time(100.0), {});
    mixed += array.contacts[0].mesh_version != array.contacts[1].mesh_version ? 1 : 0;
  }
  done = true;
  updates.join();
  EXPECT_EQ(mixed, 0);
}

TEST_F(ContactCycleTest, HasNewsOnlyWhenATipOrAnOrganHasMoved) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  EXPECT_TRUE(cycle_.lookUpTips());
  EXPECT_FALSE(cycle_.lookUpTips());
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.1));
  EXPECT_TRUE(cycle_.lookUpTips());
  EXPECT_FALSE(cycle_.lookUpTips());
  organs_[0]->update(test::movesOf({7}, {{1, 1, 2}}), UpdateMode::kAuto, 0);
  EXPECT_TRUE(cycle_.lookUpTips());
}

TEST_F(ContactCycleTest, WithAnOpenOrganDeepWithinAMeshIsACollisionHoweverFarItsSurfaceIs) {
  organs_[0] = std::make_unique<Organ>("liver", "liver", test::grid(1, 1));
  instruments_[0].shapes = {core::RigidMesh{
      std::make_shared<const core::CollisionMesh>(test::placed(test::cube(), 20, {-10, -10, -10})),
      Eigen::Isometry3d::Identity(), false}};
  scene_.max_distance = 1.0;
  place("liver", "left_tip", {0, 0, 0}, ros::Time(100.0));
  const Contact contact = contacts(ros::Time(100.0)).contacts[0];
  EXPECT_EQ(contact.status, Contact::OK);
  EXPECT_TRUE(contact.colliding);
  EXPECT_TRUE(contact.colliding_certain);
  EXPECT_EQ(contact.nearest.distance, 0.0);
}

TEST_F(ContactCycleTest, MeasuresATriangleTipWhole) {
  instruments_[0].shapes = {core::Triangle{{0, 0, 0}, {0, 0, -1}, {0.1, 0, 0}}};
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  const Contact contact = contacts(ros::Time(100.0)).contacts[0];
  EXPECT_EQ(contact.nearest.distance, 1.0);
  EXPECT_EQ(contact.instrument_point.z, 2.0);
}

TEST_F(ContactCycleTest, MeasuresAllPiecesOfAnInstrument) {
  const core::Capsule shaft{{0, 0, 0}, {0, 0, 1}, 0.25};
  instruments_[0].shapes = {shaft, core::Sphere{{0, 0, -0.5}, 0.5}};
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  const Contact contact = contacts(ros::Time(100.0)).contacts[0];
  EXPECT_EQ(contact.nearest.distance, 1.0);
  EXPECT_EQ(contact.instrument_point.z, 2.0);
}

TEST_F(ContactCycleTest, WithoutAWayToTheScenesFrameThereIsNoPose) {
  scene_.frame = "nowhere";
  ContactCycle cycle(scene_, instruments_, organs_, buffer_);
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  cycle.lookUpTips();
  EXPECT_EQ(cycle.contacts(ros::Time(100.0), {}).contacts[0].status, Contact::NO_POSE);
  EXPECT_NE(cycle.complaints(ros::Time(100.0))[0].reason.find("nowhere"), std::string::npos);
}

TEST_F(ContactCycleTest, NamesTheOrgansFrameWhereThatIsTheOneToldNoMore) {
  organs_[0] = std::make_unique<Organ>("liver", "bowel", test::cube());
  ContactCycle cycle(scene_, instruments_, organs_, buffer_);
  place("world", "bowel", {10, 0, 0}, ros::Time(100.0));
  for (const double now : {100.0, 105.0})
    place("world", "left_tip", {10.5, 0.5, 3.0}, ros::Time(now));
  cycle.lookUpTips();
  EXPECT_EQ(cycle.complaints(ros::Time(105.0))[0].reason,
            "the last pose is 5.000000 s old: of a later time tf has not told where 'bowel' is");
}

TEST_F(ContactCycleTest, ComplainsOfTheOrganThatThePairHas) {
  organs_.push_back(std::make_unique<Organ>("stomach", "stomach", test::cube()));
  scene_.pairs = {{0, 1}};
  ContactCycle cycle(scene_, instruments_, organs_, buffer_);
  cycle.lookUpTips();
  EXPECT_EQ(cycle.complaints(ros::Time(1.0))[0].second, "stomach");
}

TEST_F(ContactCycleTest, HasTheStampOfATipWhoseClockIsALittleAhead) {
  place("liver", "left_tip", {0.5, 0.5, 3.0}, ros::Time(100.0));
  EXPECT_EQ(contacts(ros::Time(99.95)).header.stamp, ros::Time(100.0));
}

TEST_F(ContactCycleTest, HasNewsWhenTheScenesFrameIsThereAndWhereverThatIsLate) {
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

}  // namespace
}  // namespace organ_collision::node
