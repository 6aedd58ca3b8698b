#include "node/scene_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>

#include "test_meshes.h"

namespace organ_collision::node {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

io::Scene scene() {
  io::Scene scene;
  scene.organs = {{"liver", "liver", {}}, {"spleen", "spleen", {}}, {"wall", "wall", {}}};
  scene.instruments = {{"tip", "tip", {}}, {"jaw", "jaw", {}}, {"unused", "unused", {}}};
  scene.pairs = {{0, 0}, {1, 0}};
  scene.like_pairs = {{io::LikePair::Of::kInstruments, 1, 0}, {io::LikePair::Of::kOrgans, 0, 1}};
  return scene;
}

TEST(SceneReport, TellsForWhomEachThingWasBuilt) {
  Organs organs;
  for (const char* const name : {"liver", "spleen", "wall"})
    organs.push_back(std::make_unique<Organ>(name, name, test::cube()));
  const core::RigidMesh jaw{std::make_shared<const core::CollisionMesh>(test::blob(4)),
                            Eigen::Isometry3d::Identity(), true};
  std::array<char, 32> megabytes{};
  std::snprintf(megabytes.data(), megabytes.size(), "%.3f",
                1e-6 * static_cast<double>(jaw.surface->memory()));
  const Instruments instruments = {{"tip", "tip", {Eigen::Vector3d(0, 0, 0)}, 0.0},
                                   {"jaw", "jaw", {jaw, core::Sphere{{0, 0, 0}, 1}}, 0.25},
                                   {"unused", "unused", {}, 0.0}};
  const std::vector<std::string> told = report(scene(), instruments, organs);
  ASSERT_EQ(told.size(), 6U);
  EXPECT_THAT(told[0], StartsWith("liver: hierarchy of 12 triangles for tip, jaw, spleen: 0.00"));
  EXPECT_THAT(told[1], StartsWith("spleen: hierarchy of 12 triangles for liver: 0.00"));
  EXPECT_THAT(told[2], HasSubstr("for no pair, but the services"));
  EXPECT_THAT(told[3], StartsWith("tip: point for liver, jaw: 0.000 MB"));
  EXPECT_THAT(told[4], StartsWith("jaw: convex mesh of 2048 triangles, sphere for liver, tip: " +
                                  std::string(megabytes.data())));
  EXPECT_THAT(told[4], HasSubstr("built in 0.2500 s"));
  EXPECT_EQ(told[5], "unused: in no pair: nothing built");
}

}  // namespace
}  // namespace organ_collision::node
