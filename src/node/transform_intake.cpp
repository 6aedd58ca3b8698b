#include "node/transform_intake.h"

#include <cmath>
#include <exception>

namespace organ_collision::node {
namespace {

/// Rotations are rounded on their way here: tf2 takes what is off by a percent for one, and then
/// scales what it turns by as much.
void normalize(geometry_msgs::Quaternion& rotation) {
  constexpr double kTolerance = 0.01;  // tf2's, of the squared length: it refuses the others
  auto& [x, y, z, w] = rotation;
  const double squared_length = x * x + y * y + z * z + w * w;
  if (!(std::abs(squared_length - 1.0) <= kTolerance)) return;
  for (double* part : {&x, &y, &z, &w}) *part /= std::sqrt(squared_length);
}

}  // namespace

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
    if (!is_static && transform.header.stamp.isZero()) {
      refusal = "tf says where '" + transform.child_frame_id + "' is, but not when: refused";
      continue;
    }
    const double ahead = transform.header.stamp.toSec() - now.toSec();
    if (ahead > kFarthestAhead) {
      refusal = "tf says where '" + transform.child_frame_id + "' is " + std::to_string(ahead) +
                " s from now: refused";
      continue;
    }
    normalize(transform.transform.rotation);
    try {
      buffer_.setTransform(transform, publisher, is_static);
    } catch (const std::exception& error) {
      refusal = error.what();
    }
  }
  return refusal;
}

}  // namespace organ_collision::node
