#include "organ_collision/core/nearest_triangle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "core/greedy_search.h"
#include "core/nearest_search.h"
#include "core/perhaps_inside.h"
#include "organ_collision/core/sign.h"

namespace organ_collision::core {

namespace {

struct RoomSizes {
  std::size_t levels, nodes, packets;
  bool hold(const RoomSizes& other) const {
    return other.levels <= levels && other.nodes <= nodes && other.packets <= packets;
  }
};

struct SizedRoom {
  RoomSizes sizes;
  FrontierRoom room;
};

/// The calling thread's, which never gets smaller.
SizedRoom enlargedRoom(const RoomSizes& sizes) {
  thread_local HugePageVector<PassedNode> passed;
  thread_local HugePageVector<std::uint32_t> nodes, packets;
  thread_local HugePageVector<float> squares;
  passed.resize(std::max(passed.size(), sizes.levels));
  nodes.resize(std::max(nodes.size(), sizes.nodes));
  packets.resize(std::max(packets.size(), sizes.packets));
  squares.resize(packets.size());
  return {{passed.size(), nodes.size(), squares.size()},
          {passed.data(), nodes.data(), packets.data(), squares.data()}};
}

}  // namespace

FrontierRoom roomFor(const WideTree& tree) {
  thread_local SizedRoom known = {};  // plain data: no guard is asked at each query
  const RoomSizes sizes = {tree.depth(), tree.nodes().size() + kLaneCount,
                           tree.packets().size() + kLaneCount};
  if (!known.sizes.hold(sizes)) {
    known.sizes = {};  // until all of it is there
    known = enlargedRoom(sizes);
  }
  return known.room;
}

void addSign(const CollisionMesh& organ, const Eigen::Vector3d& corner, NearestTriangle& nearest) {
  addSign(organ, corner, surfaceNormal(organ, nearest.triangle, nearest.closest.feature), nearest);
}

void addSign(const CollisionMesh& organ, const Eigen::Vector3d& corner, const SurfaceNormal& normal,
             NearestTriangle& nearest) {
  nearest.normal = normal.direction;
  if (nearest.upper_bound == 0.0) {  // of 0 both signs are right
    nearest.distance_signed = organ.health().isSolid();
    return;
  }
  if (!nearest.isExact() && organ.health().box.contains(nearest.tip_point)) return;
  // All of a tip that does not meet the surface is on one side of it; its nearest point is rounded.
  const std::optional<Side> side =
      sideOf(organ, nearest.isExact() ? corner : nearest.tip_point, nearest.closest, normal);
  nearest.distance_signed = side.has_value();
  if (side && nearest.isExact())
    nearest.normal = outwardNormal(organ, nearest.closest, normal, *side);
  if (side == Side::kInside) turnInside(nearest);
}

void requireUsable(const Accuracy& accuracy) {
  const auto require = [](double value, const char* name) {
    if (std::isfinite(value) && value >= 0.0) return;
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) +
                                ": it must be finite and >= 0");
  };
  require(accuracy.max_relative_error, "max_relative_error");
  require(accuracy.max_absolute_error, "max_absolute_error");
}

namespace {

/// The paper's answer, of which no more is known than that it is a triangle.
template <class Tip>
NearestTriangle greedyTo(const CollisionMesh& organ, const Tip& tip, Sign sign) {
  const auto [leaf, splits] = greedySearch(organ, tip.routingPoint());
  const ClosestPair pair = tip.measure(organ.mesh().triangle(organ.wideTree().corners()[leaf]));
  const double to_box = std::sqrt(tip.squaredDistanceTo(organ.health().box));
  NearestTriangle nearest = unsignedAnswer(organ, leaf, pair, to_box, {splits, 1});
  if (sign == Sign::kProven) addSign(organ, tip.corner(0), nearest);
  return nearest;
}

template <class Tip>
[[gnu::always_inline]] inline NearestTriangle searchFrom(const CollisionMesh& organ, const Tip& tip,
                                                         const Accuracy& accuracy, Sign sign) {
  NearestSearch<Tip> search(organ, tip, accuracy, sign);
  NearestTriangle nearest = search.run();
  if (sign == Sign::kProven)
    addSign(organ, tip.corner(0),
            search.unlessContested(surfaceNormal(organ, nearest.triangle, nearest.closest.feature)),
            nearest);
  return nearest;
}

template <class Tip>
NearestTriangle nearestTo(const CollisionMesh& organ, const Tip& tip, const Accuracy& accuracy,
                          Sign sign) {
  requireUsable(accuracy);
  if (accuracy.max_leaves == 1) return greedyTo(organ, tip, sign);
  return searchFrom(organ, tip, accuracy, sign);
}

}  // namespace

NearestTriangle nearestTriangle(const CollisionMesh& organ, const Eigen::Vector3d& tip,
                                const Accuracy& accuracy, Sign sign) {
  requireUsable(tip, "tip", 0);
  return nearestTo(organ, PointTip(tip), accuracy, sign);
}

NearestTriangle nearestTriangle(const CollisionMesh& organ, const Triangle& tip,
                                const Accuracy& accuracy, Sign sign) {
  for (const Eigen::Vector3d* corner : {&tip.a, &tip.b, &tip.c}) requireUsable(*corner, "tip", 0);
  return nearestTo(organ, TriangleTip(tip), accuracy, sign);
}

TriangleId greedyTriangle(const CollisionMesh& organ, const Eigen::Vector3d& tip) {
  requireUsable(tip, "tip", 0);
  return organ.tree().triangle(greedySearch(organ, tip).end);
}

}  // namespace organ_collision::core
