#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "node/contact_cycle.h"
#include "node/cube_organ.h"
#include "node/frames.h"
#include "test_meshes.h"

namespace organ_collision::node {

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

}  // namespace organ_collision::node
