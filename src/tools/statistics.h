#pragma once

#include <cstddef>
#include <random>
#include <utility>
#include <vector>

namespace organ_collision::tools {

/// A 95 % confidence interval.
struct Interval {
  double low, high;
};

/// REQUIRES: samples are not empty; here and below.
double mean(const std::vector<double>& samples);

/// The least sample that at least `share` (0 to 1) of all samples do not exceed, the nearest rank:
/// of 1 to 100 the percentile 0.99 is 99.
double percentile(std::vector<double> samples, double share);

inline double median(std::vector<double> samples) { return percentile(std::move(samples), 0.5); }

/// Where the share that `successes` of `trials` stand for lies.
/// Source: E. B. Wilson, "Probable inference, the law of succession, and statistical inference"
/// (1927).
Interval wilsonInterval(std::size_t successes, std::size_t trials);

/// Where the mean lies, by 1000 resamples drawn with `generator`. Cost: 1000 n draws.
/// Source: B. Efron, "Bootstrap methods: another look at the jackknife" (1979).
Interval bootstrapMean(const std::vector<double>& samples, std::mt19937_64& generator);

/// Where a percentile lies: what the bootstrap tends to for many resamples, in closed form, for the
/// rank of a resample's percentile is binomially distributed. Never beyond the largest sample.
Interval bootstrapPercentile(std::vector<double> samples, double share);

/// What the percentile stays below, with 95 % confidence and whatever the distribution is: an order
/// statistic, or infinity where the samples are too few to tell (below 2995 for 0.999).
double percentileUpperLimit(std::vector<double> samples, double share);

}  // namespace organ_collision::tools
