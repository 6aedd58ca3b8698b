#pragma once

#include <ros/time.h>

#include <map>
#include <string>

namespace organ_collision::node {

/// The same for texts that differ in their numbers only, but for those of names 'in quotes'.
std::string withoutNumbers(const std::string& text);

/// Lets what is said again and again be logged once in kPeriod. By the steady clock: ROS's own
/// throttles go by a time that may stand still at 0, and then say nothing. For one thread.
class LogLimit {
 public:
  static constexpr double kPeriod = 5.0;  ///< [s]

  /// Whether to log `text`: nothing that is the same without numbers was in the last kPeriod.
  bool allows(const std::string& text, const ros::SteadyTime& now = ros::SteadyTime::now());

 private:
  std::map<std::string, ros::SteadyTime> silent_until_;  // by text without numbers
};

}  // namespace organ_collision::node
