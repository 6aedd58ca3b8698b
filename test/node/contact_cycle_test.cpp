#include "node/contact_cycle.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <thread>

#include "node/contact_cycle_fixture.h"
#include "node/moves.h"
#include "test_meshes.h"

namespace organ_collision::node {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

TEST_F(ContactCycleTest, ComplainsOfTheOrganThatThePairHas) {
  organs_.push_back(std::make_unique<Organ>("stomach", "stomach", test::cube()));
  scene_.pairs = {{0, 1}};
  ContactCycle cycle(scene_, instruments_, organs_, buffer_);
  cycle.lookUpTips();
  EXPECT_EQ(cycle.complaints(ros::Time(1.0))[0].second, "stomach");
}

}  // namespace
}  // namespace organ_collision::node
