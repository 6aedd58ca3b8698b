#pragma once

#include <ros/time.h>
#include <tf2/buffer_core.h>

#include <optional>
#include <string>

#include "node/frame_lookup.h"

namespace organ_collision::node {

/// Why a pair's pose is not that of now.
struct Complaint {
  std::string first, second, reason;
};

/// The frames of a pair, and of what is published of it.
struct PairFrames {
  std::string first, second, scene;
};

/// Where the first of a pair is in the second's frame: the last that tf knew. And the second in the
/// scene's: at that time if tf knows it, else the last. Once known they are kept, whatever tf
/// forgets.
class PairPose {
 public:
  explicit PairPose(PairFrames frames) : frames_(std::move(frames)) {}

  /// For what is published of several pairs: zero if the pose is not known, is static, or is
  /// farther ahead of the clock than TransformIntake lets pass, as it was told before time jumped
  /// back.
  ros::Time stampOfHeader(const ros::Time& now) const;

  /// Asks tf; true if the first has moved against the second since the last time, or is static and
  /// both have in the scene, or tf has told both for the first time.
  bool lookUp(const tf2::BufferCore& buffer);

  /// tf has told both at least once.
  bool isKnown() const { return second_from_first_ && scene_from_second_; }

  // REQUIRES of the rest: isKnown().
  const Eigen::Isometry3d& secondFromFirst() const {
    return second_from_first_->target_from_source;
  }
  const Eigen::Isometry3d& sceneFromSecond() const {
    return scene_from_second_->target_from_source;
  }
  const ros::Time& stamp() const { return second_from_first_->stamp; }  ///< zero if static
  /// Zero for what is static, and so always true; negative if the pose is ahead of the clock; never
  /// more than a Duration can hold.
  ros::Duration age(const ros::Time& now) const;

  /// The first's pose, or that of the scene's frame, is not that of now.
  bool isLate(const ros::Time& now, double stale_after) const;

  /// Why the poses are not those of now, and of which frame `buffer` has heard no more; empty: they
  /// are. Printable, though anybody may name frames. REQUIRES no more than lookUp().
  std::string complaint(const ros::Time& now, double stale_after,
                        const tf2::BufferCore& buffer) const;

 private:
  PairFrames frames_;
  std::optional<FramePose> second_from_first_, scene_from_second_;
  std::string reason_;  // why tf does not know them now
};

}  // namespace organ_collision::node
