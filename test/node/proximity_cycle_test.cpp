#include "node/proximity_cycle.h"

#include <gtest/gtest.h>
#include <organ_collision/Contact.h>

#include <limits>
#include <random>

#include "node/cube_organ.h"
#include "node/frames.h"
#include "node/moves.h"
#include "test_meshes.h"

namespace organ_collision::node {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Two spheres and two unit cubes, without a master.
class ProximityCycleTest : public testing::Test {
 protected:
  ProximityCycleTest() { place("world", "liver", {10, 0, 0}, ros::Time(0), true); }

  void place(const std::string& parent, const std::string& child, const Eigen::Vector3d& at,
             const ros::Time& stamp, bool is_static = false) {
    ASSERT_TRUE(test::place(buffer_, parent, child, at, stamp, is_static));
  }

  ProximityArray proximities(const ros::Time& now) {
    cycle_.lookUp();
    return cycle_.proximities(now, {});
  }

  static io::Scene twoPairs() {
    io::Scene scene;
    scene.frame = "world";
    scene.like_pairs = {{io::LikePair::Of::kInstruments, 0, 1}, {io::LikePair::Of::kOrgans, 1, 0}};
    return scene;
  }

  static Organs twoCubes() {
    Organs organs;
    organs.push_back(std::make_unique<Organ>("liver", "liver", test::cube()));
    organs.push_back(std::make_unique<Organ>("stomach", "stomach", test::cube()));
    return organs;
  }

  io::Scene scene_ = twoPairs();
  Instruments instruments_ = {{"left", "left_tip", {core::Sphere{{0, 0, 0}, 0.25}}},
                              {"right", "right_tip", {core::Sphere{{0, 0, 0}, 0.5}}}};
  Organs organs_ = twoCubes();
  tf2::BufferCore buffer_;
  ProximityCycle cycle_{scene_, instruments_, organs_, buffer_};
};

TEST_F(ProximityCycleTest, HasNoStampThatIsStillToCome) {
  place("liver", "stomach", {0, 0, 3}, ros::Time(3600.0));
  proximities(ros::Time(3600.0));
  buffer_.clear();  // time jumps back
  place("world", "left_tip", {0, 0, 0}, ros::Time(10.0));
  place("world", "right_tip", {0, 0, 2}, ros::Time(10.0));
  EXPECT_EQ(proximities(ros::Time(10.01)).header.stamp, ros::Time(10.0));
}

TEST_F(ProximityCycleTest, TellsInstrumentsAndOrgansInTheScenesFrame) {
  place("world", "left_tip", {0, 0, 0}, ros::Time(100.0));
  place("world", "right_tip", {0, 0, 2}, ros::Time(100.0));
  place("liver", "stomach", {0, 0, 3}, ros::Time(99.0));
  const ProximityArray array = proximities(ros::Time(100.01));
  ASSERT_EQ(array.proximities.size(), 2U);
  EXPECT_EQ(array.header.frame_id, "world");
  EXPECT_EQ(array.header.stamp, ros::Time(100.0));
  const Proximity& tools = array.proximities[0];
  EXPECT_EQ(tools.first, "left");
  EXPECT_EQ(tools.second, "right");
  EXPECT_EQ(tools.status, Contact::OK);
  EXPECT_EQ(tools.distance, 1.25);
  EXPECT_EQ(tools.point_on_first.z, 0.25);
  EXPECT_EQ(tools.point_on_second.z, 1.5);
  EXPECT_EQ(tools.normal.z, 1.0);
  EXPECT_EQ(tools.triangle_of_first, -1);
  EXPECT_EQ(tools.mesh_version_of_first, 0U);
  EXPECT_EQ(tools.lower_bound, 1.25);
  EXPECT_EQ(tools.upper_bound, 1.25);
  EXPECT_FALSE(tools.colliding);
  EXPECT_TRUE(tools.colliding_certain);
  EXPECT_NEAR(tools.age.toSec(), 0.01, 1e-9);
  EXPECT_GT(array.computation_time, 0.0);
  const Proximity& organs = array.proximities[1];
  EXPECT_EQ(organs.first, "stomach");
  EXPECT_EQ(organs.status, Contact::STALE);
  EXPECT_NEAR(organs.age.toSec(), 1.01, 1e-9);
  EXPECT_EQ(organs.distance, 2.0);
  EXPECT_EQ(organs.point_on_first.z, 3.0);
  EXPECT_GE(organs.point_on_first.x, 10.0);
  EXPECT_GE(organs.triangle_of_first, 0);
  EXPECT_GE(organs.triangle_of_second, 0);
}

TEST_F(ProximityCycleTest, SaysNoPoseUntilTheFramesAreThere) {
  const ProximityArray array = proximities(ros::Time(1.0));
  for (const Proximity& proximity : array.proximities) {
    EXPECT_EQ(proximity.status, Contact::NO_POSE);
    EXPECT_EQ(proximity.distance, kInfinity);
    EXPECT_EQ(proximity.lower_bound, 0.0);
    EXPECT_FALSE(proximity.colliding);
  }
  ASSERT_EQ(cycle_.complaints(ros::Time(1.0)).size(), 2U);
  EXPECT_EQ(cycle_.complaints(ros::Time(1.0))[1].second, "liver");
}

TEST_F(ProximityCycleTest, BeyondTheLargestDistanceTellsTheProvenBoundOnly) {
  scene_.max_distance = 1.0;
  place("world", "left_tip", {0, 0, 0}, ros::Time(100.0));
  place("liver", "stomach", {0, 0, 3}, ros::Time(100.0));
  place("world", "right_tip", {0, 0, 2}, ros::Time(100.0));  // culled by its box
  EXPECT_EQ(proximities(ros::Time(100.0)).proximities[0].status, Contact::OUT_OF_RANGE);
  EXPECT_EQ(proximities(ros::Time(100.0)).proximities[0].lower_bound, 1.25);
  EXPECT_TRUE(proximities(ros::Time(100.0)).proximities[0].colliding_certain);
  EXPECT_EQ(proximities(ros::Time(100.0)).proximities[1].lower_bound, 2.0);
  place("world", "left_tip", {0, 0, 0}, ros::Time(100.1));
  place("world", "right_tip", {1.4, 0, 1.4}, ros::Time(100.1));  // by what is found
  const Proximity far = proximities(ros::Time(100.1)).proximities[0];
  EXPECT_EQ(far.status, Contact::OUT_OF_RANGE);
  EXPECT_NEAR(far.lower_bound, 1.4 * std::sqrt(2.0) - 0.75, 1e-15);
  EXPECT_EQ(far.distance, kInfinity);
  EXPECT_TRUE(far.colliding_certain);
}

TEST_F(ProximityCycleTest, IsStaleRatherThanOutOfRange) {
  scene_.max_distance = 1.0;
  place("world", "left_tip", {0, 0, 0}, ros::Time(100.0));
  place("world", "right_tip", {0, 0, 2}, ros::Time(100.0));
  EXPECT_EQ(proximities(ros::Time(100.0)).proximities[0].status, Contact::OUT_OF_RANGE);
  EXPECT_EQ(proximities(ros::Time(100.5)).proximities[0].status, Contact::STALE);
}

TEST_F(ProximityCycleTest, HasNewsWhenAFrameOrEitherOrganHasMoved) {
  place("liver", "stomach", {0, 0, 3}, ros::Time(100.0));
  EXPECT_TRUE(cycle_.lookUp());
  EXPECT_FALSE(cycle_.lookUp());
  for (const auto& organ : organs_) {
    organ->update(test::movesOf({7}, {{1, 1, 2}}), UpdateMode::kAuto, 0);
    EXPECT_TRUE(cycle_.lookUp());
    EXPECT_FALSE(cycle_.lookUp());
  }
  organs_[1]->update(test::movesOf({7}, {{1, 1, 2}}), UpdateMode::kAuto, 0);  // where it is
  const Proximity found = cycle_.proximities(ros::Time(100.0), {}).proximities[1];
  EXPECT_EQ(found.distance, 1.0);
  EXPECT_EQ(found.mesh_version_of_first, 3U);  // of the stomach, organs_[1]
  EXPECT_EQ(found.mesh_version_of_second, 2U);
}

/// Instruments and organs that are bumpy.
class ProximityOfBlobs : public ProximityCycleTest {
 protected:
  ProximityOfBlobs() {
    const core::RigidMesh shape = {std::make_shared<const core::CollisionMesh>(test::blob(4)),
                                   Eigen::Isometry3d::Identity(), false};
    for (Instrument& instrument : instruments_) instrument.shapes = {shape};
    for (auto& organ : organs_)
      organ = std::make_unique<Organ>(organ->name(), organ->frame(), test::blob(4));
    place("left_tip", "right_tip", {0.3, 0.2, 0.1}, ros::Time(0), true);
    place("world", "left_tip", {0, 0, 0}, ros::Time(0), true);
    place("liver", "stomach", {0.3, 0.2, 0.1}, ros::Time(0), true);
    cycle_.lookUp();
  }
};

TEST_F(ProximityOfBlobs, KeepsToTheAccuracyAskedForAndTellsItsBounds) {
  const ProximityArray greedy = cycle_.proximities(ros::Time(1.0), core::Accuracy::greedy());
  const ProximityArray exact = cycle_.proximities(ros::Time(1.0), {});
  for (const std::size_t i : {0, 1}) {
    EXPECT_LT(greedy.proximities[i].lower_bound, exact.proximities[i].distance);
    EXPECT_GE(greedy.proximities[i].upper_bound, exact.proximities[i].distance);
    EXPECT_EQ(exact.proximities[i].lower_bound, exact.proximities[i].upper_bound);
  }
}

TEST_F(ProximityOfBlobs, IsExactUnlessTheLeavesAreFew) {
  instruments_[1].shapes = {core::Sphere{{2.0, 0.7, 0.3}, 0.1}};
  place("liver", "stomach", {3.0, 2.0, 1.0}, ros::Time(1.0), true);
  cycle_.lookUp();
  const ProximityArray exact = cycle_.proximities(ros::Time(1.0), {});
  const ProximityArray allowed = cycle_.proximities(ros::Time(1.0), {0.5, 0.5, 0});
  for (const std::size_t i : {0, 1}) {
    EXPECT_GT(exact.proximities[i].distance, 0.1);
    EXPECT_EQ(allowed.proximities[i].lower_bound, exact.proximities[i].distance);
    EXPECT_EQ(allowed.proximities[i].upper_bound, exact.proximities[i].distance);
  }
}

TEST_F(ProximityOfBlobs, FollowsEitherOrganWhenItDeforms) {
  std::mt19937 generator(5);
  for (int i = 0; i < 120; ++i) {
    Organ& organ = *organs_[i < 60 ? 0 : 1];
    core::Points positions = organ.snapshot()->organ.mesh().positions();
    for (Eigen::Vector3d& position : positions) position += test::randomPoint(generator, 0.004);
    organ.update({{}, positions}, UpdateMode::kRefit, 0);
    cycle_.lookUp();
    ProximityCycle fresh(scene_, instruments_, organs_, buffer_);
    fresh.lookUp();
    ASSERT_EQ(cycle_.proximities(ros::Time(1.0), {}).proximities[1].distance,
              fresh.proximities(ros::Time(1.0), {}).proximities[1].distance);
  }
}

TEST_F(ProximityOfBlobs, CountsForTheWearOfBothOrgans) {
  for (const auto& organ : organs_)
    organ->update({{}, crushed(organ->snapshot()->organ.mesh().positions())}, UpdateMode::kRefit,
                  0);
  for (int i = 0; i < 1024; ++i) cycle_.proximities(ros::Time(1.0), {});
  for (const auto& organ : organs_) {
    organ->work();
    EXPECT_NE(organ->costRatio(), 1.0) << organ->name();
  }
}

TEST_F(ProximityCycleTest, ComparesTheBoxesWhereTheInstrumentsAre) {
  scene_.max_distance = 1.0;
  instruments_[0].shapes = {core::Sphere{{5, 0, 0}, 0.25}};
  place("world", "left_tip", {-5, 0, 0}, ros::Time(100.0));
  place("world", "right_tip", {0, 0, 1}, ros::Time(100.0));
  const Proximity near = proximities(ros::Time(100.0)).proximities[0];
  EXPECT_EQ(near.status, Contact::OK);
  EXPECT_EQ(near.distance, 0.25);
}

}  // namespace
}  // namespace organ_collision::node
