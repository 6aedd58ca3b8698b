#include "tools/stability.h"

#include <gtest/gtest.h>

#include <limits>

namespace organ_collision::tools {
namespace {

using core::exact::Real;

Extreme named(const std::string& name) {
  for (const Extreme& extreme : extremes()) {
    if (extreme.name == name) return extreme;
  }
  throw std::out_of_range(name);
}

StabilityRow measured(const Extreme& extreme, std::size_t samples = 1000) {
  return measureStability(extreme, Trials(samples), 1, [] {});
}

TEST(ErrorOf, IsInUnitsOfHalfAnUlpOfTheExtent) {
  EXPECT_EQ(errorOf(1.0, Real(1), 8.0), 0.0);
  EXPECT_EQ(errorOf(1.0 + 0x1p-52, Real(1), 1.0), 2.0);
  EXPECT_EQ(errorOf(1.0, Real(1) + Real(0x1p-60), 0x1p-7), 1.0);
  EXPECT_EQ(errorOf(0.0, Real(0), 0.0), 0.0);
  EXPECT_EQ(errorOf(1.0, Real(0), 0.0), std::numeric_limits<double>::infinity());
}

TEST(ExtentOf, IsTheLongestVectorToACorner) {
  const core::Triangle t{{0, 0, 0}, {3, 4, 0}, {1, 0, 0}};
  EXPECT_EQ(extentOf({0, 0, 0}, t), 5.0);
  EXPECT_EQ(extentOf({3, 4, 12}, t), 13.0);
  EXPECT_EQ(extentOf(t, {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}}), std::sqrt(29.0));
  EXPECT_EQ(extentOf({1e200, 0, 0}, t), 1e200);
}

TEST(Tally, IsKeptWithoutAWrongANonFiniteAndAnErrorAboveFour) {
  EXPECT_TRUE((Tally{10, 4.0, 0, 0}.isKept()));
  EXPECT_FALSE((Tally{10, 4.1, 0, 0}.isKept()));
  EXPECT_FALSE((Tally{10, 0.0, 1, 0}.isKept()));
  EXPECT_FALSE((Tally{10, 0.0, 0, 1}.isKept()));
}

TEST(MeasureStability, TriesAllSubjectsOfAllClasses) {
  const StabilityRow row = measured(named("random"));
  EXPECT_EQ(row[Subject::kClosestPoint].trials, 1000U);
  EXPECT_EQ(row[Subject::kTriangleDistance].trials, 100U);
  EXPECT_EQ(row[Subject::kIntersection].trials, 100U);
  EXPECT_EQ(row[Subject::kNearest].trials, 10U);
  EXPECT_EQ(row[Subject::kRefit].trials, 10U);
  EXPECT_EQ(row[Subject::kSign].trials, 10U);
  EXPECT_EQ(row[Subject::kDial].trials, 140U);
  EXPECT_EQ(row[Subject::kScaling].trials, 2 * 1010U);
  EXPECT_EQ(row[Subject::kRenumbering].trials, 10U);
  for (const Subject subject :
       {Subject::kClosestPoint, Subject::kTriangleDistance, Subject::kNearest, Subject::kRefit})
    EXPECT_GT(row[subject].worst, 0.0);
}

TEST(MeasureStability, SeesNoSidesOfAnOpenOrgan) {
  const StabilityRow row = measured(named("one triangle"));
  EXPECT_EQ(row[Subject::kSign].trials, 0U);
  EXPECT_EQ(row[Subject::kClosestPoint].trials, 0U);
  EXPECT_EQ(row[Subject::kNearest].trials, 10U);
}

TEST(MeasureStability, CountsAnErrorThatIsTooLarge) {
  Extreme underflow = named("random");  // squares of such lengths are 0: beyond what is promised
  underflow.sample = [](Extreme::Random&) {
    return core::Sample{{0, 0, 0x1p-600}, {{0, 0, 0}, {0x1p-600, 0, 0}, {0, 0x1p-600, 0}}};
  };
  const StabilityRow row = measured(underflow);
  EXPECT_FALSE(row[Subject::kClosestPoint].isKept());
  EXPECT_FALSE(row[Subject::kScaling].isKept());
  EXPECT_TRUE(row[Subject::kTriangleDistance].isKept());
}

TEST(MeasureStability, AdvancesWithEveryTip) {
  int advanced = 0;
  measureStability(named("random"), Trials(500), 1, [&advanced] { ++advanced; });
  EXPECT_EQ(advanced, 5);
}

}  // namespace
}  // namespace organ_collision::tools
