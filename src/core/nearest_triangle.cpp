#include "organ_collision/core/nearest_triangle.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "core/greedy_search.h"
#include "core/nearest_search.h"

namespace organ_collision::core {

void refuseNegative(const char* field, double value) {
  std::ostringstream message;
  message << field << " is " << value << ": it must be finite and >= 0";
  throw std::invalid_argument(message.str());
}

namespace {

/// The paper's answer, of which no more is known than that it is a triangle.
template <class Tip>
NearestTriangle greedyTo(const CollisionMesh& organ, const Tip& tip, Sign sign) {
  const auto [leaf, splits] = greedySearch(organ, tip.routingPoint());
  const ClosestPair pair = tip.measure(organ.mesh(), organ.wideTree().corners()[leaf]);
  NearestTriangle nearest;
  nearest.closest = pair.on_second;
  nearest.tip_point = pair.point_on_first;
  const double to_box = std::sqrt(tip.squaredDistanceTo(organ.health().box));
  nameUnsigned(organ.tree().triangle(leaf), to_box, {splits, 1}, nearest);
  if (sign == Sign::kProven) addSign(organ, tip.corner(0), nearest);
  return nearest;
}

template <class Tip>
[[gnu::always_inline]] inline NearestTriangle searchFrom(const CollisionMesh& organ, const Tip& tip,
                                                         const Accuracy& accuracy, Sign sign) {
  NearestTriangle nearest;
  NearestSearch<Tip> search(organ, tip, accuracy, sign, nearest);
  search.run();
  if (sign == Sign::kProven) search.addSign();
  return nearest;
}

/// In one piece with the public functions: what is done once a query counts.
template <class Tip>
[[gnu::always_inline]] inline NearestTriangle nearestTo(const CollisionMesh& organ, const Tip& tip,
                                                        const Accuracy& accuracy, Sign sign) {
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
  requireUsable(tip);
  return nearestTo(organ, TriangleTip(tip), accuracy, sign);
}

TriangleId greedyTriangle(const CollisionMesh& organ, const Eigen::Vector3d& tip) {
  requireUsable(tip, "tip", 0);
  return organ.tree().triangle(greedySearch(organ, tip).end);
}

}  // namespace organ_collision::core
