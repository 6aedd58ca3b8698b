#include "node/transform_intake.h"

#include <exception>

namespace organ_collision::node {

std::string TransformIntake::take(const tf2_msgs::TFMessage& message, const std::string& publisher,
                                  bool is_static, const ros::Time& now) {
  std::string refusal;
  if (now < last_) {
    refusal = "time jumped back by " + std::to_string(last_.toSec() - now.toSec()) +
              " s: what tf said before is forgotten";
    buffer_.clear();  // but for static transforms
  }
  last_ = now;
  for (geometry_msgs::TransformStamped transform : message.transforms) {
    if (is_static) transform.header.stamp = ros::Time();  // always true, whenever it was sent
    const double ahead = transform.header.stamp.toSec() - now.toSec();
    if (ahead > kFarthestAhead) {
      refusal = "tf says where '" + transform.child_frame_id + "' is " + std::to_string(ahead) +
                " s from now: refused";
      continue;
    }
    try {
      buffer_.setTransform(transform, publisher, is_static);
    } catch (const std::exception& error) {
      refusal = error.what();
    }
  }
  return refusal;
}

}  // namespace organ_collision::node
