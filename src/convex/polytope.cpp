#include "convex/polytope.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <utility>

#include "organ_collision/core/closest_point.h"
#include "organ_collision/core/predicates.h"

namespace organ_collision::convex {

using core::Points;
using Eigen::Vector3d;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// Of both corners along a direction the one that is farther from a plane through `from`.
Polytope::Corner fartherFrom(const Vector3d& from, const Vector3d& direction, const Points& first,
                             const Points& second) {
  const Polytope::Corner there = farthestCorner(direction, first, second);
  const Polytope::Corner back = farthestCorner(-direction, first, second);
  return direction.dot(there.place - from) > direction.dot(from - back.place) ? there : back;
}

}  // namespace

Polytope::Corner farthestCorner(const Vector3d& direction, const Points& first,
                                const Points& second) {
  const Vector3d& on_first = farthest(first, direction);
  const Vector3d& on_second = farthest(second, -direction);
  return {on_first - on_second, on_first, on_second};
}

Polytope::FourCorners farCorners(const Points& first, const Points& second) {
  Polytope::FourCorners corners;
  double longest = -1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const Polytope::Corner high = farthestCorner(Vector3d::Unit(axis), first, second);
    const Polytope::Corner low = farthestCorner(-Vector3d::Unit(axis), first, second);
    const double length = (high.place - low.place).norm();
    if (!(length > longest)) continue;
    longest = length;
    corners[0] = low;
    corners[1] = high;
  }
  const Vector3d along = corners[1].place - corners[0].place;
  double widest = -1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const Polytope::Corner corner =
        fartherFrom(corners[0].place, along.cross(Vector3d::Unit(axis)), first, second);
    const double width = along.cross(corner.place - corners[0].place).norm();
    if (!(width > widest)) continue;
    widest = width;
    corners[2] = corner;
  }
  const Vector3d normal = along.cross(corners[2].place - corners[0].place);
  corners[3] = fartherFrom(corners[0].place, normal, first, second);
  return corners;
}

bool areInOnePlane(const Polytope::FourCorners& corners) {
  return core::orientation(corners[0].place, corners[1].place, corners[2].place,
                           corners[3].place) == 0;
}

Polytope::Polytope(const FourCorners& corners) : corners_(corners.begin(), corners.end()) {
  if (core::orientation(corners[0].place, corners[1].place, corners[2].place, corners[3].place) > 0)
    std::swap(corners_[0], corners_[1]);
  addFace(0, 1, 2);
  addFace(0, 3, 1);
  addFace(1, 3, 2);
  addFace(2, 3, 0);
}

void Polytope::addFace(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const Vector3d& place = corners_[a].place;
  const Vector3d normal =
      (corners_[b].place - place).cross(corners_[c].place - place).stableNormalized();
  faces_.push_back({{a, b, c}, normal, normal.isZero(0.0) ? kInfinity : normal.dot(place)});
}

/// From outside.
bool Polytope::sees(const Vector3d& place, const Face& face) const {
  const auto& [a, b, c] = face.corners;
  return core::orientation(corners_[a].place, corners_[b].place, corners_[c].place, place) > 0;
}

bool Polytope::holdsOrigin() const {
  return std::none_of(faces_.begin(), faces_.end(),
                      [this](const Face& face) { return sees(Vector3d::Zero(), face); });
}

bool Polytope::add(const Corner& corner) {
  const auto seen = std::stable_partition(
      faces_.begin(), faces_.end(), [&](const Face& face) { return !sees(corner.place, face); });
  if (seen == faces_.end()) return false;
  std::vector<Edge> edges;
  for (auto face = seen; face != faces_.end(); ++face) {
    const auto& [a, b, c] = face->corners;
    edges.insert(edges.end(), {{a, b}, {b, c}, {c, a}});
  }
  faces_.erase(seen, faces_.end());
  corners_.push_back(corner);
  const auto number = static_cast<std::uint32_t>(corners_.size() - 1);
  for (const auto& [from, to] : edges) {
    if (std::find(edges.begin(), edges.end(), Edge{to, from}) == edges.end())
      addFace(from, to, number);
  }
  return true;
}

std::size_t Polytope::nearestFace() const {
  const auto nearest = std::min_element(
      faces_.begin(), faces_.end(),
      [](const Face& left, const Face& right) { return left.offset < right.offset; });
  return static_cast<std::size_t>(nearest - faces_.begin());
}

const Polytope::Face& Polytope::nearestPlane() const { return faces_[nearestFace()]; }

void Polytope::passByNearest() { faces_[nearestFace()].offset = kInfinity; }

HullDistance Polytope::nearestPoints() const {
  HullDistance nearest{};
  nearest.normal = Vector3d::Zero();
  double least = kInfinity;
  for (const Face& face : faces_) {
    const auto& [a, b, c] = face.corners;
    const core::ClosestPoint closest = core::closestPointOnTriangle(
        Vector3d::Zero(), {corners_[a].place, corners_[b].place, corners_[c].place});
    const bool has_no_normal = nearest.normal.isZero(0.0);
    if (!(closest.squared_distance < least || (closest.squared_distance == least && has_no_normal)))
      continue;
    least = closest.squared_distance;
    nearest.normal = face.normal;
    nearest.on_first = nearest.on_second = Vector3d::Zero();
    for (int i = 0; i < 3; ++i) {
      nearest.on_first += closest.barycentric[i] * corners_[face.corners[i]].on_first;
      nearest.on_second += closest.barycentric[i] * corners_[face.corners[i]].on_second;
    }
  }
  return nearest;
}

}  // namespace organ_collision::convex
