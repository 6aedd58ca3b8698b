#include "trade.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "stability.h"

namespace organ_collision::tools {
namespace {

using core::NearestTriangle;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kBlock = 50;  // tips that a setting answers before the next has its turn
constexpr std::size_t kCheckedTriangles =
    10'000'000;  // measured at most to check a band's exact answers
constexpr std::size_t kCheckedTips = 100;

double secondsBetween(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

/// An answer without its sign [m].
struct Distances {
  explicit Distances(const NearestTriangle& nearest)
      : distance(std::abs(nearest.distance)),
        lower(std::min(std::abs(nearest.lower_bound), std::abs(nearest.upper_bound))),
        upper(std::max(std::abs(nearest.lower_bound), std::abs(nearest.upper_bound))) {}
  double distance, lower, upper;
};

/// The longest vector [m] from `tip` to a corner of `box`.
double extentOf(const Eigen::Vector3d& tip, const core::Box& box) {
  return (tip - box.low).cwiseAbs().cwiseMax((tip - box.high).cwiseAbs()).norm();
}

/// The longest distance [m] that `accuracy` allows where the truth is `nearest`.
double longestPromised(const core::Accuracy& accuracy, double nearest) {
  if (accuracy.max_leaves != 0) return std::numeric_limits<double>::infinity();
  return std::max((1.0 + accuracy.max_relative_error) * nearest,
                  nearest + accuracy.max_absolute_error);
}

double leastOfAllTriangles(const core::TriangleMesh& mesh, const Eigen::Vector3d& tip) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const core::Triangle triangle = mesh.triangle(static_cast<core::TriangleId>(i));
    least = std::min(least, core::closestPointOnTriangle(tip, triangle).squared_distance);
  }
  return std::sqrt(least);
}

/// The number of exact answers that are not the nearest of all triangles.
std::size_t wrongExactAnswers(const core::CollisionMesh& organ, const core::Points& tips) {
  const std::size_t affordable = 1 + kCheckedTriangles / organ.mesh().triangleCount();
  const std::size_t count = std::min({tips.size(), kCheckedTips, affordable});
  return static_cast<std::size_t>(
      std::count_if(tips.begin(), tips.begin() + static_cast<std::ptrdiff_t>(count),
                    [&](const Eigen::Vector3d& tip) {
                      return std::abs(core::nearestTriangle(organ, tip).distance) !=
                             leastOfAllTriangles(organ.mesh(), tip);
                    }));
}

/// A few tips and what all settings answer to them.
class Block {
 public:
  Block(const core::CollisionMesh& organ, const std::vector<Setting>& settings,
        const Eigen::Vector3d* tips, std::size_t count)
      : organ_(organ),
        settings_(settings),
        tips_(tips),
        count_(count),
        answers_(settings.size()),
        times_(settings.size(),
               std::vector<double>(count, std::numeric_limits<double>::infinity())) {}

  void answer(std::size_t first_setting) {
    for (std::size_t round = 0; round < kRounds; ++round) {
      for (std::size_t turn = 0; turn < settings_.size(); ++turn) {
        answerWith((first_setting + round + turn) % settings_.size());
      }
    }
  }

  void appendTo(std::vector<Samples>& samples) const {
    for (std::size_t s = 0; s < settings_.size(); ++s) {
      for (std::size_t i = 0; i < count_; ++i) {
        const NearestTriangle& answer = answers_[s][i];
        const NearestTriangle& exact = answers_.back()[i];
        const double tolerance = tieTolerance(extentOf(tips_[i], organ_.health().box));
        const double error = std::abs(answer.distance) - std::abs(exact.distance);
        samples[s].times.push_back(times_[s][i]);
        samples[s].errors.push_back(error <= tolerance ? 0.0 : error);
        samples[s].gaps.push_back(answer.upper_bound - answer.lower_bound);
        samples[s].work.push_back(answer.work);
        samples[s].violations +=
            isViolated(answer, exact.distance, settings_[s].accuracy, tolerance) ? 1 : 0;
      }
    }
  }

 private:
  void answerWith(std::size_t s) {
    answers_[s].clear();
    for (std::size_t i = 0; i < count_; ++i) {
      const auto start = Clock::now();
      const NearestTriangle answer = core::nearestTriangle(organ_, tips_[i], settings_[s].accuracy);
      times_[s][i] = std::min(times_[s][i], secondsBetween(start, Clock::now()));
      answers_[s].push_back(answer);
    }
  }

  const core::CollisionMesh& organ_;
  const std::vector<Setting>& settings_;
  const Eigen::Vector3d* tips_;
  std::size_t count_;
  std::vector<std::vector<NearestTriangle>> answers_;  // of each setting to each tip
  std::vector<std::vector<double>> times_;             // [s] likewise
};

std::size_t foundNearest(const Samples& samples) {
  return static_cast<std::size_t>(std::count(samples.errors.begin(), samples.errors.end(), 0.0));
}

}  // namespace

std::vector<Setting> dial() {
  return {{"greedy", Family::kGreedy, core::Accuracy::greedy()},
          {"2 leaves", Family::kLeaves, {0.0, 0.0, 2}},
          {"4 leaves", Family::kLeaves, {0.0, 0.0, 4}},
          {"8 leaves", Family::kLeaves, {0.0, 0.0, 8}},
          {"16 leaves", Family::kLeaves, {0.0, 0.0, 16}},
          {"64 leaves", Family::kLeaves, {0.0, 0.0, 64}},
          {"10 %", Family::kRelative, {0.1, 0.0, 0}},
          {"5 %", Family::kRelative, {0.05, 0.0, 0}},
          {"1 %", Family::kRelative, {0.01, 0.0, 0}},
          {"0.1 %", Family::kRelative, {0.001, 0.0, 0}},
          {"1 mm", Family::kAbsolute, {0.0, 1e-3, 0}},
          {"0.1 mm", Family::kAbsolute, {0.0, 1e-4, 0}},
          {"0.01 mm", Family::kAbsolute, {0.0, 1e-5, 0}},
          {"exact", Family::kExact, core::Accuracy::exact()}};
}

double tieTolerance(double extent) { return 2.0 * kPromisedError * core::kUnit * extent; }

Summary summarise(const Samples& samples) {
  const auto count = static_cast<double>(samples.errors.size());
  double bounds = 0.0;
  double triangles = 0.0;
  for (const core::SearchWork& work : samples.work) {
    bounds += work.bounds;
    triangles += work.triangles;
  }
  Summary summary{};
  summary.time_median = median(samples.times);
  summary.time_p99 = percentile(samples.times, 0.99);
  summary.bounds = bounds / count;
  summary.triangles = triangles / count;
  summary.recall = static_cast<double>(foundNearest(samples)) / count;
  summary.error_mean = mean(samples.errors);
  summary.error_p50 = median(samples.errors);
  summary.error_p99 = percentile(samples.errors, 0.99);
  summary.error_p999 = percentile(samples.errors, 0.999);
  summary.error_max = percentile(samples.errors, 1.0);
  summary.gap_mean = mean(samples.gaps);
  summary.gap_p99 = percentile(samples.gaps, 0.99);
  return summary;
}

Confidence confidenceIn(const Samples& samples, std::mt19937_64& generator) {
  const std::vector<double>& errors = samples.errors;
  return {wilsonInterval(foundNearest(samples), errors.size()), bootstrapMean(errors, generator),
          bootstrapPercentile(errors, 0.99), percentileUpperLimit(errors, 0.999)};
}

bool isViolated(const NearestTriangle& answer, double truth, const core::Accuracy& accuracy,
                double tolerance) {
  const Distances found(answer);
  const double nearest = std::abs(truth);
  const bool wrong_side = answer.distance_signed && nearest > tolerance &&
                          std::signbit(answer.distance) != std::signbit(truth);
  return wrong_side || found.lower > nearest + tolerance || found.upper < nearest - tolerance ||
         found.distance < nearest - tolerance ||
         found.distance > longestPromised(accuracy, nearest) + tolerance;
}

BandTrade measureBand(const core::CollisionMesh& organ, const std::string& name,
                      const core::Points& tips, std::optional<std::uint64_t> seed,
                      const std::function<void(std::size_t)>& advance) {
  const std::vector<Setting> settings = dial();
  BandTrade band{name, std::vector<Samples>(settings.size()), {}};
  for (std::size_t first = 0; first < tips.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, tips.size() - first);
    Block block(organ, settings, &tips[first], count);
    block.answer(first / kBlock);
    block.appendTo(band.samples);
    advance(count);
  }
  band.samples.back().violations += wrongExactAnswers(organ, tips);
  if (tips.empty()) return band;
  for (const Samples& samples : band.samples) band.summaries.push_back(summarise(samples));
  if (!seed) return band;
  std::mt19937_64 generator(*seed);
  for (std::size_t s = 0; s < settings.size(); ++s) {
    band.summaries[s].confidence = confidenceIn(band.samples[s], generator);
  }
  return band;
}

double secondsOf(const std::function<void()>& action) {
  const auto start = Clock::now();
  action();
  return secondsBetween(start, Clock::now());
}

Costs measureCosts(core::CollisionMesh organ, double build) {
  constexpr std::size_t kRefits = 9;
  constexpr std::size_t kRebuilds = 3;
  const double memory =
      static_cast<double>(organ.memory()) / static_cast<double>(organ.mesh().triangleCount());
  std::vector<double> refits;
  std::vector<double> rebuilds;
  for (std::size_t i = 0; i < kRefits; ++i) {
    core::Points positions = organ.mesh().positions();
    refits.push_back(secondsOf([&] { organ.refit(std::move(positions)); }));
  }
  for (std::size_t i = 0; i < kRebuilds; ++i) {
    rebuilds.push_back(secondsOf([&] { organ.rebuild(); }));
  }
  return {build, median(refits), median(rebuilds), memory};
}

}  // namespace organ_collision::tools
