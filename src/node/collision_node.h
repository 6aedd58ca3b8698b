#pragma once

#include <dynamic_reconfigure/server.h>
#include <organ_collision/OrganCollisionConfig.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "node/complaint_log.h"
#include "node/contact_cycle.h"
#include "node/cycle.h"
#include "node/cycle_pace.h"
#include "node/diagnostics.h"
#include "node/marker_publisher.h"
#include "node/master_watch.h"
#include "node/mesh_update_intake.h"
#include "node/prompt_queue.h"
#include "node/proximity_cycle.h"
#include "node/services.h"
#include "node/signal.h"
#include "node/transform_intake.h"
#include "organ_collision/io/scene.h"

namespace organ_collision::node {

/// The ROS node. Its threads: run() hears tf and publishes contacts, or lets roscpp's thread at the
/// sockets do so while it waits; some answer questions, others ~update_mesh, so that no question
/// waits for a build; three tell markers, diagnostics and the log, whatever is asked; one takes in
/// streamed updates, which no service keeps waiting; one refits the organs to these and swaps in
/// what was rebuilt in the background. They meet in the organs' snapshots only.
class CollisionNode {
 public:
  /// Reads the scene and loads the organs. Throws std::exception naming what is wrong.
  CollisionNode(const ros::NodeHandle& node, ros::NodeHandle private_node);
  ~CollisionNode();
  CollisionNode(const CollisionNode&) = delete;
  CollisionNode& operator=(const CollisionNode&) = delete;

  /// Hears tf and publishes contacts until the node is shut down.
  void run();

 private:
  void hearTf(const std::string& topic, bool is_static);
  void complainOfTf(const std::string& complaint);
  bool answerAtOnce(ros::CallbackInterface& tf);
  void answerInTurn(ros::SteadyTime now);
  void answer(ros::SteadyTime now);
  void publishCycle();
  void collectComplaints();
  void reconfigure(OrganCollisionConfig& wanted);
  std::shared_ptr<const Cycle> lastCycle() const;
  core::Accuracy accuracy() const;

  void updateOrgans();
  void publishMeshInfo();

  const io::Scene scene_;
  const Organs organs_;
  const Instruments instruments_;

  // From here to complaints_due_: of run(), and while it waits of the thread that brings what tf
  // says.
  PromptQueue tf_queue_;
  ros::NodeHandle tf_node_;
  tf2::BufferCore buffer_;
  TransformIntake intake_;
  CyclePace pace_;
  ContactCycle cycle_;
  ProximityCycle proximity_cycle_;
  std::vector<Complaint> complaints_;
  ros::SteadyTime complaints_due_;

  Troubles troubles_;
  ComplaintLog log_;

  mutable std::mutex mutex_;  // of the two below; held for the copy of a setting or a pointer
  core::Accuracy accuracy_;
  std::shared_ptr<const Cycle> last_cycle_ = std::make_shared<Cycle>();

  boost::recursive_mutex reconfigure_mutex_;
  dynamic_reconfigure::Server<OrganCollisionConfig> reconfigure_;
  ros::Publisher contacts_publisher_, proximities_publisher_, mesh_info_publisher_;
  std::atomic<bool> mesh_info_is_old_{false};
  std::mutex mesh_info_mutex_;  // so that the latched message is the newest
  MarkerPublisher markers_;     // of a timer alone
  MasterWatch master_watch_;    // of a timer alone
  Diagnostics diagnostics_;     // of a timer alone

  const std::shared_ptr<Signal> organs_wait_ = std::make_shared<Signal>();  // for updater_
  std::atomic<bool> stopping_{false};
  std::thread updater_;

  MeshUpdateIntake mesh_updates_;
  ros::CallbackQueue change_queue_;  // worked off by change_spinner_ alone
  Services services_;
  ros::CallbackQueue timer_queue_;  // worked off by timer_spinner_ alone
  std::vector<ros::SteadyTimer> timers_;
  std::vector<ros::Subscriber> tf_subscribers_;  // none answers any more when these are gone
  // Last: their threads end before what they use.
  ros::AsyncSpinner timer_spinner_, change_spinner_, spinner_;
};

}  // namespace organ_collision::node
