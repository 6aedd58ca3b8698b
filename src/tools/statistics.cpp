#include "statistics.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

namespace organ_collision::tools {
namespace {

constexpr double kNormalQuantile = 1.959963984540054;  // of 0.975
constexpr double kTail = 0.025;                        // beyond each end of an interval
constexpr double kOneTail = 0.05;                      // beyond a limit that has one end only
constexpr std::size_t kResamples = 1000;

/// Index of the nearest rank in `count` sorted samples.
std::size_t rankIndex(double share, std::size_t count) {
  const double rank = std::ceil(share * static_cast<double>(count));
  return rank < 1.0 ? 0 : std::min(static_cast<std::size_t>(rank), count) - 1;
}

/// Probability of at most `most` successes in `trials`, each of probability `share`.
double binomialUpTo(std::size_t most, std::size_t trials, double share) {
  if (most >= trials) return 1.0;
  return boost::math::cdf(boost::math::binomial(static_cast<double>(trials), share),
                          static_cast<double>(most));
}

}  // namespace

double mean(const std::vector<double>& samples) {
  assert(!samples.empty());
  return std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
}

double percentile(std::vector<double> samples, double share) {
  assert(!samples.empty());
  const auto ranked =
      samples.begin() + static_cast<std::ptrdiff_t>(rankIndex(share, samples.size()));
  std::nth_element(samples.begin(), ranked, samples.end());
  return *ranked;
}

Interval wilsonInterval(std::size_t successes, std::size_t trials) {
  assert(trials > 0 && successes <= trials);
  const auto n = static_cast<double>(trials);
  const double share = static_cast<double>(successes) / n;
  const double z_squared = kNormalQuantile * kNormalQuantile;
  const double centre = share + z_squared / (2.0 * n);
  const double reach =
      kNormalQuantile * std::sqrt(share * (1.0 - share) / n + z_squared / (4.0 * n * n));
  const double weight = 1.0 + z_squared / n;
  return {std::max(0.0, (centre - reach) / weight), std::min(1.0, (centre + reach) / weight)};
}

Interval bootstrapMean(const std::vector<double>& samples, std::mt19937_64& generator) {
  assert(!samples.empty());
  // How many zeros a resample has is drawn at once: errors are mostly 0.
  std::vector<double> others;
  std::copy_if(samples.begin(), samples.end(), std::back_inserter(others),
               [](double sample) { return sample != 0.0; });
  if (others.empty()) return {0.0, 0.0};
  const auto count = static_cast<double>(samples.size());
  std::binomial_distribution<std::size_t> how_many(samples.size(),
                                                   static_cast<double>(others.size()) / count);
  std::uniform_int_distribution<std::size_t> which(0, others.size() - 1);
  std::vector<double> means(kResamples);
  for (double& resampled : means) {
    double sum = 0.0;
    for (std::size_t left = how_many(generator); left > 0; --left) sum += others[which(generator)];
    resampled = sum / count;
  }
  return {percentile(means, kTail), percentile(means, 1.0 - kTail)};
}

Interval bootstrapPercentile(std::vector<double> samples, double share) {
  assert(!samples.empty());
  std::sort(samples.begin(), samples.end());
  const std::size_t count = samples.size();
  const std::size_t above = count - 1 - rankIndex(share, count);
  // A resample's percentile is at most a sample if no more than `above` of its draws lie beyond.
  const auto quantile = [&](double probability) {
    return *std::partition_point(samples.begin(), samples.end() - 1, [&](const double& sample) {
      const auto beyond = static_cast<double>(&samples.back() - &sample);
      return binomialUpTo(above, count, beyond / static_cast<double>(count)) < probability;
    });
  };
  return {quantile(kTail), quantile(1.0 - kTail)};
}

double percentileUpperLimit(std::vector<double> samples, double share) {
  assert(!samples.empty());
  const std::size_t count = samples.size();
  // The sample that `above` others exceed is itself below the percentile only if no more than
  // `above` samples are beyond it.
  if (binomialUpTo(0, count, 1.0 - share) > kOneTail)
    return std::numeric_limits<double>::infinity();
  std::size_t above = 0;
  while (above + 1 < count && binomialUpTo(above + 1, count, 1.0 - share) <= kOneTail) ++above;
  std::sort(samples.begin(), samples.end());
  return samples[count - 1 - above];
}

}  // namespace organ_collision::tools
