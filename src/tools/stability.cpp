#include "stability.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <random>

#include "trade.h"

namespace organ_collision::tools {
namespace {

using core::CollisionMesh;
using core::kUnit;
using core::NearestTriangle;
using core::Points;
using core::Triangle;
using core::TriangleMesh;
using Eigen::Vector3d;
using Random = Extreme::Random;

// Other powers of two, far enough to change every digit in decimals, near enough for no class to
// reach denormals.
constexpr std::array<double, 2> kFactors = {0x1p-64, 0x1p+64};

bool isFinite(const core::ClosestPoint& closest) {
  return closest.point.allFinite() && closest.offset.allFinite() &&
         closest.barycentric.allFinite() && std::isfinite(closest.squared_distance);
}

bool isFinite(const NearestTriangle& nearest) {
  return isFinite(nearest.closest) && nearest.tip_point.allFinite() && nearest.normal.allFinite() &&
         std::isfinite(nearest.distance) && std::isfinite(nearest.lower_bound) &&
         std::isfinite(nearest.upper_bound);
}

void count(Tally& tally, bool is_right, bool is_finite = true) {
  ++tally.trials;
  if (!is_right) ++tally.wrong;
  if (!is_finite) ++tally.not_finite;
}

/// Takes the error of an answer that is finite.
void countError(Tally& tally, double error, bool is_finite, bool is_right = true) {
  count(tally, is_right, is_finite);
  if (is_finite) tally.worst = std::max(tally.worst, error);
}

bool sameBits(const core::ClosestPoint& closest, double factor, const core::ClosestPoint& scaled) {
  return factor * closest.point == scaled.point && factor * closest.offset == scaled.offset &&
         closest.barycentric == scaled.barycentric && closest.feature == scaled.feature &&
         factor * factor * closest.squared_distance == scaled.squared_distance;
}

bool sameDistances(const NearestTriangle& nearest, double factor, const NearestTriangle& other) {
  return factor * nearest.closest.point == other.closest.point &&
         factor * nearest.distance == other.distance &&
         factor * nearest.lower_bound == other.lower_bound &&
         factor * nearest.upper_bound == other.upper_bound;
}

// ---- triangles

void measurePoint(const Library& library, const core::Sample& sample, StabilityRow& row) {
  const auto& [query, triangle] = sample;
  const core::ClosestPoint closest = library.closest_point(query, triangle);
  const double error = errorOf(std::sqrt(closest.squared_distance),
                               core::exact::distance(query, triangle), extentOf(query, triangle));
  countError(row[Subject::kClosestPoint], error, isFinite(closest));
  for (const double factor : kFactors) {
    count(
        row[Subject::kScaling],
        sameBits(closest, factor, library.closest_point(factor * query, scaled(triangle, factor))));
  }
}

void measurePair(const Library& library, const Triangle& first, const Triangle& second,
                 StabilityRow& row) {
  const core::ClosestPair pair = library.closest_points(first, second);
  const core::exact::Real truth = core::exact::distance(first, second);
  const double error =
      errorOf(std::sqrt(pair.on_second.squared_distance), truth, extentOf(first, second));
  countError(row[Subject::kTriangleDistance], error,
             isFinite(pair.on_second) && pair.point_on_first.allFinite());
  count(row[Subject::kIntersection], library.intersect(first, second) == (truth == 0));
}

// ---- organs

/// The same hierarchy for other positions: the vertices in reverse order moved to where they
/// belong.
CollisionMesh refitted(const TriangleMesh& mesh) {
  Points reversed(mesh.positions().rbegin(), mesh.positions().rend());
  CollisionMesh organ(TriangleMesh(reversed, mesh.triangles()));
  organ.refit(mesh.positions());
  return organ;
}

CollisionMesh scaled(const TriangleMesh& mesh, double factor) {
  Points points = mesh.positions();
  for (Vector3d& point : points) point *= factor;
  return CollisionMesh(TriangleMesh(points, mesh.triangles()));
}

CollisionMesh renumbered(const TriangleMesh& mesh) {
  std::vector<core::Corners> triangles = mesh.triangles();
  std::shuffle(triangles.begin(), triangles.end(), std::mt19937(1));
  return CollisionMesh(TriangleMesh(mesh.positions(), triangles));
}

/// One organ in all its guises, and what they answer.
class OrganTrial {
 public:
  OrganTrial(const Library& library, const TriangleMesh& mesh, StabilityRow& row)
      : library_(library),
        row_(row),
        built_(mesh),
        refitted_(refitted(mesh)),
        renumbered_(renumbered(mesh)),
        scaled_({scaled(mesh, kFactors[0]), scaled(mesh, kFactors[1])}) {
    row.depth = built_.tree().depth();
  }

  void measure(const Vector3d& tip) {
    const core::exact::Nearest truth = core::exact::nearest(built_.mesh(), tip);
    const NearestTriangle exact = nearest(built_, tip);
    const double distance = std::abs(exact.distance);
    const double error = errorOf(distance, truth.distance, extent(tip, exact, truth));
    countError(row_[Subject::kNearest], error, isFinite(exact), exact.isExact());
    measureRefit(tip, truth, distance);
    const bool inside = isInside(tip, truth);
    if (built_.health().isSolid() && truth.distance > 0) {
      const bool is_right = exact.distance == 0.0 || (exact.distance < 0.0) == inside;
      count(row_[Subject::kSign], exact.distance_signed && is_right);
    }
    measureDial(tip, truth, inside);
    measureGuises(tip, exact);
  }

 private:
  NearestTriangle nearest(const CollisionMesh& organ, const Vector3d& tip,
                          const core::Accuracy& accuracy = {}) const {
    return library_.nearest_triangle(organ, tip, accuracy);
  }

  double extent(const Vector3d& tip, const NearestTriangle& found,
                const core::exact::Nearest& truth) const {
    return std::max(extentOf(tip, built_.mesh().triangle(found.triangle)),
                    extentOf(tip, built_.mesh().triangle(truth.triangle)));
  }

  bool isInside(const Vector3d& tip, const core::exact::Nearest& truth) const {
    return built_.health().isSolid() && truth.distance > 0 &&
           core::exact::windingNumber(built_.mesh(), tip) != 0;
  }

  void measureRefit(const Vector3d& tip, const core::exact::Nearest& truth, double distance) {
    const NearestTriangle answer = nearest(refitted_, tip);
    const double found = std::abs(answer.distance);
    countError(row_[Subject::kRefit], errorOf(found, truth.distance, extent(tip, answer, truth)),
               isFinite(answer), found == distance);
  }

  void measureDial(const Vector3d& tip, const core::exact::Nearest& truth, bool inside) {
    const auto distance = static_cast<double>(truth.distance);
    for (const Setting& setting : settings_) {
      const NearestTriangle answer = nearest(built_, tip, setting.accuracy);
      const double rounding =
          kUnit * (kPromisedError * extent(tip, answer, truth) + distance);  // of `distance` too
      count(row_[Subject::kDial],
            !isViolated(answer, inside ? -distance : distance, setting.accuracy, rounding),
            isFinite(answer));
    }
  }

  void measureGuises(const Vector3d& tip, const NearestTriangle& exact) {
    const NearestTriangle greedy = nearest(built_, tip, core::Accuracy::greedy());
    for (std::size_t i = 0; i < kFactors.size(); ++i) {
      const NearestTriangle other = nearest(scaled_[i], kFactors[i] * tip);
      count(row_[Subject::kScaling], sameDistances(exact, kFactors[i], other) &&
                                         sameBits(exact.closest, kFactors[i], other.closest) &&
                                         exact.normal == other.normal);
    }
    count(row_[Subject::kRenumbering],
          sameDistances(exact, 1.0, nearest(renumbered_, tip)) &&
              sameDistances(greedy, 1.0, nearest(renumbered_, tip, core::Accuracy::greedy())));
  }

  const Library& library_;
  StabilityRow& row_;
  const std::vector<Setting> settings_ = dial();
  const CollisionMesh built_, refitted_, renumbered_;
  const std::array<CollisionMesh, kFactors.size()> scaled_;
};

}  // namespace

double errorOf(double found, const core::exact::Real& truth, double extent) {
  const core::exact::Real error = abs(core::exact::Real(found) - truth);
  return error == 0 ? 0.0 : static_cast<double>(error / (core::exact::Real(kUnit) * extent));
}

double extentOf(const Vector3d& point, const Triangle& triangle) {
  return std::max({(triangle.a - point).stableNorm(), (triangle.b - point).stableNorm(),
                   (triangle.c - point).stableNorm()});
}

double extentOf(const Triangle& first, const Triangle& second) {
  double extent = 0.0;
  for (const Triangle& triangle : {first, second}) {
    for (const Vector3d& corner : {first.a, first.b, first.c, second.a, second.b, second.c})
      extent = std::max(extent, extentOf(corner, triangle));
  }
  return extent;
}

StabilityRow measureStability(const Extreme& extreme, const Trials& trials, std::uint64_t seed,
                              const std::function<void()>& advance, const Library& library) {
  StabilityRow row{extreme.name, {}, 0};
  Random random(seed);
  for (std::size_t i = 0; extreme.sample && i < trials.points; ++i)
    measurePoint(library, extreme.sample(random), row);
  for (std::size_t i = 0; extreme.pair && i < trials.pairs; ++i) {
    const auto [first, second] = extreme.pair(random);
    measurePair(library, first, second, row);
  }
  OrganTrial organ(library, extreme.organ, row);
  for (std::size_t i = 0; i < trials.tips; ++i) {
    organ.measure(extreme.tip(random, extreme.organ));
    advance();
  }
  return row;
}

}  // namespace organ_collision::tools
