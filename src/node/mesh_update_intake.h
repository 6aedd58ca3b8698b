#pragma once

#include <organ_collision/MeshUpdate.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <cstdint>
#include <functional>

#include "node/complaint_log.h"
#include "node/incidents.h"
#include "node/organ.h"
#include "node/sequence_gaps.h"

namespace organ_collision::node {

/// Takes in what simulators stream, in a thread of its own, which no service keeps waiting: hands
/// each update to its organ, and counts what was refused or lost.
class MeshUpdateIntake {
 public:
  /// All must outlive this. `tell_refusal` is called, by that thread, when an organ has refused an
  /// update.
  MeshUpdateIntake(const Organs& organs, Incidents& refusals, ComplaintLog& log,
                   std::function<void()> tell_refusal);

  /// Hears from now on what comes to `node`.
  void subscribe(ros::NodeHandle node);

 private:
  using Event = ros::MessageEvent<MeshUpdate const>;

  void take(const Event& event);
  std::uint32_t missedBefore(const Event& event);
  void enqueue(Organ& organ, const MeshUpdate& update);

  const Organs& organs_;
  Incidents& refusals_;
  ComplaintLog& log_;
  const std::function<void()> tell_refusal_;
  SequenceGaps gaps_;
  std::uint64_t missed_ = 0;  // and not yet counted
  ros::CallbackQueue queue_;
  ros::Subscriber subscriber_;
  ros::AsyncSpinner spinner_;  // last: its thread ends before what it uses
};

}  // namespace organ_collision::node
