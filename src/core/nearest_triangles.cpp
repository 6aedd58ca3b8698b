#include "organ_collision/core/nearest_triangles.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "core/for_each.h"

namespace organ_collision::core {
namespace {

/// Points to a task: less takes longer to hand over than to search.
constexpr std::size_t kTask = 64;

/// Cells along each axis: a power of two.
constexpr std::uint32_t kAxisBits = 7;

/// The seven lowest bits of `number`, two places apart.
std::uint32_t spread(std::uint32_t number) {
  number = (number | number << 8U) & 0x0000700FU;
  number = (number | number << 4U) & 0x000430C3U;
  return (number | number << 2U) & 0x00049249U;
}

/// Where a point is on a curve through the cells of the box around an organ twice its size. Source:
/// G. M. Morton, "A computer oriented geodetic data base" (1966).
std::uint32_t placeOnCurve(const Eigen::Vector3d& unit_point) {
  const auto cell = [](double coordinate) {
    constexpr double kCells = 1U << kAxisBits;
    return static_cast<std::uint32_t>(
        std::clamp((coordinate / 2.0 + 1.0) / 2.0 * kCells, 0.0, kCells - 1.0));
  };
  return spread(cell(unit_point.x())) << 2U | spread(cell(unit_point.y())) << 1U |
         spread(cell(unit_point.z()));
}

struct Place {
  std::uint32_t on_curve;
  std::uint32_t point;
};

/// In the order of the curve: digit by digit, as comparing two places would guess wrongly half of
/// the time.
void sortAlongCurve(std::vector<Place>& places) {
  constexpr std::uint32_t kDigitBits = 7;
  constexpr std::uint32_t kDigits = 1U << kDigitBits;
  std::vector<Place> sorted(places.size());
  for (std::uint32_t shift = 0; shift < 3 * kAxisBits; shift += kDigitBits) {
    const auto digit = [shift](const Place& place) {
      return place.on_curve >> shift & (kDigits - 1);
    };
    std::array<std::uint32_t, kDigits> next = {};  // of each digit: how many, then where to
    for (const Place& place : places) ++next[digit(place)];
    std::exclusive_scan(next.begin(), next.end(), next.begin(), 0U);
    for (const Place& place : places) sorted[next[digit(place)]++] = place;
    places.swap(sorted);
  }
}

}  // namespace

std::vector<NearestTriangle> nearestTriangles(const CollisionMesh& organ, const Points& points,
                                              const Accuracy& accuracy) {
  requireUsable(accuracy);
  std::vector<Place> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    requireUsable(points[i], "point", i);
    order[i] = {placeOnCurve(organ.wideTree().frame()(points[i])), static_cast<std::uint32_t>(i)};
  }
  sortAlongCurve(order);
  std::vector<NearestTriangle> nearest(points.size());
  forEach(points.size(), kTask, [&](std::size_t i) {
    const std::uint32_t point = order[i].point;
    nearest[point] = nearestTriangle(organ, points[point], accuracy);
  });
  return nearest;
}

}  // namespace organ_collision::core
