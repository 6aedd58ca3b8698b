#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <ros/time.h>
#include <tf2/buffer_core.h>

#include <Eigen/Core>
#include <string>

namespace organ_collision::test {

/// Tells tf where a frame is in its parent, not turned.
inline bool place(tf2::BufferCore& buffer, const std::string& parent, const std::string& child,
                  const Eigen::Vector3d& at, const ros::Time& stamp, bool is_static = false) {
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = parent;
  transform.header.stamp = stamp;
  transform.child_frame_id = child;
  transform.transform.translation.x = at.x();
  transform.transform.translation.y = at.y();
  transform.transform.translation.z = at.z();
  transform.transform.rotation.w = 1.0;
  return buffer.setTransform(transform, "test", is_static);
}

}  // namespace organ_collision::test
