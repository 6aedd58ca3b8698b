#include "tools/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace organ_collision::tools {
namespace {

std::vector<double> upTo(std::size_t count) {
  std::vector<double> numbers(count);
  std::iota(numbers.rbegin(), numbers.rend(), 1.0);  // not in order
  return numbers;
}

std::vector<double> exponential(std::size_t count, std::mt19937_64& generator) {
  std::exponential_distribution<double> draw(1.0);
  std::vector<double> samples(count);
  std::generate(samples.begin(), samples.end(), [&] { return draw(generator); });
  return samples;
}

TEST(Percentile, IsTheNearestRank) {
  EXPECT_EQ(percentile(upTo(100), 0.99), 99.0);
  EXPECT_EQ(percentile(upTo(100), 1.0), 100.0);
  EXPECT_EQ(percentile(upTo(100), 0.0), 1.0);
  EXPECT_EQ(percentile(upTo(10), 0.99), 10.0);
  EXPECT_EQ(percentile({7.0}, 0.5), 7.0);
}

TEST(Median, IsTheLowerOfTwoInTheMiddle) {
  EXPECT_EQ(median(upTo(5)), 3.0);
  EXPECT_EQ(median(upTo(6)), 3.0);
}

TEST(Mean, IsTheSumOverTheCount) { EXPECT_EQ(mean(upTo(4)), 2.5); }

TEST(WilsonInterval, AgreesWithPublishedValues) {
  constexpr double kPrinted = 5e-5;  // four digits
  EXPECT_NEAR(wilsonInterval(5, 10).low, 0.2366, kPrinted);
  EXPECT_NEAR(wilsonInterval(5, 10).high, 0.7634, kPrinted);
  EXPECT_NEAR(wilsonInterval(10, 10).low, 0.7225, kPrinted);
  EXPECT_DOUBLE_EQ(wilsonInterval(10, 10).high, 1.0);
  EXPECT_EQ(wilsonInterval(0, 10).low, 0.0);
  EXPECT_NEAR(wilsonInterval(0, 10).high, 0.2775, kPrinted);
}

/// How many of `trials` intervals, made of exponentially distributed samples, hold `truth`.
template <class IntervalOf>
int coverage(double truth, int trials, const IntervalOf& intervalOf) {
  std::mt19937_64 generator(3);
  int covered = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Interval interval = intervalOf(exponential(400, generator), generator);
    covered += interval.low <= truth && truth <= interval.high ? 1 : 0;
  }
  return covered;
}

// Of 300 intervals at 95 %, 285 hold the truth, give or take 4; the bootstrap is known to be a
// little narrow for skew samples.
constexpr int kTrials = 300;
constexpr int kFewest = 270;
constexpr int kMost = 296;

TEST(WilsonInterval, StaysBetweenNoneAndAll) {
  for (std::size_t trials = 1; trials < 1000; ++trials) {
    EXPECT_GE(wilsonInterval(0, trials).low, 0.0) << trials;
    EXPECT_LE(wilsonInterval(trials, trials).high, 1.0) << trials;
  }
}

TEST(BootstrapMean, HoldsTheTrueMeanNineteenTimesInTwenty) {
  const int covered = coverage(1.0, kTrials, bootstrapMean);
  EXPECT_GE(covered, kFewest);
  EXPECT_LE(covered, kMost);
}

TEST(BootstrapMean, AllowsForTheNumberOfZeros) {
  std::vector<double> samples(1000, 0.0);
  std::fill_n(samples.begin(), 100, 1.0);
  std::mt19937_64 generator(1);
  const Interval interval = bootstrapMean(samples, generator);
  // Binomial: 100 +- 1.96 * sqrt(1000 * 0.1 * 0.9) = 100 +- 18.6.
  EXPECT_NEAR(interval.low, 0.0814, 0.003);
  EXPECT_NEAR(interval.high, 0.1186, 0.003);
}

TEST(BootstrapMean, OfEqualSamplesIsThatSample) {
  std::mt19937_64 generator(1);
  const Interval zeros = bootstrapMean(std::vector<double>(10, 0.0), generator);
  const Interval twos = bootstrapMean(std::vector<double>(10, 2.0), generator);
  EXPECT_EQ(zeros.low, 0.0);
  EXPECT_EQ(zeros.high, 0.0);
  EXPECT_EQ(twos.low, 2.0);
  EXPECT_EQ(twos.high, 2.0);
}

TEST(BootstrapPercentile, HoldsTheTruePercentileNineteenTimesInTwenty) {
  const auto ninetieth = [](const std::vector<double>& samples, std::mt19937_64&) {
    return bootstrapPercentile(samples, 0.9);
  };
  const int covered = coverage(-std::log(0.1), kTrials, ninetieth);
  EXPECT_GE(covered, kFewest);
  EXPECT_LE(covered, kMost);
}

TEST(BootstrapPercentile, IsWhatManyResamplesTendTo) {
  std::mt19937_64 generator(5);
  const std::vector<double> samples = upTo(500);
  std::uniform_int_distribution<std::size_t> draw(0, samples.size() - 1);
  std::vector<double> percentiles;
  for (int i = 0; i < 20'000; ++i) {
    std::vector<double> resample(samples.size());
    std::generate(resample.begin(), resample.end(), [&] { return samples[draw(generator)]; });
    percentiles.push_back(percentile(resample, 0.9));
  }
  constexpr double kNeighbour = 1.0;  // ranks: 20,000 resamples tell no better
  const Interval interval = bootstrapPercentile(samples, 0.9);
  EXPECT_NEAR(interval.low, percentile(percentiles, 0.025), kNeighbour);
  EXPECT_NEAR(interval.high, percentile(percentiles, 0.975), kNeighbour);
}

TEST(BootstrapPercentile, OfTwoSamplesIsBetweenThem) {
  const Interval of_median = bootstrapPercentile({0.0, 1.0}, 0.5);
  EXPECT_EQ(of_median.low, 0.0);  // that of three resamples in four
  EXPECT_EQ(of_median.high, 1.0);
}

TEST(BootstrapPercentile, OfTheMaximumEndsAtTheMaximum) {
  EXPECT_EQ(bootstrapPercentile(upTo(100), 1.0).high, 100.0);
}

TEST(PercentileUpperLimit, IsUnknownForTooFewSamples) {
  EXPECT_EQ(percentileUpperLimit(upTo(2994), 0.999), std::numeric_limits<double>::infinity());
  EXPECT_EQ(percentileUpperLimit(upTo(2995), 0.999), 2995.0);
}

TEST(PercentileUpperLimit, IsWrongAtMostOnceInTwenty) {
  const auto below = [](const std::vector<double>& samples, std::mt19937_64&) {
    return Interval{0.0, percentileUpperLimit(samples, 0.9)};
  };
  const int covered = coverage(-std::log(0.1), kTrials, below);
  EXPECT_GE(covered, 278);  // 0.95 * 300 less two standard deviations
  EXPECT_LT(covered, kTrials);
}

}  // namespace
}  // namespace organ_collision::tools
