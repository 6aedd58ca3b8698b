#pragma once

#include <ros/time.h>

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "node/cycle.h"
#include "node/log_limit.h"

namespace organ_collision::node {

/// Tells the log what is wrong with pairs and with tf. Not where that is found: who blocks the
/// console would block contacts.
class ComplaintLog {
 public:
  /// About tf, to be written. For any thread.
  void note(const std::string& complaint);

  /// What was noted; and of pairs what has lasted for a second, now and then while it lasts. For
  /// one thread, again and again.
  void write(const std::vector<Complaint>& of_pairs);

 private:
  void writeOfPairs(const std::vector<Complaint>& complaints);

  std::mutex mutex_;  // of the two below
  LogLimit limit_;
  std::vector<std::string> noted_;
  std::map<std::string, ros::SteadyTime> write_at_;  // of pairs with a complaint
};

}  // namespace organ_collision::node
