#include "node/frame_lookup.h"

#include <tf2/exceptions.h>
#include <tf2_eigen/tf2_eigen.h>

#include <exception>
#include <sstream>

namespace organ_collision::node {
namespace {

constexpr double kFarthest = 1e8;  // [m] about where rounding would eat triangles of micrometres

bool isUsable(const Eigen::Isometry3d& pose) {
  return pose.matrix().allFinite() && pose.translation().cwiseAbs().maxCoeff() < kFarthest;
}

}  // namespace

FrameLookup lookUpFrame(const tf2::BufferCore& buffer, const std::string& target,
                        const std::string& source, const ros::Time& time) {
  if (target == source) return {FramePose{Eigen::Isometry3d::Identity(), time}, ""};
  try {
    const geometry_msgs::TransformStamped transform = buffer.lookupTransform(target, source, time);
    const FramePose pose = {tf2::transformToEigen(transform), transform.header.stamp};
    if (!isUsable(pose.target_from_source)) {
      std::ostringstream reason;
      const Eigen::Vector3d place = pose.target_from_source.translation();
      reason << "tf says that '" << source << "' is at (" << place.x() << ", " << place.y() << ", "
             << place.z() << ") m in '" << target << "'"
             << ": more than " << kFarthest << " m away, or nowhere";
      return {std::nullopt, reason.str()};
    }
    return {pose, ""};
  } catch (const tf2::TransformException& error) {
    for (const std::string* frame : {&target, &source})
      if (!buffer._frameExists(*frame)) return {std::nullopt, "tf knows no frame '" + *frame + "'"};
    const std::string reason = error.what();  // of a loop, all frames follow, line by line
    return {std::nullopt, reason.substr(0, reason.find('\n'))};
  } catch (const std::exception&) {  // times too far apart for tf2 to say how far
    return {std::nullopt, "where '" + source + "' is in '" + target +
                              "' was asked for a time too far from those that tf knows"};
  }
}

}  // namespace organ_collision::node
