#pragma once

#include <ros/time.h>

#include <map>
#include <string>

namespace organ_collision::node {

/// Lets what is said again and again be logged once in kPeriod. By the steady clock: ROS's own
/// throttles go by a time that may stand still at 0, and then say nothing. For one thread.
class LogLimit {
 public:
  static constexpr double kPeriod = 5.0;  ///< [s]

  /// Whether to log `text`: nothing like it was in the last kPeriod. What differs in its numbers
  /// only is alike, but for names 'in quotes'.
  bool allows(const std::string& text, const ros::SteadyTime& now = ros::SteadyTime::now());

 private:
  std::map<std::string, ros::SteadyTime> silent_until_;  // by text, without its numbers
};

}  // namespace organ_collision::node
