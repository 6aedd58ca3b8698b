#include "node/collision_node.h"

#include <organ_collision/MeshInfoArray.h>

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <utility>

#include "node/conversions.h"
#include "node/duty.h"
#include "node/scene_loader.h"
#include "node/scene_report.h"

namespace organ_collision::node {
namespace {

constexpr double kMarkerPeriod = 1.0 / 30;  // [s]
constexpr double kDiagnosticPeriod = 1.0;   // [s]
constexpr double kMeshInfoPeriod = 0.1;     // [s] at which refused updates are told
constexpr double kComplaintPeriod = 0.1;    // [s]
constexpr double kMasterPeriod = 1.0;       // [s] between two questions whether it knows this node
constexpr unsigned kSpinnerThreads = 4;     // for questions, and as many for ~update_mesh
constexpr unsigned kTimerThreads = 3;    // a console that blocks and a master that hangs keep two
constexpr unsigned kTfQueue = 10'000;    // messages that wait, each for its cycle
constexpr unsigned kCyclesQueue = 1000;  // that may come before the socket takes them

ros::NodeHandle onQueue(ros::NodeHandle node, ros::CallbackQueueInterface& queue) {
  node.setCallbackQueue(&queue);
  return node;
}

OrganCollisionConfig toConfig(const core::Accuracy& accuracy) {
  OrganCollisionConfig config;
  config.max_relative_error = accuracy.max_relative_error;
  config.max_absolute_error = accuracy.max_absolute_error;
  config.max_leaves = static_cast<int>(accuracy.max_leaves);
  return config;
}

}  // namespace

CollisionNode::CollisionNode(const ros::NodeHandle& node, ros::NodeHandle private_node)
    : scene_(readScene(private_node)),
      organs_(loadOrgans(scene_, node)),
      instruments_(loadInstruments(scene_, node)),
      tf_queue_([this](ros::CallbackInterface& tf) { return answerAtOnce(tf); }),
      tf_node_(onQueue(node, tf_queue_)),
      intake_(buffer_),
      pace_(scene_.rate, ros::SteadyTime::now()),
      cycle_(scene_, instruments_, organs_, buffer_),
      proximity_cycle_(scene_, instruments_, organs_, buffer_),
      accuracy_(scene_.accuracy),
      reconfigure_(reconfigure_mutex_, private_node),
      markers_(scene_, instruments_, organs_),
      master_watch_(log_),
      diagnostics_(node, private_node, organs_, troubles_, master_watch_, log_,
                   [this] { return lastCycle(); }),
      mesh_updates_(organs_, troubles_.update_refusals, log_, [this] { mesh_info_is_old_ = true; }),
      services_(organs_, buffer_, [this] { publishMeshInfo(); }),
      timer_spinner_(kTimerThreads, &timer_queue_),
      change_spinner_(kSpinnerThreads, &change_queue_),
      spinner_(kSpinnerThreads) {
  hearTf("/tf", false);
  hearTf("/tf_static", true);

  reconfigure_.updateConfig(toConfig(accuracy_));
  reconfigure_.setCallback(
      [this](OrganCollisionConfig& wanted, std::uint32_t) { reconfigure(wanted); });

  contacts_publisher_ = private_node.advertise<ContactArray>("contacts", kCyclesQueue);
  if (!scene_.like_pairs.empty())
    proximities_publisher_ = private_node.advertise<ProximityArray>("proximities", kCyclesQueue);
  markers_.advertise(private_node);
  mesh_info_publisher_ = private_node.advertise<MeshInfoArray>("mesh_info", 1, true);
  publishMeshInfo();

  for (const auto& organ : organs_) organ->setSignal(organs_wait_);
  mesh_updates_.subscribe(private_node);
  ros::NodeHandle changes = onQueue(private_node, change_queue_);
  services_.advertise(private_node, changes);
  const ros::NodeHandle timer_node = onQueue(private_node, timer_queue_);
  const auto every = [&](double period, const std::function<void()>& action) {
    timers_.push_back(timer_node.createSteadyTimer(
        ros::WallDuration(period), [action](const ros::SteadyTimerEvent&) { action(); }));
  };
  every(kMarkerPeriod, [this] { markers_.publish(*lastCycle()); });
  every(kDiagnosticPeriod, [this] { diagnostics_.publish(); });
  every(kComplaintPeriod, [this] { log_.write(lastCycle()->complaints); });
  every(kMeshInfoPeriod, [this] {
    if (mesh_info_is_old_.exchange(false)) publishMeshInfo();
  });
  every(kMasterPeriod, [this] { master_watch_.check(); });
  master_watch_.check();
  timer_spinner_.start();
  change_spinner_.start();
  spinner_.start();
  for (const std::string& sentence : report(scene_, instruments_, organs_))
    ROS_INFO("%s", sentence.c_str());
  ROS_INFO("ready; organs: %zu, instruments: %zu, pairs: %zu", scene_.organs.size(),
           scene_.instruments.size(), scene_.pairs.size() + scene_.like_pairs.size());
  updater_ = std::thread(&CollisionNode::updateOrgans, this);  // last: a thread cannot be left
}

CollisionNode::~CollisionNode() {
  timer_spinner_.stop();
  change_spinner_.stop();
  spinner_.stop();
  stopping_ = true;
  organs_wait_->raise();
  updater_.join();
}

/// Refuses what is no accuracy: the settings stay as they are, and are told so.
void CollisionNode::reconfigure(OrganCollisionConfig& wanted) {
  const core::Accuracy accuracy = {wanted.max_relative_error, wanted.max_absolute_error,
                                   static_cast<std::uint32_t>(wanted.max_leaves)};
  try {
    core::requireUsable(accuracy);
  } catch (const std::invalid_argument& error) {
    log_.refuse(std::string("refused to be reconfigured: ") + error.what());
    wanted = toConfig(this->accuracy());
    return;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  accuracy_ = accuracy;
}

void CollisionNode::hearTf(const std::string& topic, bool is_static) {
  using Event = ros::MessageEvent<tf2_msgs::TFMessage const>;
  const boost::function<void(const Event&)> take = [this, is_static](const Event& event) {
    const tf2_msgs::TFMessage& message = *event.getConstMessage();
    // Poses that wait for those that come with them are not overtaken by the next ones.
    const ros::SteadyTime now = ros::SteadyTime::now();
    if (pace_.hasRoomBetween(now) && intake_.overtakes(message)) answer(now);
    pace_.noteMessage(ros::SteadyTime::now());
    for (const std::string& complaint :
         intake_.take(message, event.getPublisherName(), is_static, ros::Time::now()))
      complainOfTf(complaint);
    if (pace_.isGathering() && intake_.isComplete()) pace_.noteComplete();
  };
  tf_subscribers_.push_back(tf_node_.subscribe<tf2_msgs::TFMessage>(
      topic, kTfQueue, take, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
}

void CollisionNode::complainOfTf(const std::string& complaint) {
  log_.warn(complaint);
  troubles_.tf_complaints.note(complaint);
}

void CollisionNode::run() {
  pace_.noteCaughtUp(ros::SteadyTime::now());  // what came while the node was made is not late
  while (ros::ok()) {
    tf_queue_.wait(std::max(pace_.due() - ros::SteadyTime::now(), ros::WallDuration(0)));
    // One at a time: every pose gets its contact, as long as the rate allows.
    tf_queue_.waiting().callOne();
    const ros::SteadyTime now = ros::SteadyTime::now();
    if (now >= pace_.due()) answerInTurn(now);
    if (ros::SteadyTime::now() >= complaints_due_) collectComplaints();
  }
}

void CollisionNode::answerInTurn(ros::SteadyTime now) {
  ros::CallbackQueue& waiting = tf_queue_.waiting();
  // Who cannot keep up answers the newest poses, not all of them ever later.
  if (pace_.isBehind(now) && !waiting.isEmpty()) {
    waiting.callAvailable();
    ++troubles_.times_behind;
  }
  if (waiting.isEmpty()) pace_.noteCaughtUp(now);
  answer(now);
}

bool CollisionNode::answerAtOnce(ros::CallbackInterface& tf) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  const bool is_gathering = pace_.isGathering();  // run() waits for what comes with it
  if (!is_gathering && !pace_.isPrompt(now)) return false;
  tf.call();
  if (is_gathering && !pace_.isPrompt(now)) return true;
  pace_.noteCaughtUp(now);
  answer(now);
  return true;
}

/// What tf has said, and what became of the organs, if that is any news or the heart beats.
void CollisionNode::answer(ros::SteadyTime now) {
  if (const std::string jump = intake_.noteTime(ros::Time::now()); !jump.empty())
    complainOfTf(jump);  // what tf said before is no pose of now, though tf be silent
  intake_.noteAnswer();
  const bool tips_moved = cycle_.lookUpTips();
  const bool others_moved = proximity_cycle_.lookUp();
  if (tips_moved || others_moved || now >= pace_.heartbeat()) {
    publishCycle();
    pace_.noteCycle(now);
  }
  pace_.noteAnswer(now, ros::SteadyTime::now());
}

void CollisionNode::publishCycle() {
  const ros::Time now = ros::Time::now();
  const core::Accuracy accuracy = this->accuracy();
  auto cycle = std::make_shared<Cycle>();
  cycle->contacts = cycle_.contacts(now, accuracy);
  contacts_publisher_.publish(cycle->contacts);
  if (proximities_publisher_) {
    cycle->proximities = proximity_cycle_.proximities(now, accuracy);
    proximities_publisher_.publish(cycle->proximities);
  }
  cycle->complaints = complaints_;
  cycle->published = ros::SteadyTime::now();
  std::shared_ptr<const Cycle> former = std::move(cycle);
  const std::lock_guard<std::mutex> lock(mutex_);
  last_cycle_.swap(former);  // if nobody reads it, it is freed after the lock
}

void CollisionNode::collectComplaints() {
  complaints_due_ = ros::SteadyTime::now() + ros::WallDuration(kComplaintPeriod);
  const ros::Time now = ros::Time::now();
  complaints_ = cycle_.complaints(now);
  for (Complaint& complaint : proximity_cycle_.complaints(now))
    complaints_.push_back(std::move(complaint));
}

std::shared_ptr<const Cycle> CollisionNode::lastCycle() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return last_cycle_;
}

core::Accuracy CollisionNode::accuracy() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return accuracy_;
}

void CollisionNode::updateOrgans() {
  setDuty(Duty::kUpdate);
  while (true) {
    organs_wait_->wait();
    if (stopping_) return;
    for (const auto& organ : organs_) {
      try {
        if (organ->work()) publishMeshInfo();
      } catch (const std::exception& error) {  // memory, most likely: what is there goes on
        mesh_info_is_old_ = true;
        log_.refuse(organ->name() + ": could not be updated: " + error.what());
      }
    }
  }
}

void CollisionNode::publishMeshInfo() {
  const std::lock_guard<std::mutex> lock(mesh_info_mutex_);
  MeshInfoArray array;
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    array.meshes.push_back(toMessage(*organs_[i]));
    array.meshes.back().header.stamp = ros::Time::now();
    if (array.meshes.back().last_action == MeshInfo::LOAD)
      array.meshes.back().reason += " for " + partnersOfOrgan(scene_, i);
  }
  mesh_info_publisher_.publish(array);
}

}  // namespace organ_collision::node
