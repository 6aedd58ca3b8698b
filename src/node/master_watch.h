#pragma once

#include <atomic>
#include <set>
#include <string>

#include "node/complaint_log.h"

namespace organ_collision::node {

/// Keeps this node known to the master. roscpp registers topics and services once: a master that
/// was restarted knows nothing of them, and new clients do not find the node, though it runs.
class MasterWatch {
 public:
  /// `log` must outlive this.
  explicit MasterWatch(ComplaintLog& log) : log_(log) {}

  /// Asks the master what it knows of this node, and registers anew what it has forgotten. Never
  /// waits for a master that is away, only for one that hangs. To be called now and then, the first
  /// time when all services are advertised. Cost: one call of the master. The log tells what was
  /// found.
  void check();

  /// What is wrong with the master; empty if it answers. For any thread.
  std::string complaint() const;

 private:
  void registerMissing();

  ComplaintLog& log_;
  std::set<std::string> services_;  // that some master knew of; roscpp does not tell
  std::atomic<bool> is_away_{false};
  std::atomic<double> asks_since_{0.0};  // [s] by the steady clock; 0: it does not
};

}  // namespace organ_collision::node
