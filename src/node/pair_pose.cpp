#include "node/pair_pose.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace organ_collision::node {
namespace {

/// Zero for what is static.
ros::Duration ageOf(const FramePose& pose, const ros::Time& now) {
  if (pose.stamp.isZero()) return ros::Duration(0);
  const auto age = static_cast<std::int64_t>(now.toNSec() - pose.stamp.toNSec());
  const std::int64_t longest = ros::DURATION_MAX.toNSec();
  return ros::Duration().fromNSec(std::clamp(age, -longest, longest));
}

/// Empty where the pose is that of now.
std::string complaintOf(const char* what, const FramePose& pose, const ros::Time& now,
                        double stale_after) {
  const double age = ageOf(pose, now).toSec();
  if (std::abs(age) <= stale_after) return "";
  return what + std::string(" is ") + std::to_string(std::abs(age)) +
         (age < 0.0 ? " s ahead of the clock" : " s old");
}

}  // namespace

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

ros::Duration PairPose::age(const ros::Time& now) const { return ageOf(*second_from_first_, now); }

bool PairPose::isLate(const ros::Time& now, double stale_after) const {
  return !reason_.empty() || std::abs(age(now).toSec()) > stale_after;
}

std::string PairPose::complaint(const ros::Time& now, double stale_after) const {
  if (!reason_.empty() || !isKnown()) return reason_;
  const std::string of_first = complaintOf("the last pose", *second_from_first_, now, stale_after);
  return of_first.empty() ? complaintOf("the last pose of the scene's frame", *scene_from_second_,
                                        now, stale_after)
                          : of_first;
}

}  // namespace organ_collision::node
