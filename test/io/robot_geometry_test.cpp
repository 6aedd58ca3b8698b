#include "organ_collision/io/robot_geometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "temporary_folder.h"

namespace organ_collision::io {
namespace {

using testing::HasSubstr;

constexpr double kTolerance = 1e-15;  // rounding of the sine and cosine of a half angle

const std::string kMesh = R"(<mesh filename="package://p/liver.obj" scale="0.001 0.002 -0.003"/>)";

std::string collision(const std::string& geometry) {
  return R"(<collision><origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/><geometry>)" + geometry +
         "</geometry></collision>";
}

std::string robot(const std::string& collisions) {
  return R"(<robot name="patient"><link name="bed"/><link name="abdomen">)" + collisions +
         R"(</link><joint name="j" type="fixed"><parent link="bed"/><child link="abdomen"/></joint></robot>)";
}

std::string refusal(const std::string& description, const std::string& link = "abdomen") {
  return messageOf([&] { linkMesh(description, link); });
}

TEST(RobotGeometry, GivesTheCollisionMeshWithScaleAndOrigin) {
  const LinkMesh mesh = linkMesh(robot(collision(kMesh)), "abdomen");
  EXPECT_EQ(mesh.url, "package://p/liver.obj");
  EXPECT_EQ(mesh.scale, Eigen::Vector3d(0.001, 0.002, -0.003));
  // A quarter turn about z takes x to y.
  const Eigen::Vector3d moved = mesh.link_from_mesh * Eigen::Vector3d(1, 0, 0);
  EXPECT_LE((moved - Eigen::Vector3d(1, 3, 3)).norm(), kTolerance);
}

TEST(RobotGeometry, HasScaleOneAndNoOffsetByDefault) {
  const std::string bare =
      R"(<collision><geometry><mesh filename="a.stl"/></geometry></collision>)";
  const LinkMesh mesh = linkMesh(robot(bare), "abdomen");
  EXPECT_EQ(mesh.scale, Eigen::Vector3d::Ones());
  EXPECT_TRUE(mesh.link_from_mesh.matrix().isIdentity(0.0));
}

TEST(RobotGeometry, IgnoresTheVisualMesh) {
  const std::string visual =
      R"(<visual><geometry><mesh filename="pretty.dae"/></geometry></visual>)";
  EXPECT_EQ(linkMesh(robot(visual + collision(kMesh)), "abdomen").url, "package://p/liver.obj");
  EXPECT_THAT(refusal(robot(visual)), HasSubstr("it has no <collision> that can be read"));
}

TEST(RobotGeometry, RefusesADescriptionThatIsNoUrdf) {
  for (const char* const text : {"", "robot", "<robot", "<robot/>"}) {
    EXPECT_EQ(refusal(text),
              "link 'abdomen' of the robot description: the description cannot be read as URDF")
        << text;
  }
}

TEST(RobotGeometry, NamesTheLinksThatThereAre) {
  EXPECT_EQ(refusal(robot(collision(kMesh)), "liver"),
            "link 'liver' of the robot description: there is none of this name; there are: "
            "abdomen, bed");
}

TEST(RobotGeometry, RefusesALinkWithoutOrWithSeveralCollisions) {
  EXPECT_EQ(refusal(robot("")),
            "link 'abdomen' of the robot description: it has no <collision> that can be read");
  EXPECT_EQ(refusal(robot(collision(kMesh) + collision(kMesh))),
            "link 'abdomen' of the robot description: it has 2 <collision>: more than one is not "
            "supported by this version");
}

TEST(RobotGeometry, RefusesShapesThatAreNoMesh) {
  EXPECT_THAT(refusal(robot(collision(R"(<box size="1 1 1"/>)"))),
              HasSubstr("is a box, which is not supported by this version; supported: a mesh"));
  EXPECT_THAT(refusal(robot(collision(R"(<sphere radius="1"/>)"))), HasSubstr("is a sphere"));
  EXPECT_THAT(refusal(robot(collision(R"(<cylinder radius="1" length="1"/>)"))),
              HasSubstr("is a cylinder"));
}

TEST(RobotGeometry, RefusesAScaleThatIsZeroOrNoNumber) {
  const auto scaled = [](const std::string& scale) {
    return robot(collision(R"(<mesh filename="a.stl" scale=")" + scale + R"("/>)"));
  };
  EXPECT_THAT(refusal(scaled("1 0 1")),
              HasSubstr("scale (1 0 1), but it must be finite and not 0"));
  for (const char* const scale : {"nan 1 1", "inf 1 1", "1 1", "1e999 1 1", "x y z"}) {
    EXPECT_THAT(refusal(scaled(scale)), HasSubstr("it has no <collision> that can be read"))
        << scale;
  }
}

}  // namespace
}  // namespace organ_collision::io
