#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "organ_collision/core/nearest_triangle.h"
#include "statistics.h"

namespace organ_collision::tools {

enum class Family : std::uint8_t { kGreedy, kLeaves, kRelative, kAbsolute, kExact };

/// A mark on the dial.
struct Setting {
  std::string name;
  Family family;
  core::Accuracy accuracy;
};

/// The marks that are measured, from the paper's greedy search to exact, which is the last.
std::vector<Setting> dial();

/// How often a setting answers a tip. The least of its times counts, so that percentiles tell how
/// tips differ, not what else the machine did.
constexpr std::size_t kRounds = 3;

/// What one setting did, tip by tip.
struct Samples {
  std::vector<double> times;   ///< [s] the least of the rounds
  std::vector<double> errors;  ///< [m] distance found - nearest distance; 0 within rounding
  std::vector<double> gaps;    ///< [m] upper_bound - lower_bound
  std::vector<core::SearchWork> work;
  std::size_t violations = 0;  ///< see isViolated()
};

/// What holds for other tips too, drawn as those that were measured, with 95 % confidence.
struct Confidence {
  Interval recall;          ///< Wilson's
  Interval error_mean;      ///< [m] bootstrap
  Interval error_p99;       ///< [m] bootstrap
  double error_p999_limit;  ///< [m] see percentileUpperLimit()
};

struct Summary {
  double time_median, time_p99;  ///< [s]
  double bounds, triangles;      ///< tests per query
  double recall;                 ///< share of answers as near as the exact one
  double error_mean;             ///< [m] here and below
  double error_p50, error_p99, error_p999, error_max;
  double gap_mean, gap_p99;
  std::optional<Confidence> confidence;  ///< where the tips are independent of each other
};

/// How far apart [m] computed distances of triangles that are equally near may be: twice what is
/// promised of each. `extent` [m]: the longest vector from the query to a corner.
double tieTolerance(double extent);

/// Whether `answer` is outside its own bounds, nearer or farther than its accuracy promises, or on
/// a side that is wrong but called proven. `truth` [m] is the true distance, negative inside;
/// `tolerance` [m] is what rounding may do.
bool isViolated(const core::NearestTriangle& answer, double truth, const core::Accuracy& accuracy,
                double tolerance);

/// Without confidence. REQUIRES: samples are not empty; here and below.
Summary summarise(const Samples& samples);

/// REQUIRES: the tips were drawn independently.
Confidence confidenceIn(const Samples& samples, std::mt19937_64& generator);

/// What every setting of dial() did with the same tips.
struct BandTrade {
  std::string name;
  std::vector<Samples> samples;
  std::vector<Summary> summaries;  ///< empty if there were no tips

  std::size_t tipCount() const { return samples.front().times.size(); }
};

/// All settings answer all tips [m], block by block, in turns whose order changes, kRounds times.
/// Exact answers are taken for the truth; some are compared with all triangles, and count as
/// violations where these are nearer. `seed`: of the resamples that confidence comes from; none
/// where tips are not independent, as those of a path. `advance` is called with the number of tips
/// done. The same seed gives the same numbers, times apart.
BandTrade measureBand(const core::CollisionMesh& organ, const std::string& name,
                      const core::Points& tips, std::optional<std::uint64_t> seed,
                      const std::function<void(std::size_t)>& advance);

/// What it costs to have and to keep the hierarchy.
struct Costs {
  double build, refit, rebuild;  ///< [s] refit and rebuild: medians
  double memory;                 ///< [bytes] per triangle
};

/// `build`: [s] what building took.
Costs measureCosts(core::CollisionMesh organ, double build);

/// [s] of wall clock that `action` takes.
double secondsOf(const std::function<void()>& action);

}  // namespace organ_collision::tools
