#include "node/pair_pose.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace organ_collision::node {

bool PairPose::lookUp(const tf2::BufferCore& buffer) {
  const FrameLookup first = lookUpFrame(buffer, frames_.second, frames_.first);
  reason_ = first.reason;
  bool moved = false;
  if (first.pose) {
    moved = !second_from_first_ || second_from_first_->stamp != first.pose->stamp;
    second_from_first_ = first.pose;
  }
  FrameLookup scene = lookUpFrame(buffer, frames_.scene, frames_.second,
                                  first.pose ? first.pose->stamp : ros::Time());
  if (!scene.pose) scene = lookUpFrame(buffer, frames_.scene, frames_.second);
  if (scene.pose) scene_from_second_ = scene.pose;
  if (reason_.empty()) reason_ = scene.reason;
  return moved;
}

ros::Duration PairPose::age(const ros::Time& now) const {
  if (stamp().isZero()) return ros::Duration(0);
  const auto age = static_cast<std::int64_t>(now.toNSec() - stamp().toNSec());
  const std::int64_t longest = ros::DURATION_MAX.toNSec();
  return ros::Duration().fromNSec(std::clamp(age, -longest, longest));
}

std::string PairPose::complaint(const ros::Time& now, double stale_after) const {
  const double age = this->age(now).toSec();
  if (!reason_.empty() || std::abs(age) <= stale_after) return reason_;
  return "the last pose is " + std::to_string(std::abs(age)) +
         (age < 0.0 ? " s ahead of the clock" : " s old");
}

}  // namespace organ_collision::node
