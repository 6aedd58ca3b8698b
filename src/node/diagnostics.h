#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "node/complaint_log.h"
#include "node/cycle.h"
#include "node/incidents.h"
#include "node/master_watch.h"
#include "node/organ.h"
#include "node/surface_check.h"

namespace organ_collision::node {

/// What went wrong until diagnostics tell it, noted by any thread.
struct Troubles {
  Incidents tf_complaints, update_refusals;
  std::atomic<std::uint64_t> times_behind{0};  ///< that poses were left out
};

/// Whether contacts flow: not where the last cycle was published longer ago than any pause between
/// two that the node makes by itself.
diagnostic_msgs::DiagnosticStatus flowOf(const Cycle& last, const ros::SteadyTime& now);

/// Tells /diagnostics what is wrong, and the log what is told nowhere else. For one thread.
class Diagnostics {
 public:
  /// Organs, troubles, master and log must outlive this.
  Diagnostics(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
              const Organs& organs, Troubles& troubles, const MasterWatch& master,
              ComplaintLog& log, std::function<std::shared_ptr<const Cycle>()> last_cycle);

  void publish();

 private:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;

  void diagnose(Status& status);
  void diagnoseClock(Status& status);
  void diagnoseMaster(Status& status);
  void diagnoseHaste(Status& status);
  void diagnoseOrgan(std::size_t number, Status& status);
  void warnOfHealth(std::size_t organ, const std::vector<std::string>& sentences);

  const Organs& organs_;
  Troubles& troubles_;
  const MasterWatch& master_;
  ComplaintLog& log_;
  const std::function<std::shared_ptr<const Cycle>()> last_cycle_;
  std::uint64_t times_behind_told_ = 0;
  std::vector<std::vector<std::string>> health_told_;  // of the organs, without numbers
  std::vector<SurfaceCheck> surface_checks_;           // of the organs
  diagnostic_updater::Updater updater_;
};

}  // namespace organ_collision::node
