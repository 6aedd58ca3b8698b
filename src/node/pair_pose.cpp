#include "node/pair_pose.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <vector>

#include "node/transform_intake.h"
#include "organ_collision/io/message_text.h"

namespace organ_collision::node {
namespace {

/// Zero for what is static.
ros::Duration ageOf(const FramePose& pose, const ros::Time& now) {
  if (pose.stamp.isZero()) return ros::Duration(0);
  const auto age = static_cast<std::int64_t>(now.toNSec() - pose.stamp.toNSec());
  const std::int64_t longest = ros::DURATION_MAX.toNSec();
  return ros::Duration().fromNSec(std::clamp(age, -longest, longest));
}

bool isOfNow(const FramePose& pose, const ros::Time& now, double stale_after) {
  return std::abs(ageOf(pose, now).toSec()) <= stale_after;
}

/// What is static has no stamp to tell by.
bool differ(const std::optional<FramePose>& known, const FramePose& pose) {
  return !known || known->stamp != pose.stamp ||
         known->target_from_source.matrix() != pose.target_from_source.matrix();
}

/// The frame, the one it is told in, and so on.
std::vector<std::string> ancestry(const tf2::BufferCore& buffer, const std::string& frame) {
  constexpr std::size_t kMostFrames = 100;  // some may run in a circle
  std::vector<std::string> frames = {frame};
  for (std::string parent;
       frames.size() < kMostFrames && buffer._getParent(frames.back(), ros::Time(), parent);)
    frames.push_back(parent);
  return frames;
}

/// Of the frames between these two, the one that tf has not told of for the longest; static ones
/// aside.
std::string quietest(const tf2::BufferCore& buffer, const std::string& one,
                     const std::string& other) {
  const std::vector<std::string> above_one = ancestry(buffer, one);
  const std::vector<std::string> above_other = ancestry(buffer, other);
  std::string found;
  ros::Time last = ros::TIME_MAX;
  const auto search = [&](const auto& frames, const auto& others) {
    for (auto frame = frames.begin(); std::next(frame) != frames.end(); ++frame) {
      if (std::find(others.begin(), others.end(), *frame) != others.end()) return;  // they meet
      const auto pose = lookUpFrame(buffer, *std::next(frame), *frame).pose;
      if (!pose || pose->stamp.isZero() || pose->stamp >= last) continue;
      last = pose->stamp;
      found = *frame;
    }
  };
  search(above_one, above_other);
  search(above_other, above_one);
  return found;
}

}  // namespace

bool PairPose::lookUp(const tf2::BufferCore& buffer) {
  const FrameLookup first = lookUpFrame(buffer, frames_.second, frames_.first);
  reason_ = first.reason;
  if (!first.pose) return false;
  const bool was_known = isKnown();
  const bool moved = differ(second_from_first_, *first.pose);
  second_from_first_ = first.pose;
  const ros::Time& stamp = first.pose->stamp;
  FrameLookup scene = lookUpFrame(buffer, frames_.scene, frames_.second, stamp);
  // A pose that was told before stays where it was told, also when tf forgets that time.
  if (!scene.pose && was_known && !moved && !stamp.isZero()) return false;
  if (!scene.pose) scene = lookUpFrame(buffer, frames_.scene, frames_.second);
  reason_ = scene.reason;
  if (!scene.pose) return moved;
  // A pose that changes is answered when it does; one that is static, whenever the scene's does.
  const bool seen_anew = !was_known || (stamp.isZero() && differ(scene_from_second_, *scene.pose));
  scene_from_second_ = scene.pose;
  return moved || seen_anew;
}

ros::Duration PairPose::age(const ros::Time& now) const { return ageOf(*second_from_first_, now); }

ros::Time PairPose::stampOfHeader(const ros::Time& now) const {
  if (!isKnown() || age(now).toSec() < -TransformIntake::kFarthestAhead) return {};
  return stamp();
}

bool PairPose::isLate(const ros::Time& now, double stale_after) const {
  return !reason_.empty() || !isOfNow(*second_from_first_, now, stale_after) ||
         !isOfNow(*scene_from_second_, now, stale_after);
}

std::string PairPose::complaint(const ros::Time& now, double stale_after,
                                const tf2::BufferCore& buffer) const {
  if (!reason_.empty() || !isKnown()) return io::printable(reason_);
  const auto told = [&](const std::string& what, const FramePose& pose, const std::string& target,
                        const std::string& source) {
    const double age = ageOf(pose, now).toSec();
    if (age < 0.0) return what + " is " + std::to_string(-age) + " s ahead of the clock";
    return io::printable(what + " is " + std::to_string(age) +
                         " s old: of a later time tf has not told where '" +
                         quietest(buffer, source, target) + "' is");
  };
  if (!isOfNow(*second_from_first_, now, stale_after))
    return told("the last pose", *second_from_first_, frames_.second, frames_.first);
  if (!isOfNow(*scene_from_second_, now, stale_after))
    return told("the last pose of the scene's frame", *scene_from_second_, frames_.scene,
                frames_.second);
  return "";
}

}  // namespace organ_collision::node
