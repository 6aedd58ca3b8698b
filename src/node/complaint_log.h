#pragma once

#include <ros/time.h>

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "node/cycle.h"
#include "node/log_limit.h"

namespace organ_collision::node {

/// Tells the log what is wrong while the node runs. One thread writes it, none where it is found:
/// who blocks the console would block contacts, updates or diagnostics.
class ComplaintLog {
 public:
  /// To be written, as a warning; the like once in LogLimit::kPeriod. For any thread, as the next.
  void warn(const std::string& complaint) { note({complaint, false}); }
  /// As an error: what was asked for was not done.
  void refuse(const std::string& complaint) { note({complaint, true}); }

  /// What was noted; and of pairs what has lasted for a second, now and then while it lasts. For
  /// one thread, again and again.
  void write(const std::vector<Complaint>& of_pairs);

 private:
  struct Noted {
    std::string complaint;
    bool is_error;
  };

  void note(Noted noted);
  void writeOfPairs(const std::vector<Complaint>& complaints);

  std::mutex mutex_;  // of the two below
  LogLimit limit_;
  std::vector<Noted> noted_;
  std::map<std::string, ros::SteadyTime> write_at_;  // of pairs with a complaint
};

}  // namespace organ_collision::node
