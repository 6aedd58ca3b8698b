#include "tools/tip_samples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/temporary_folder.h"
#include "organ_collision/core/nearest_triangle.h"
#include "test_meshes.h"

namespace organ_collision::tools {
namespace {

using core::CollisionMesh;
using io::messageOf;
using io::TemporaryFolder;
using testing::HasSubstr;

constexpr std::uint64_t kSeed = 11;

const Band& band(const std::vector<Band>& all, const std::string& name) {
  return *std::find_if(all.begin(), all.end(), [&](const Band& b) { return b.name == name; });
}

TEST(Bands, FollowEachOtherWithoutAGap) {
  const std::vector<Band> all = bands();
  EXPECT_EQ(all.front().low, 0.0);
  for (std::size_t i = 1; i + 1 < all.size(); ++i) EXPECT_EQ(all[i].low, all[i - 1].high);
  EXPECT_TRUE(all.back().inside);
}

TEST(SampleTips, AreInTheirBand) {
  const CollisionMesh organ(test::blob(3));
  for (const Band& wanted : bands()) {
    const core::Points tips = sampleTips(organ, wanted, 200, kSeed);
    EXPECT_EQ(tips.size(), 200U) << wanted.name;
    for (const Eigen::Vector3d& tip : tips) {
      const double distance = core::nearestTriangle(organ, tip).distance;
      EXPECT_TRUE(wanted.inside ? distance < 0.0 : wanted.low <= distance && distance < wanted.high)
          << wanted.name << ": " << distance;
    }
  }
}

TEST(SampleTips, AreTheSameForTheSameSeedOnly) {
  const CollisionMesh organ(test::blob(2));
  const Band near = bands().front();
  EXPECT_EQ(sampleTips(organ, near, 50, kSeed), sampleTips(organ, near, 50, kSeed));
  EXPECT_NE(sampleTips(organ, near, 50, kSeed), sampleTips(organ, near, 50, kSeed + 1));
}

TEST(SampleTips, AreOnBothSidesOfAnOpenSurfaceAndNeverInside) {
  const CollisionMesh sheet(test::grid(4, 4));
  const core::Points tips = sampleTips(sheet, bands().front(), 200, kSeed);
  const auto above = std::count_if(tips.begin(), tips.end(),
                                   [](const Eigen::Vector3d& tip) { return tip.z() > 0.0; });
  EXPECT_GT(above, 60);
  EXPECT_LT(above, 140);
  EXPECT_TRUE(sampleTips(sheet, band(bands(), "inside"), 200, kSeed).empty());
}

TEST(SampleTips, AreAsDenseOnLargeTrianglesAsOnSmallOnes) {
  // Two triangles over one square, one of nine tenths of its area.
  const CollisionMesh organ({{{0, 0, 0}, {9, 0, 0}, {0, 2, 0}, {10, 0, 0}},
                             {test::corners(0, 1, 2), test::corners(1, 3, 2)}});
  const core::Points tips = sampleTips(organ, bands().front(), 2000, kSeed);
  const auto on_large = std::count_if(tips.begin(), tips.end(), [](const Eigen::Vector3d& tip) {
    return tip.x() / 9.0 + tip.y() / 2.0 < 1.0;
  });
  EXPECT_NEAR(static_cast<double>(on_large), 1800.0, 4.0 * std::sqrt(2000 * 0.9 * 0.1));
}

TEST(SampleTips, AreEquallyDenseAllOverATriangle) {
  const CollisionMesh organ({{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}}, {test::corners(0, 1, 2)}});
  const core::Points tips = sampleTips(organ, bands().front(), 2000, kSeed);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& tip : tips) sum += tip;
  constexpr double kSpread = 0.0158;  // [m] of a coordinate's mean: 3 / sqrt(18) / sqrt(2000)
  EXPECT_NEAR(sum.x() / 2000.0, 1.0, 4.0 * kSpread);
  EXPECT_NEAR(sum.y() / 2000.0, 1.0, 4.0 * kSpread);
}

TEST(SampleTips, AreFewerWhereThereIsNoRoom) {
  // In a cube of 1 mm a tip's distance is below 0.5 mm.
  const CollisionMesh organ(test::cube(0.001));
  const Band deep = {"deep inside", 0.0, 10.0, true};
  EXPECT_LT(sampleTips(organ, deep, 200, kSeed).size(), 200U);
}

TEST(SampleTips, RefusesAnOrganWithoutArea) {
  const CollisionMesh line({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {test::corners(0, 1, 2)}});
  EXPECT_THAT(messageOf([&] { sampleTips(line, bands().front(), 1, kSeed); }),
              HasSubstr("no area"));
}

core::Points readText(const std::string& text) {
  const TemporaryFolder folder;
  return readTips(folder.write("tips.csv", text));
}

TEST(ReadTips, TakesThreeNumbersALineAfterAHeader) {
  const core::Points expected = {{0.1, -2e-3, 3}, {4, 5, 6}};
  EXPECT_EQ(readText("x,y,z\n0.1,-2e-3,3\n4,5,6\n"), expected);
  EXPECT_EQ(readText("0.1, -2e-3 ,3\r\n\r\n4,5,6"), expected);
  EXPECT_EQ(readText("\xEF\xBB\xBFx,y,z\n0.1,-2e-3,3\n4,5,6\n"), expected);
  EXPECT_EQ(readText("\xEF\xBB\xBF"
                     "0.1,-2e-3,3\n4,5,6\n"),
            expected);
}

TEST(ReadTips, RefusesBadLinesByTheirNumber) {
  for (const char* bad :
       {"1,2", "1,2,3,4", "1,2,", "nan,0,0", "0,inf,0", "0,0,1e200", "a,b,c", "1,2,3 4", "1;2;3"}) {
    EXPECT_THAT(messageOf([&] { readText("0,0,0\n" + std::string(bad) + "\n"); }),
                HasSubstr("tips.csv:2: "))
        << bad;
  }
  for (const char* first : {"nan,0,0", "0;0;0", "0,0,z", "x,y"}) {
    EXPECT_THAT(messageOf([&] { readText(std::string(first) + "\n1,2,3\n"); }),
                HasSubstr("tips.csv:1: "))
        << first;
  }
}

TEST(ReadTips, RefusesFilesWithoutTips) {
  EXPECT_THAT(messageOf([] { readText(""); }), HasSubstr("no tips"));
  EXPECT_THAT(messageOf([] { readText("x,y,z\n"); }), HasSubstr("no tips"));
  EXPECT_THAT(messageOf([] { readTips("/no/such/file"); }), HasSubstr("/no/such/file"));
  EXPECT_THAT(messageOf([] { readTips(std::filesystem::temp_directory_path()); }),
              HasSubstr("cannot read"));
  EXPECT_THAT(messageOf([] { readTips("/proc/self/mem"); }), HasSubstr("reading failed"));
}

}  // namespace
}  // namespace organ_collision::tools
