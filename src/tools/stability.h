#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "extremes.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/triangle_distance.h"
#include "organ_collision/core/triangle_intersection.h"
#include "reference/exact.h"

namespace organ_collision::tools {

/// What the promises are about.
enum class Subject : std::uint8_t {
  kClosestPoint,      ///< the distance of a point and a triangle
  kTriangleDistance,  ///< the distance of two triangles
  kNearest,           ///< the distance of the nearest triangle of an organ
  kRefit,             ///< the same after all vertices have moved; wrong: unlike a new hierarchy's
  kIntersection,      ///< wrong: the answer whether two triangles have a point in common
  kSign,              ///< wrong: the side of a solid organ, or that none is told
  kDial,              ///< wrong: bounds and errors that any accuracy promises
  kScaling,           ///< wrong: answers with other bits at another power of two
  kRenumbering        ///< wrong: answers that change with the order of the triangles
};

struct SubjectName {
  Subject subject;
  const char* name;
  bool is_distance;  ///< it has an error, in units of u * extent
};

constexpr std::array<SubjectName, 9> kSubjects = {{{Subject::kClosestPoint, "point", true},
                                                   {Subject::kTriangleDistance, "triangles", true},
                                                   {Subject::kNearest, "organ", true},
                                                   {Subject::kRefit, "refit", true},
                                                   {Subject::kIntersection, "meet", false},
                                                   {Subject::kSign, "sign", false},
                                                   {Subject::kDial, "dial", false},
                                                   {Subject::kScaling, "scaled", false},
                                                   {Subject::kRenumbering, "order", false}}};

/// The error that is promised of every distance, in units of u * extent: u = 2^-53, extent is the
/// longest vector from the query to a corner of the triangles that matter.
constexpr double kPromisedError = 4.0;

/// What came out of a number of trials.
struct Tally {
  std::size_t trials = 0;
  double worst = 0.0;          ///< [u * extent] the largest error
  std::size_t not_finite = 0;  ///< answers with a number in them that is not finite
  std::size_t wrong = 0;

  bool isKept() const { return worst <= kPromisedError && not_finite == 0 && wrong == 0; }
};

struct StabilityRow {
  std::string name;  ///< of the class
  std::array<Tally, kSubjects.size()> tallies;
  std::size_t depth;  ///< of the organ's hierarchy

  Tally& operator[](Subject subject) { return tallies[static_cast<std::size_t>(subject)]; }
  const Tally& operator[](Subject subject) const {
    return tallies[static_cast<std::size_t>(subject)];
  }
};

/// `found` - `truth` [u * extent].
double errorOf(double found, const core::exact::Real& truth, double extent);

/// The longest vector [m] from `point` to a corner.
double extentOf(const Eigen::Vector3d& point, const core::Triangle& triangle);
/// The longest vector [m] between two corners.
double extentOf(const core::Triangle& first, const core::Triangle& second);

/// How many trials `samples` stands for: of a point and a triangle all of them, of two triangles a
/// tenth, of an organ and a tip a hundredth, for these cost that much more.
struct Trials {
  explicit Trials(std::size_t samples)
      : points(samples), pairs(samples / 10), tips(samples / 100) {}
  std::size_t points, pairs, tips;
};

/// What is measured: the library, but where a test wants to see that its faults would be.
struct Library {
  std::function<core::ClosestPoint(const Eigen::Vector3d&, const core::Triangle&)> closest_point =
      [](const Eigen::Vector3d& query, const core::Triangle& triangle) {
        return core::closestPointOnTriangle(query, triangle);
      };
  std::function<core::ClosestPair(const core::Triangle&, const core::Triangle&)> closest_points =
      core::closestPoints;
  std::function<bool(const core::Triangle&, const core::Triangle&)> intersect =
      core::trianglesIntersect;
  std::function<core::NearestTriangle(const core::CollisionMesh&, const Eigen::Vector3d&,
                                      const core::Accuracy&)>
      nearest_triangle = [](const auto& organ, const auto& tip, const auto& accuracy) {
        return core::nearestTriangle(organ, tip, accuracy);
      };
};

/// Everything but the time is the same for the same seed. `advance` is called after every tip.
StabilityRow measureStability(const Extreme& extreme, const Trials& trials, std::uint64_t seed,
                              const std::function<void()>& advance, const Library& library = {});

}  // namespace organ_collision::tools
