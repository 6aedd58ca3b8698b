#include "organ_collision/io/robot_geometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "organ_collision/core/nearest_triangle.h"
#include "temporary_folder.h"

namespace organ_collision::io {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;

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

const std::string kLinkOfRobot = "link 'abdomen' of the robot description: ";

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
  EXPECT_THAT(refusal(robot(visual)), HasSubstr("it has no <collision>"));
}

TEST(RobotGeometry, RefusesADescriptionThatIsNoUrdf) {
  for (const char* const text : {"", "robot", "<robot", "<robot/>"}) {
    EXPECT_THAT(refusal(text),
                MatchesRegex("link 'abdomen' of the robot description: the description cannot be "
                             "read as URDF: .+"))
        << text;
  }
  EXPECT_THAT(refusal("<robot/>"), HasSubstr("No name given for the robot"));
}

TEST(RobotGeometry, NamesTheLinksThatThereAre) {
  EXPECT_EQ(refusal(robot(collision(kMesh)), "liver"),
            "link 'liver' of the robot description: there is none of this name; there are: "
            "abdomen, bed");
}

TEST(RobotGeometry, RefusesALinkWithoutOrWithSeveralCollisions) {
  EXPECT_EQ(refusal(robot("")), "link 'abdomen' of the robot description: it has no <collision>");
  EXPECT_EQ(
      refusal(robot(collision(kMesh) + collision(kMesh))),
      "link 'abdomen' of the robot description: it has 2 <collision>, but an organ is one mesh");
}

TEST(RobotGeometry, DoesNotCountTheCollisionsOfOtherLinks) {
  std::string two = robot(collision(kMesh));
  const std::string bed = R"(<link name="bed"/>)";
  two.replace(two.find(bed), bed.size(), R"(<link name="bed">)" + collision(kMesh) + "</link>");
  EXPECT_EQ(linkMesh(two, "abdomen").url, "package://p/liver.obj");
}

TEST(RobotGeometry, RefusesALinkOfWhichACollisionCannotBeRead) {
  for (const char* const unreadable : {"<cone/>", "<mesh/>", R"(<box size="1"/>)"}) {
    EXPECT_THAT(
        refusal(robot(collision(kMesh) + collision(unreadable))),
        MatchesRegex(
            "link 'abdomen' of the robot description: 1 of its 2 <collision> can be read: .+"))
        << unreadable;
  }
  EXPECT_THAT(refusal(robot(collision("<cone/>"))), HasSubstr("'cone'"));
  std::string two = robot(collision("<cone/>"));
  const std::string bed = R"(<link name="bed"/>)";
  two.replace(two.find(bed), bed.size(),
              R"(<link name="bed">)" + collision("<torus/>") + "</link>");
  EXPECT_THAT(refusal(two), HasSubstr("'cone'"));
}

TEST(RobotGeometry, RefusesSeveralShapesInOneCollision) {
  const std::string two = R"(<sphere radius="1"/><box size="1 1 1"/>)";
  for (const std::string& shapes : {two, R"(<sphere radius="1"/></geometry><geometry>)" + kMesh})
    EXPECT_THAT(refusal(robot(collision(shapes))),
                HasSubstr("its <collision> 1 has 2 shapes, but one is wanted"));
  EXPECT_THAT(refusal(robot(collision(""))),
              HasSubstr("its <collision> 1 has 0 shapes, but one is wanted"));
}

TEST(RobotGeometry, ReadsTheRobotBehindAnotherElement) {
  EXPECT_EQ(linkMesh("<note/>" + robot(collision(kMesh)), "abdomen").url, "package://p/liver.obj");
}

TEST(RobotGeometry, RefusesShapesThatAreNoMesh) {
  EXPECT_THAT(refusal(robot(collision(R"(<box size="1 1 1"/>)"))),
              HasSubstr("is a box, but an organ is a mesh"));
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
    EXPECT_THAT(refusal(scaled(scale)), HasSubstr("0 of its 1 <collision> can be read")) << scale;
  }
}

// Parsers call themselves for what is in another, and for a joint after another.

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

/// Links l0, l1, ..., each on the one before.
std::string chainOfJoints(int count) {
  std::string chain = R"(<link name="l0"/>)";
  for (int i = 1; i <= count; ++i) {
    const std::string child = "l" + std::to_string(i);
    chain += "<link name=\"" + child + "\"/><joint name=\"j" + child +
             R"(" type="fixed"><parent link="l)" + std::to_string(i - 1) + R"("/><child link=")" +
             child + R"("/></joint>)";
  }
  return chain +
         R"(<joint name="j" type="fixed"><parent link="l0"/><child link="abdomen"/></joint>)";
}

std::string robotWith(const std::string& more) {
  return R"(<robot name="patient"><link name="abdomen">)" + collision(kMesh) + "</link>" + more +
         "</robot>";
}

TEST(RobotGeometry, ADescriptionDeepEnoughToCrashTheParserIsRefused) {
  constexpr int kDeep = 100'000;
  const std::string nested = repeated("<a>", kDeep) + repeated("</a>", kDeep);
  EXPECT_THAT(refusal(robotWith(nested)), StartsWith(kLinkOfRobot));
  EXPECT_THAT(messageOf([&] { linkPieces(repeated("<a>", kDeep), "abdomen"); }),
              StartsWith(kLinkOfRobot));
}

TEST(RobotGeometry, AChainOfJointsLongEnoughToCrashTheParserIsRefused) {
  EXPECT_EQ(refusal(robotWith(chainOfJoints(1'000))), "");
  EXPECT_THAT(refusal(robotWith(chainOfJoints(300'000))), StartsWith(kLinkOfRobot));
}

TEST(RobotGeometry, RefusesAnOriginThatNoCoordinateCanBe) {
  const auto at = [](const std::string& position) {
    return R"(<collision><origin xyz=")" + position + R"("/><geometry>)" + kMesh +
           "</geometry></collision>";
  };
  EXPECT_EQ(refusal(robot(at("0 9e149 0"))), "");
  const std::string wanted = kLinkOfRobot +
                             "the origin of its <collision> is (0, -1e+200, 0), "
                             "but its coordinates must be below 1e+150";
  EXPECT_EQ(refusal(robot(at("0 -1e200 0"))), wanted);
  EXPECT_EQ(messageOf([&] { linkPieces(robot(at("0 -1e200 0")), "abdomen"); }), wanted);
}

// Of instruments.

std::vector<LinkPiece> piecesOf(const std::string& collisions) {
  return linkPieces(robot(collisions), "abdomen");
}

const core::RigidMesh& rigidMesh(const LinkPiece& piece) {
  return std::get<core::RigidMesh>(std::get<core::Shape>(piece));
}

double volumeOf(const core::TriangleMesh& mesh) {
  double volume = 0.0;
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const auto [a, b, c] = mesh.triangle(core::TriangleId(i));
    volume += a.dot(b.cross(c)) / 6.0;
  }
  return volume;
}

TEST(LinkPieces, AreAllCollisionsInTheirOrder) {
  const auto pieces = piecesOf(collision(kMesh) + collision(R"(<sphere radius="0.5"/>)") +
                               collision(R"(<box size="1 2 4"/>)"));
  ASSERT_EQ(pieces.size(), 3U);
  EXPECT_EQ(std::get<LinkMesh>(pieces[0]).url, "package://p/liver.obj");
  const auto& sphere = std::get<core::Sphere>(std::get<core::Shape>(pieces[1]));
  EXPECT_EQ(sphere.centre, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(sphere.radius, 0.5);
  // A quarter turn about z takes x to y.
  EXPECT_LE(
      (rigidMesh(pieces[2]).pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(),
      kTolerance);
}

TEST(LinkPieces, LieWhereTheirOriginSaysInTheirScale) {
  const auto pieces =
      piecesOf(collision(kMesh) + collision(R"(<cylinder radius="0.5" length="3"/>)"));
  const auto& mesh = std::get<LinkMesh>(pieces[0]);
  EXPECT_EQ(mesh.scale, Eigen::Vector3d(0.001, 0.002, -0.003));
  for (const core::Pose& pose : {mesh.link_from_mesh, rigidMesh(pieces[1]).pose})
    EXPECT_LE((pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), kTolerance);
}

TEST(LinkPieces, ABoxIsItsTwelveTriangles) {
  const auto pieces = piecesOf(collision(R"(<box size="1 2 4"/>)"));
  const core::RigidMesh& box = rigidMesh(pieces[0]);
  EXPECT_TRUE(box.convex);
  EXPECT_TRUE(box.surface->health().isSolid());
  EXPECT_FALSE(box.surface->health().inverted);
  EXPECT_EQ(box.surface->mesh().triangleCount(), 12U);
  EXPECT_EQ(box.surface->health().box.high, Eigen::Vector3d(0.5, 1, 2));
  EXPECT_EQ(volumeOf(box.surface->mesh()), 8.0);
}

TEST(LinkPieces, ACylinderIsAPrismThatHoldsIt) {
  const auto pieces = piecesOf(collision(R"(<cylinder radius="0.5" length="3"/>)"));
  const core::RigidMesh& prism = rigidMesh(pieces[0]);
  EXPECT_TRUE(prism.convex);
  EXPECT_TRUE(prism.surface->health().isSolid());
  EXPECT_EQ(prism.surface->health().degenerate_triangles, 0U);
  for (const Eigen::Vector3d& point : prism.surface->mesh().positions()) {
    EXPECT_EQ(std::abs(point.z()), 1.5);
    EXPECT_LE(point.head<2>().norm(), 1.005 * 0.5);
  }
  const double area = kCylinderSides * 0.25 * std::tan(M_PI / kCylinderSides);
  EXPECT_NEAR(volumeOf(prism.surface->mesh()), 3.0 * area, 1e-14);  // rounding of 128 summands
  for (int i = 0; i < 100; ++i) {
    const Eigen::AngleAxisd turn(0.1 * i, Eigen::Vector3d::UnitZ());
    EXPECT_LE(core::nearestTriangle(*prism.surface, turn * Eigen::Vector3d(0.5, 0, 1)).distance,
              kTolerance);
  }
}

TEST(LinkPieces, RefusesSizesThatAreNone) {
  const auto refused = [](const std::string& geometry) {
    return messageOf([&] { piecesOf(collision(geometry)); });
  };
  EXPECT_THAT(refused(R"(<sphere radius="-1"/>)"),
              HasSubstr("sphere's radius is -1, but it must be above 0 and below 1e+150"));
  EXPECT_THAT(refused(R"(<box size="1 0 1"/>)"), HasSubstr("box's y is 0"));
  EXPECT_THAT(refused(R"(<cylinder radius="1" length="-2"/>)"), HasSubstr("cylinder's length"));
  EXPECT_THAT(refused(R"(<cylinder radius="0" length="2"/>)"), HasSubstr("cylinder's radius"));
  EXPECT_THAT(refused(R"(<sphere/>)"), HasSubstr("0 of its 1 <collision> can be read: "));
  EXPECT_THAT(
      refused(R"(<sphere radius="1"/></geometry></collision><collision><geometry><sphere/>)"),
      HasSubstr("1 of its 2 <collision> can be read"));
  for (const char* const large :
       {R"(<sphere radius="1e200"/>)", R"(<box size="1e200 1 1"/>)",
        R"(<cylinder radius="1e200" length="1"/>)", R"(<cylinder radius="1" length="1e200"/>)"}) {
    EXPECT_THAT(refused(large), AllOf(StartsWith(kLinkOfRobot + "its "),
                                      HasSubstr(" is 1e+200, but it must be above 0 and below")));
  }
  EXPECT_THAT(refused(R"(<cylinder radius="9.99e149" length="1"/>)"),
              HasSubstr("cylinder's radius, with a prism about it, is 1.00"));
  EXPECT_THAT(messageOf([] { linkPieces(robot(""), "arm"); }),
              HasSubstr("there are: abdomen, bed"));
}

}  // namespace
}  // namespace organ_collision::io
