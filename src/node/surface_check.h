#pragma once

#include <ros/time.h>

#include <cstdint>
#include <memory>
#include <string>

#include "node/background_thread.h"
#include "node/snapshots.h"

namespace organ_collision::node {

/// Whether an organ's surface crosses itself. Looked up in the background, of each hierarchy that
/// was built once, and again as the organ deforms, for a hundredth of a processor's time at most.
/// For one thread.
class SurfaceCheck {
 public:
  /// What was found the last time, "" where nothing was or nobody has looked yet; takes another
  /// look if it is due. Does not wait.
  const std::string& complaint(const std::shared_ptr<const OrganSnapshot>& organ,
                               const ros::SteadyTime& now = ros::SteadyTime::now());

 private:
  struct Look;

  void takeResult(const ros::SteadyTime& now);
  void look(const std::shared_ptr<const OrganSnapshot>& organ);

  std::string complaint_;
  std::uint64_t hierarchy_ = 0;  // of the last look; 0: there was none
  std::uint32_t version_ = 0;
  ros::SteadyTime due_;         // where the hierarchy is the same
  std::shared_ptr<Look> look_;  // under way, or ready
  std::unique_ptr<BackgroundThread> thread_ = std::make_unique<BackgroundThread>();
};

}  // namespace organ_collision::node
