#include "organ_collision/core/nearest_triangles.h"

#include <algorithm>
#include <cstdint>

#include "core/for_each.h"

namespace organ_collision::core {
namespace {

/// Points to a task: less takes longer to hand over than to search.
constexpr std::size_t kTask = 64;

/// The ten lowest bits of `number`, two places apart.
std::uint32_t spread(std::uint32_t number) {
  number = (number | number << 16U) & 0x030000FFU;
  number = (number | number << 8U) & 0x0300F00FU;
  number = (number | number << 4U) & 0x030C30C3U;
  return (number | number << 2U) & 0x09249249U;
}

/// Where a point is on a curve through the cells of the box around an organ twice its size. Source:
/// G. M. Morton, "A computer oriented geodetic data base" (1966).
std::uint32_t placeOnCurve(const Eigen::Vector3d& unit_point) {
  const auto cell = [](double coordinate) {
    constexpr double kCells = 1024.0;
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

}  // namespace

std::vector<NearestTriangle> nearestTriangles(const CollisionMesh& organ, const Points& points,
                                              const Accuracy& accuracy) {
  requireUsable(accuracy);
  std::vector<Place> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    requireUsable(points[i], "point", i);
    order[i] = {placeOnCurve(organ.wideTree().frame()(points[i])), static_cast<std::uint32_t>(i)};
  }
  std::sort(order.begin(), order.end(),
            [](const Place& a, const Place& b) { return a.on_curve < b.on_curve; });
  std::vector<NearestTriangle> nearest(points.size());
  forEach(points.size(), kTask, [&](std::size_t i) {
    const std::uint32_t point = order[i].point;
    nearest[point] = nearestTriangle(organ, points[point], accuracy);
  });
  return nearest;
}

}  // namespace organ_collision::core
