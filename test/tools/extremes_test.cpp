#include "tools/extremes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "organ_collision/core/collision_mesh.h"
#include "reference/exact.h"
#include "tools/stability.h"

namespace organ_collision::tools {
namespace {

using core::CollisionMesh;
using core::HardTriangles;
using core::Sample;
using core::Triangle;

constexpr double kRounding = 1e-15;  // of coordinates of about 1

class Extremes : public testing::Test {
 protected:
  const Extreme& named(const std::string& name) const {
    const auto found = std::find_if(all_.begin(), all_.end(),
                                    [&](const Extreme& extreme) { return extreme.name == name; });
    if (found == all_.end()) throw std::out_of_range(name);
    return *found;
  }

  const std::vector<Extreme> all_ = extremes();
  HardTriangles random_{1};
};

TEST_F(Extremes, HaveNamesOfTheirOwn) {
  std::map<std::string, int> count;
  for (const Extreme& extreme : all_) EXPECT_EQ(++count[extreme.name], 1) << extreme.name;
  EXPECT_EQ(all_.size(), 20U);
}

TEST_F(Extremes, HaveSolidOrgansButForOneAndTwoTriangles) {
  for (const Extreme& extreme : all_) {
    const CollisionMesh organ(extreme.organ);
    EXPECT_EQ(organ.health().isSolid(), organ.mesh().triangleCount() > 2) << extreme.name;
    EXPECT_FALSE(organ.health().inverted) << extreme.name;
  }
}

TEST_F(Extremes, HaveTipsInsideAndOutsideTheirOrgans) {
  for (const Extreme& extreme : all_) {
    if (extreme.organ.triangleCount() <= 2 || extreme.name == "1e30 m away") continue;
    int inside = 0;
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d tip = extreme.tip(random_, extreme.organ);
      if (core::exact::nearest(extreme.organ, tip).distance == 0) continue;
      if (core::exact::windingNumber(extreme.organ, tip) != 0) ++inside;
    }
    EXPECT_GT(inside, 10) << extreme.name;
    EXPECT_LT(inside, 190) << extreme.name;
  }
}

TEST_F(Extremes, AreAsTheirNamesSay) {
  for (int i = 0; i < 100; ++i) {
    const Triangle flat = named("zero area").sample(random_).triangle;
    EXPECT_TRUE(core::exact::collinear(flat.a, flat.b, flat.c));
    EXPECT_GT(named("1e15 m from the origin").sample(random_).triangle.a.norm(), 1e15);
    EXPECT_LT(core::largestCoordinate(named("times 2^-300").sample(random_).triangle), 0x1p-270);
    EXPECT_GT(named("1e30 m away").sample(random_).query.norm(), 1e26);
    const Sample tie = named("equidistant ties").sample(random_);
    const double distance = core::squaredLength(tie.triangle.a - tie.query);
    EXPECT_EQ(core::squaredLength(tie.triangle.b - tie.query), distance);
    EXPECT_EQ(core::squaredLength(tie.triangle.c - tie.query), distance);
    const Sample touching = named("on vertices, edges, faces").sample(random_);
    EXPECT_LE(core::exact::distance(touching.query, touching.triangle),
              kRounding * core::largestCoordinate(touching.triangle));
  }
  const auto health = [&](const char* name) { return CollisionMesh(named(name).organ).health(); };
  const std::size_t triangles = named("random").organ.triangleCount();
  EXPECT_EQ(health("zero area").degenerate_triangles, 2 * triangles);
  EXPECT_EQ(health("coincident, duplicated").duplicate_triangles, 2 * triangles);
  EXPECT_GT(CollisionMesh(named("exponentially spaced").organ).tree().depth(), 80U);
}

TEST_F(Extremes, HavePairsThatMeetAndPairsThatDoNot) {
  for (const char* name : {"random", "needles", "caps", "mixed scales", "times 2^300",
                           "1e9 m from the origin", "equidistant ties"}) {
    int meeting = 0;
    for (int i = 0; i < 300; ++i) {
      const auto [first, second] = named(name).pair(random_);
      if (core::exact::intersect(first, second)) ++meeting;
    }
    EXPECT_GT(meeting, 10) << name;
    EXPECT_LT(meeting, 290) << name;
  }
}

}  // namespace
}  // namespace organ_collision::tools
