#include "organ_collision/core/sign.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/for_each_leaf.h"
#include "core/plane_coordinates.h"
#include "core/unit_vector.h"
#include "organ_collision/core/predicates.h"

namespace organ_collision::core {
namespace {

// Rounding turns no sign that is clearer than this: the unit normal of a triangle whose angles have
// a sine above it is right to 8u / kClear, a sum of normals longer than it to 8u / kClear^2, and
// that is far below kClear.
constexpr double kClear = 0x1p-12;

/// A triangle as one of its corners sees it, but for a factor.
struct Wedge {
  Eigen::Vector3d across;  ///< the normal, `area` long
  double area, along;      ///< sine and cosine of the angle, times the same
  bool well_shaped;
};

/// The corner after another one.
constexpr std::array<std::size_t, 3> kNext = {1, 2, 0};

Wedge wedgeAt(const TriangleMesh& mesh, const Corners& corners, std::size_t i) {
  const Eigen::Vector3d& here = mesh.position(corners[i]);
  Eigen::Vector3d to_next = mesh.position(corners[kNext[i]]) - here;
  Eigen::Vector3d to_last = mesh.position(corners[kNext[kNext[i]]]) - here;
  if (!isSafe(squaredLength(to_next)) || !isSafe(squaredLength(to_last))) {
    to_next = madeSafe(to_next);
    to_last = madeSafe(to_last);
  }
  const Eigen::Vector3d across = to_next.cross(to_last);
  const double squared_area = squaredLength(across);
  return {across, std::sqrt(squared_area), to_next.dot(to_last),
          squared_area > kClear * kClear * squaredLength(to_next) * squaredLength(to_last)};
}

/// Triangles that meet at an edge or a vertex; all that share its welded vertices.
class Fan {
 public:
  explicit Fan(const CollisionMesh& organ) : topology_(organ.topology()), mesh_(organ.mesh()) {}

  void addAround(VertexId vertex) {
    const Weld here = topology_.weld(vertex);
    for (const TriangleId id : topology_.trianglesAt(here)) {
      const Corners& corners = mesh_.corners(id);
      const Wedge wedge = wedgeAt(mesh_, corners, firstAt(here, weldsOf(corners)));
      add(wedge, std::atan2(wedge.area, wedge.along));
    }
  }

  void addAlong(VertexId start, VertexId end) {
    const Weld from = topology_.weld(start);
    const Weld to = topology_.weld(end);
    for (const TriangleId id : topology_.trianglesAt(from)) {
      const Corners& corners = mesh_.corners(id);
      const Welds welds = weldsOf(corners);
      if (std::count(welds.begin(), welds.end(), to) > 0)
        add(wedgeAt(mesh_, corners, firstAt(from, welds)), 1.0);
    }
  }

  SurfaceNormal normal() const {
    return {unit(normal_), well_shaped_ && squaredLength(normal_) > kClear * kClear};
  }

 private:
  using Weld = MeshTopology::Weld;
  using Welds = std::array<Weld, 3>;

  Welds weldsOf(const Corners& corners) const {
    return {topology_.weld(corners[0]), topology_.weld(corners[1]), topology_.weld(corners[2])};
  }

  /// Without a branch, as none could be foreseen.
  static std::size_t firstAt(Weld weld, const Welds& welds) {
    return static_cast<std::size_t>(welds[0] != weld) *
           (1 + static_cast<std::size_t>(welds[1] != weld));
  }

  void add(const Wedge& wedge, double weight) {
    well_shaped_ = well_shaped_ && wedge.well_shaped;
    if (wedge.area > 0.0) normal_ += weight / wedge.area * wedge.across;
  }

  const MeshTopology& topology_;
  const TriangleMesh& mesh_;
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();
  bool well_shaped_ = true;
};

/// The welds of an edge, the lesser first; of a vertex twice. REQUIRES: it is no face.
std::array<MeshTopology::Weld, 2> endsOf(const MeshTopology& topology, const Corners& corners,
                                         Feature feature) {
  const auto number = static_cast<std::size_t>(feature);
  const bool is_vertex = feature <= Feature::kVertexC;
  const std::size_t first = is_vertex ? number : number - std::size_t{3};
  const MeshTopology::Weld from = topology.weld(corners[first]);
  const MeshTopology::Weld to = is_vertex ? from : topology.weld(corners[kNext[first]]);
  return {std::min(from, to), std::max(from, to)};
}

SurfaceNormal normalOfFace(const TriangleMesh& mesh, const Corners& corners) {
  const Wedge wedge = wedgeAt(mesh, corners, 0);
  return {wedge.area > 0.0 ? Eigen::Vector3d(wedge.across / wedge.area) : wedge.across,
          wedge.well_shaped};
}

/// Of a mesh that is not inside out.
SurfaceNormal normalAt(const CollisionMesh& organ, TriangleId triangle, Feature feature) {
  const Corners& corners = organ.mesh().corners(triangle);
  Fan fan(organ);
  switch (feature) {
    case Feature::kFace:
      return normalOfFace(organ.mesh(), corners);
    case Feature::kVertexA:
    case Feature::kVertexB:
    case Feature::kVertexC:
      fan.addAround(corners[static_cast<std::size_t>(feature)]);
      break;
    case Feature::kEdgeAB:
    case Feature::kEdgeBC:
    case Feature::kEdgeCA: {
      const auto first =
          static_cast<std::size_t>(feature) - static_cast<std::size_t>(Feature::kEdgeAB);
      fan.addAlong(corners[first], corners[kNext[first]]);
      break;
    }
  }
  return fan.normal();
}

/// +1 or -1 where the line through `point` along x crosses the triangle with its normal along +x or
/// -x, else 0. A line that meets an edge is moved by less than any number, first in y and by still
/// less in z: of the triangles around the edge exactly those that the moved line crosses are
/// counted.
int crossing(const Triangle& triangle, const Eigen::Vector3d& point) {
  const std::array<const Eigen::Vector3d*, 3> corners = {&triangle.a, &triangle.b, &triangle.c};
  int turns = 0;
  for (const std::size_t i : {0, 1, 2}) {
    const Eigen::Vector3d& from = *corners[i];
    const Eigen::Vector3d& to = *corners[(i + 1) % 3];
    const bool upwards = from.z() <= point.z();
    if (upwards == (to.z() <= point.z())) continue;
    int left = orientation(alongAxis(from, 0), alongAxis(to, 0), alongAxis(point, 0));
    if (left == 0) left = upwards ? -1 : 1;
    if (upwards && left > 0) ++turns;
    if (!upwards && left < 0) --turns;
  }
  return turns;
}

/// Parts of the extent. Nearer than the first, rounding could turn the way to the nearest point of
/// a needle; nearer than the second, of any triangle.
constexpr double kProvenWay = 0x1p-30;
constexpr double kLikelyWay = 0x1p-45;

/// Whether the point to which `closest` is nearest is on that side of it to which the direction
/// leads; nothing where rounding could turn that, or it is nearer than `least`.
std::optional<bool> isAbove(const Box& box, const ClosestPoint& closest,
                            const Eigen::Vector3d& direction, double least) {
  const double distance = largestCoordinate(closest.offset);
  const double extent = distance + largestCoordinate(box.high - box.low);
  const Eigen::Vector3d offset =
      isSafe(closest.squared_distance) ? closest.offset : madeSafe(closest.offset);
  const double height = -offset.dot(direction);
  if (!(distance > least * extent && height * height > kClear * kClear * squaredLength(offset)))
    return std::nullopt;
  return height > 0.0;
}

}  // namespace

Eigen::Vector3d pseudonormal(const CollisionMesh& organ, TriangleId triangle, Feature feature) {
  return surfaceNormal(organ, triangle, feature).direction;
}

SurfaceNormal surfaceNormal(const CollisionMesh& organ, TriangleId triangle, Feature feature) {
  SurfaceNormal normal = normalAt(organ, triangle, feature);
  if (organ.health().inverted) normal.direction = -normal.direction;
  normal.is_clear = normal.is_clear && organ.tellsSide(triangle) && !organ.isPerhapsFlat();
  return normal;
}

bool isSameFeature(const MeshTopology& topology, const Corners& one, Feature of_one,
                   const Corners& other, Feature of_other) {
  return of_one != Feature::kFace && of_other != Feature::kFace &&
         endsOf(topology, one, of_one) == endsOf(topology, other, of_other);
}

int windingNumber(const CollisionMesh& organ, const Eigen::Vector3d& point) {
  const WideTree& tree = organ.wideTree();
  const auto meets_ray = [](const Box& box, const Eigen::Vector3d& start) {
    return start.x() <= box.high.x() && box.low.y() <= start.y() && start.y() <= box.high.y() &&
           box.low.z() <= start.z() && start.z() <= box.high.z();
  };
  int winding = 0;
  const auto count = [&](FarthestPairTree::Leaf leaf) {
    const Triangle triangle = organ.mesh().triangle(organ.tree().triangle(leaf));
    if (!meets_ray(boxOf(triangle), point)) return;
    const int turns = crossing(triangle, point);
    // Seen from the normal's side the triangle is ahead of the point only if the point is behind
    // it, and vice versa.
    if (turns != 0 && turns * orientation(triangle.a, triangle.b, triangle.c, point) < 0)
      winding += turns;
  };
  const Eigen::Vector3d unit_point = tree.frame()(point);
  forEachLeaf(
      tree, [&](const Box& box) { return meets_ray(box, unit_point); }, count);
  return winding;
}

std::optional<Side> sideOf(const CollisionMesh& organ, const Eigen::Vector3d& point,
                           const ClosestPoint& closest, const SurfaceNormal& normal) {
  const MeshHealth& health = organ.health();
  if (!health.isSolid()) return std::nullopt;
  if (!health.box.contains(point)) return Side::kOutside;
  const std::optional<bool> above = isAbove(health.box, closest, normal.direction, kProvenWay);
  const bool outside = normal.is_clear && above ? *above : windingNumber(organ, point) == 0;
  return outside ? Side::kOutside : Side::kInside;
}

Eigen::Vector3d outwardNormal(const CollisionMesh& organ, const ClosestPoint& closest,
                              const SurfaceNormal& normal, Side side) {
  if (normal.is_clear) return normal.direction;
  const std::optional<bool> above =
      isAbove(organ.health().box, closest, normal.direction, kLikelyWay);
  const bool leads_inwards = above && *above != (side == Side::kOutside);
  return leads_inwards ? Eigen::Vector3d(-normal.direction) : normal.direction;
}

}  // namespace organ_collision::core
