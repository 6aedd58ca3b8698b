#pragma once

#include <ros/time.h>
#include <tf2/buffer_core.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>

namespace organ_collision::node {

/// Where one frame is in another, and when it was there.
struct FramePose {
  Eigen::Isometry3d target_from_source;
  ros::Time stamp;  ///< zero for static transforms
};

/// What tf says; never an exception, never an invented pose.
struct FrameLookup {
  std::optional<FramePose> pose;
  std::string reason;  ///< why there is no pose
};

/// `source` in `target` at `time`; zero: at the latest time that all transforms between them know.
FrameLookup lookUpFrame(const tf2::BufferCore& buffer, const std::string& target,
                        const std::string& source, const ros::Time& time = ros::Time());

}  // namespace organ_collision::node
