#include "node/transform_intake.h"

#include <console_bridge/console.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <initializer_list>
#include <sstream>
#include <utility>

namespace organ_collision::node {
namespace {

using geometry_msgs::Quaternion;
using geometry_msgs::TransformStamped;

constexpr double kTolerance = 0.01;  // tf2's, of a rotation's squared length

double squaredLength(const Quaternion& q) { return q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w; }

/// Rotations are rounded on their way here: tf2 takes what is off by half a percent for one, and
/// then scales what it turns by twice as much.
void normalize(Quaternion& rotation) {
  const double length = std::sqrt(squaredLength(rotation));
  for (double* part : {&rotation.x, &rotation.y, &rotation.z, &rotation.w}) *part /= length;
}

std::string text(std::initializer_list<double> numbers) {
  std::ostringstream text;
  const char* separator = "(";
  for (const double number : numbers) text << std::exchange(separator, ", ") << number;
  text << ")";
  return text.str();
}

/// What is wrong with a transform; empty: nothing. tf2 would drop the most of it too, but say so on
/// stderr alone.
std::string faultOf(const TransformStamped& transform, bool is_static, const ros::Time& now) {
  const auto& [translation, rotation] = transform.transform;
  const double ahead = transform.header.stamp.toSec() - now.toSec();
  if (transform.child_frame_id.empty() || transform.header.frame_id.empty())
    return "a frame has no name";
  if (transform.child_frame_id == transform.header.frame_id) return "that is itself";
  if (!std::isfinite(translation.x + translation.y + translation.z))
    return "its translation " + text({translation.x, translation.y, translation.z}) +
           " is not finite";
  if (!(std::abs(squaredLength(rotation) - 1.0) <= kTolerance))
    return "its rotation " + text({rotation.x, rotation.y, rotation.z, rotation.w}) +
           " is not of length 1";
  if (!is_static && transform.header.stamp.isZero()) return "it does not say when";
  if (ahead > TransformIntake::kFarthestAhead)
    return "it is " + std::to_string(ahead) + " s ahead of the clock";
  return "";
}

std::string refusalOf(const TransformStamped& transform, const std::string& publisher,
                      const std::string& fault) {
  return "refused where '" + publisher + "' says that '" + transform.child_frame_id + "' is in '" +
         transform.header.frame_id + "': " + fault;
}

/// As tf2 has it.
void dropSlash(std::string& frame) {
  if (!frame.empty() && frame.front() == '/') frame.erase(0, 1);
}

}  // namespace

/// The console is not tf2's: each transform that it drops would be told there, and who blocks it
/// would block the thread that answers tips.
TransformIntake::TransformIntake(tf2::BufferCore& buffer) : buffer_(buffer) {
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
}

/// Whether a frame is in another, or in what is.
bool TransformIntake::isBelow(const std::string& frame, const std::string& other) const {
  for (auto at = known_.find(frame); at != known_.end(); at = known_.find(at->second.parent))
    if (at->second.parent == other) return true;
  return false;
}

/// What tf has that does not go with a transform; empty: nothing known.
std::string TransformIntake::conflictOf(const TransformStamped& transform, bool is_static) const {
  const std::string& parent = transform.header.frame_id;
  const auto found = known_.find(transform.child_frame_id);
  const bool is_known_below = found != known_.end() && found->second.parent == parent;
  if (!is_known_below && isBelow(parent, transform.child_frame_id))
    return "that would close a loop: '" + parent + "' is in '" + transform.child_frame_id +
           "', as it was told before; if that was a mistake, start this node anew";
  if (found == known_.end()) return "";
  const Known& known = found->second;
  if (known.is_static != is_static)
    return std::string("it was on ") + (is_static ? "/tf" : "/tf_static") +
           " before; if that was a mistake, start this node anew";
  const double age = known.newest.toSec() - transform.header.stamp.toSec();
  if (!is_static && age > buffer_.getCacheLength().toSec()) return "it is older than what tf keeps";
  return "";
}

void TransformIntake::note(const TransformStamped& transform, bool is_static) {
  const std::string& frame = transform.child_frame_id;
  Known& known = known_.try_emplace(frame, Known{is_static, {}, {}}).first->second;
  known.newest = std::max(known.newest, transform.header.stamp);
  known.parent = transform.header.frame_id;
  burst_.noteMove(frame);
}

bool TransformIntake::overtakes(const tf2_msgs::TFMessage& message) const {
  return std::any_of(message.transforms.begin(), message.transforms.end(),
                     [this](const TransformStamped& transform) {
                       std::string frame = transform.child_frame_id;
                       dropSlash(frame);
                       return burst_.holds(frame);
                     });
}

std::string TransformIntake::noteTime(const ros::Time& now) {
  const ros::Time last = std::exchange(last_, now);
  if (now >= last) return "";
  buffer_.clear();  // but for static transforms
  for (auto& [name, known] : known_)
    if (!known.is_static) known = {false, {}, {}};
  return "time jumped back by " + std::to_string(last.toSec() - now.toSec()) +
         " s: what tf said before is forgotten";
}

std::vector<std::string> TransformIntake::take(const tf2_msgs::TFMessage& message,
                                               const std::string& publisher, bool is_static,
                                               const ros::Time& now) {
  std::vector<std::string> complaints;
  if (std::string jump = noteTime(now); !jump.empty()) complaints.push_back(std::move(jump));
  for (TransformStamped transform : message.transforms) {
    dropSlash(transform.header.frame_id);
    dropSlash(transform.child_frame_id);
    if (is_static) transform.header.stamp = ros::Time();  // always true, whenever it was sent
    std::string fault = faultOf(transform, is_static, now);
    if (fault.empty()) fault = conflictOf(transform, is_static);
    try {
      if (fault.empty()) {
        normalize(transform.transform.rotation);
        if (buffer_.setTransform(transform, publisher, is_static))
          note(transform, is_static);
        else
          fault =
              "tf has one of that time already: does a clock stand still, is a recording played "
              "again, or do two tell of it?";
      }
    } catch (const std::exception& error) {
      fault = error.what();
    }
    if (!fault.empty()) complaints.push_back(refusalOf(transform, publisher, fault));
  }
  return complaints;
}

}  // namespace organ_collision::node
