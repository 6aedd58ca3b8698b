#include "node/frame_lookup.h"

#include <tf2/exceptions.h>
#include <tf2_eigen/tf2_eigen.h>

namespace organ_collision::node {

FrameLookup lookUpFrame(const tf2::BufferCore& buffer, const std::string& target,
                        const std::string& source, const ros::Time& time) {
  if (target == source) return {FramePose{Eigen::Isometry3d::Identity(), time}, ""};
  try {
    const geometry_msgs::TransformStamped transform = buffer.lookupTransform(target, source, time);
    return {FramePose{tf2::transformToEigen(transform), transform.header.stamp}, ""};
  } catch (const tf2::TransformException& error) {
    return {std::nullopt, error.what()};
  }
}

}  // namespace organ_collision::node
