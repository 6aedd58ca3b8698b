#include "tools/trade.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "test_meshes.h"
#include "tools/tip_samples.h"

namespace organ_collision::tools {
namespace {

using core::CollisionMesh;
using core::NearestTriangle;

constexpr std::uint64_t kSeed = 5;

BandTrade measured(const CollisionMesh& organ, const core::Points& tips) {
  return measureBand(organ, "band", tips, kSeed, [](std::size_t) {});
}

core::Points tipsAround(std::size_t count) {
  std::mt19937 generator(1);
  core::Points tips(count);
  for (Eigen::Vector3d& tip : tips) tip = test::randomPoint(generator, 0.3);
  return tips;
}

/// An answer that is `distance` away and says that the truth is between the bounds [m].
NearestTriangle answerOf(double distance, double lower, double upper, bool is_signed = false) {
  NearestTriangle answer{};
  answer.distance = distance;
  answer.lower_bound = lower;
  answer.upper_bound = upper;
  answer.distance_signed = is_signed;
  return answer;
}

TEST(Dial, GoesFromGreedyToExact) {
  const std::vector<Setting> settings = dial();
  EXPECT_EQ(settings.size(), 14U);
  EXPECT_EQ(settings.front().accuracy.max_leaves, 1U);
  const core::Accuracy& last = settings.back().accuracy;
  EXPECT_EQ(last.max_leaves, 0U);
  EXPECT_EQ(last.max_relative_error, 0.0);
  EXPECT_EQ(last.max_absolute_error, 0.0);
}

class Violation : public testing::Test {
 protected:
  static constexpr double kRounding = 1e-16;  // [m]
  static constexpr double kOutside = 1.0;     // [m] the truth
  static constexpr double kInside = -1.0;     // [m] the truth
  core::Accuracy leaves_ = {0.0, 0.0, 2};
};

TEST_F(Violation, IsNotWhatTheBoundsHold) {
  EXPECT_FALSE(isViolated(answerOf(1.5, 0.5, 1.5), kOutside, leaves_, kRounding));
  EXPECT_FALSE(isViolated(answerOf(1.5, 0.5, 1.5), kInside, leaves_, kRounding));
  EXPECT_FALSE(isViolated(answerOf(-1.5, -1.5, -0.5, true), kInside, leaves_, kRounding));
}

TEST_F(Violation, IsATruthOutsideTheBounds) {
  EXPECT_TRUE(isViolated(answerOf(1.5, 1.1, 1.5), kOutside, leaves_, kRounding));
  EXPECT_TRUE(isViolated(answerOf(0.9, 0.5, 0.9), kOutside, leaves_, kRounding));
  EXPECT_TRUE(isViolated(answerOf(1.0, 0.5, 0.9), kOutside, leaves_, kRounding));
  EXPECT_TRUE(isViolated(answerOf(-1.5, -1.5, -1.1, true), kInside, leaves_, kRounding));
}

TEST_F(Violation, IsADistanceBelowTheTruth) {
  EXPECT_TRUE(isViolated(answerOf(0.9, 0.5, 1.5), kOutside, leaves_, kRounding));
}

TEST_F(Violation, IsNoSideOfATruthThatMayBeRounding) {
  EXPECT_FALSE(isViolated(answerOf(0.0, 0.0, 0.0, true), -0.5 * kRounding, leaves_, kRounding));
}

TEST_F(Violation, IsADistanceBeyondThePromise) {
  const core::Accuracy relative = {0.1, 0.0, 0};
  const core::Accuracy absolute = {0.0, 0.2, 0};
  EXPECT_FALSE(isViolated(answerOf(1.09, 0.9, 1.09), kOutside, relative, kRounding));
  EXPECT_TRUE(isViolated(answerOf(1.11, 0.9, 1.11), kOutside, relative, kRounding));
  EXPECT_FALSE(isViolated(answerOf(1.19, 0.9, 1.19), kOutside, absolute, kRounding));
  EXPECT_TRUE(isViolated(answerOf(1.21, 0.9, 1.21), kOutside, absolute, kRounding));
}

TEST_F(Violation, IsAWrongSideThatIsCalledProven) {
  EXPECT_TRUE(isViolated(answerOf(1.5, 0.5, 1.5, true), kInside, leaves_, kRounding));
  EXPECT_TRUE(isViolated(answerOf(-1.5, -1.5, -0.5, true), kOutside, leaves_, kRounding));
}

TEST(MeasureBand, FindsNoErrorAndNoGapOfExactAnswers) {
  const CollisionMesh organ(test::blob(3));
  const BandTrade band = measured(organ, tipsAround(120));
  const Summary& exact = band.summaries.back();
  EXPECT_EQ(exact.recall, 1.0);
  EXPECT_EQ(exact.error_max, 0.0);
  EXPECT_EQ(exact.gap_p99, 0.0);
}

TEST(MeasureBand, CountsNoViolationsOfAnySetting) {
  for (const core::TriangleMesh& mesh : {test::blob(3), test::grid(9, 7), test::row(40)}) {
    const CollisionMesh organ(mesh);
    for (const Samples& samples : measured(organ, tipsAround(120)).samples) {
      EXPECT_EQ(samples.violations, 0U);
    }
  }
}

TEST(MeasureBand, MeasuresTheErrorThatTheGreedySearchMakes) {
  const CollisionMesh organ(test::blob(3));
  const core::Points tips = tipsAround(120);
  const Samples greedy = measured(organ, tips).samples.front();
  ASSERT_EQ(greedy.errors.size(), tips.size());
  for (std::size_t i = 0; i < tips.size(); ++i) {
    const double found =
        std::abs(nearestTriangle(organ, tips[i], core::Accuracy::greedy()).distance);
    const double nearest = std::abs(nearestTriangle(organ, tips[i]).distance);
    EXPECT_NEAR(greedy.errors[i], found - nearest, 1e-15);  // [m] what rounding may hide
    EXPECT_EQ(greedy.work[i].triangles, 1U);
    EXPECT_GT(greedy.times[i], 0.0);
  }
  EXPECT_GT(mean(greedy.errors), 0.0);
}

TEST(MeasureBand, TakesNoRoundingForAnError) {
  // All faces are as near to the middle, but for rounding.
  const CollisionMesh organ(test::cube(0.1));
  const double ulp = 0x1p-57;  // [m] of 0.05
  core::Points tips;
  for (const double x : {-2.0, -1.0, 0.0, 1.0, 2.0}) {
    for (const double y : {-2.0, -1.0, 0.0, 1.0, 2.0}) {
      tips.emplace_back(0.05 + x * ulp, 0.05 + y * ulp, 0.05 - 2.0 * ulp);
    }
  }
  const auto differs = [&](const Eigen::Vector3d& tip) {
    return std::abs(nearestTriangle(organ, tip, core::Accuracy::greedy()).distance) !=
           std::abs(nearestTriangle(organ, tip).distance);
  };
  ASSERT_TRUE(std::any_of(tips.begin(), tips.end(), differs)) << "nothing is rounded here";
  EXPECT_EQ(measured(organ, tips).summaries.front().recall, 1.0);
}

TEST(MeasureBand, LeavesOutNoTipOfTheLastBlock) {
  const CollisionMesh organ(test::blob(1));
  std::size_t done = 0;
  const BandTrade band =
      measureBand(organ, "band", tipsAround(101), kSeed, [&](std::size_t tips) { done += tips; });
  EXPECT_EQ(done, 101U);
  EXPECT_EQ(band.tipCount(), 101U);
}

TEST(MeasureBand, HasNothingToSayOfNoTips) {
  const BandTrade band = measured(CollisionMesh(test::blob(1)), {});
  EXPECT_EQ(band.tipCount(), 0U);
  EXPECT_TRUE(band.summaries.empty());
}

TEST(MeasureBand, HasNoConfidenceWhereTheTipsAreNotIndependent) {
  const CollisionMesh organ(test::blob(1));
  const BandTrade path =
      measureBand(organ, "path", tipsAround(20), std::nullopt, [](std::size_t) {});
  for (const Summary& summary : path.summaries) EXPECT_FALSE(summary.confidence);
  for (const Summary& summary : measured(organ, tipsAround(20)).summaries) {
    EXPECT_TRUE(summary.confidence);
  }
}

/// Errors of 0, but for the last 40 of 100.
Samples hundredSamples() {
  Samples samples;
  for (int i = 1; i <= 100; ++i) {
    samples.times.push_back(i);
    samples.errors.push_back(i <= 60 ? 0.0 : i);
    samples.gaps.push_back(2.0 * i);
    samples.work.push_back({3, 1});
  }
  return samples;
}

TEST(Summarise, TellsWhatTheSamplesAre) {
  const Summary summary = summarise(hundredSamples());
  EXPECT_EQ(summary.time_median, 50.0);
  EXPECT_EQ(summary.time_p99, 99.0);
  EXPECT_EQ(summary.bounds, 3.0);
  EXPECT_EQ(summary.triangles, 1.0);
  EXPECT_EQ(summary.recall, 0.6);
  EXPECT_EQ(summary.error_mean, 32.2);
  EXPECT_EQ(summary.error_p50, 0.0);
  EXPECT_EQ(summary.error_p99, 99.0);
  EXPECT_EQ(summary.error_p999, 100.0);
  EXPECT_EQ(summary.error_max, 100.0);
  EXPECT_EQ(summary.gap_mean, 101.0);
  EXPECT_EQ(summary.gap_p99, 198.0);
}

TEST(ConfidenceIn, SurroundsWhatTheSamplesAre) {
  std::mt19937_64 generator(kSeed);
  const Confidence confidence = confidenceIn(hundredSamples(), generator);
  EXPECT_LT(confidence.recall.low, 0.6);
  EXPECT_GT(confidence.recall.high, 0.6);
  EXPECT_LT(confidence.error_mean.low, 32.2);
  EXPECT_GT(confidence.error_mean.high, 32.2);
  EXPECT_LT(confidence.error_p99.low, 99.0);
  EXPECT_GT(confidence.error_p99.high, 99.0);
  EXPECT_TRUE(std::isinf(confidence.error_p999_limit)) << "100 are too few";
}

TEST(TieTolerance, AllowsBothDistancesThePromisedError) {
  EXPECT_EQ(tieTolerance(0.5), 2 * 4 * 0x1p-53 * 0.5);
}

TEST(MeasureCosts, TimesWhatItDoes) {
  const Costs costs = measureCosts(CollisionMesh(test::blob(4)), 7.0);
  EXPECT_EQ(costs.build, 7.0);
  EXPECT_GT(costs.refit, 0.0);
  EXPECT_GT(costs.rebuild, costs.refit);
  EXPECT_GT(costs.memory, 36.0);  // three coordinates of half a vertex, three corners, a box
}

}  // namespace
}  // namespace organ_collision::tools
