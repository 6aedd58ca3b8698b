#include "core/nearest_search.h"

#include <algorithm>
#include <optional>

#include "core/perhaps_inside.h"

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

const FrontierRoom& roomFor(const WideTree& tree) {
  // Plain data, in a place known from the start: neither guard nor table is asked at each query.
  [[gnu::tls_model("initial-exec")]] thread_local SizedRoom known = {};
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

}  // namespace organ_collision::core
