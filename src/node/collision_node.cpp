#include "node/collision_node.h"

#include <organ_collision/MeshInfoArray.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "node/conversions.h"
#include "node/cycle_pace.h"
#include "node/duty.h"
#include "node/markers.h"
#include "node/scene_loader.h"
#include "node/scene_report.h"

namespace organ_collision::node {
namespace {

constexpr double kSilence = 0.01;           // [s] without tf, before a look whether organs moved
constexpr double kMarkerPeriod = 1.0 / 30;  // [s]
constexpr double kSurfacePeriod = 2.0;      // [s] for who starts to listen late
constexpr double kDiagnosticPeriod = 1.0;   // [s]
constexpr double kPatience = 1.0;           // [s] before the first warning about a pair
constexpr double kWarningPeriod = LogLimit::kPeriod;  // between warnings about one pair
constexpr double kMasterPeriod = 1.0;     // [s] between two questions whether it knows this node
constexpr unsigned kSpinnerThreads = 4;   // of each: what takes long keeps not all others waiting
constexpr unsigned kTfQueue = 100;        // as tf2_ros has it
constexpr unsigned kContactsQueue = 100;  // cycles that may come before the socket takes them
constexpr unsigned kUpdateQueue =
    100;  // taken in faster than they come: each is only added to what waits

ros::NodeHandle onQueue(ros::NodeHandle node, ros::CallbackQueue& queue) {
  node.setCallbackQueue(&queue);
  return node;
}

bool isLatched(const ros::MessageEvent<MeshUpdate const>& event) {
  const auto entry = event.getConnectionHeader().find("latching");
  return entry != event.getConnectionHeader().end() && entry->second == "1";
}

OrganCollisionConfig toConfig(const core::Accuracy& accuracy) {
  OrganCollisionConfig config;
  config.max_relative_error = accuracy.max_relative_error;
  config.max_absolute_error = accuracy.max_absolute_error;
  config.max_leaves = static_cast<int>(accuracy.max_leaves);
  return config;
}

/// A warning each time that there are more of them.
void diagnoseNews(const std::string& what, Incidents& incidents,
                  diagnostic_updater::DiagnosticStatusWrapper& status) {
  const Incidents::News news = incidents.takeNews();
  status.add(what, news.count);
  if (news.more == 0) return;
  status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN,
                      what + ": " + std::to_string(news.more) + ", the last " + news.last);
}

}  // namespace

CollisionNode::CollisionNode(const ros::NodeHandle& node, ros::NodeHandle private_node)
    : scene_(readScene(private_node)),
      organs_(loadOrgans(scene_, node)),
      instruments_(loadInstruments(scene_, node)),
      tf_node_(onQueue(node, tf_queue_)),
      intake_(buffer_),
      cycle_(scene_, instruments_, organs_, buffer_),
      proximity_cycle_(scene_, instruments_, organs_, buffer_),
      accuracy_(scene_.accuracy),
      reconfigure_(reconfigure_mutex_, private_node),
      diagnostics_(node, private_node, ros::this_node::getName()),
      services_(organs_, buffer_, [this] { publishMeshInfo(); }),
      update_spinner_(1, &update_queue_),
      change_spinner_(kSpinnerThreads, &change_queue_),
      spinner_(kSpinnerThreads) {
  hearTf("/tf", false);
  hearTf("/tf_static", true);

  reconfigure_.updateConfig(toConfig(accuracy_));
  reconfigure_.setCallback(
      [this](OrganCollisionConfig& wanted, std::uint32_t) { reconfigure(wanted); });

  diagnostics_.setHardwareID("none");
  diagnostics_.add("contacts", this, &CollisionNode::diagnose);

  contacts_publisher_ = private_node.advertise<ContactArray>("contacts", kContactsQueue);
  if (!scene_.like_pairs.empty())
    proximities_publisher_ = private_node.advertise<ProximityArray>("proximities", 10);
  markers_publisher_ = private_node.advertise<visualization_msgs::MarkerArray>("markers", 2);
  mesh_info_publisher_ = private_node.advertise<MeshInfoArray>("mesh_info", 1, true);
  publishMeshInfo();

  for (const auto& organ : organs_) {
    organ->setSignal(organs_wait_);
    health_told_[organ->name()] = core::warnings(organ->snapshot()->organ.health());
  }
  mesh_update_subscriber_ =
      onQueue(private_node, update_queue_)
          .subscribe("mesh_update", kUpdateQueue, &CollisionNode::takeMeshUpdate, this,
                     ros::TransportHints().tcpNoDelay());
  ros::NodeHandle changes = onQueue(private_node, change_queue_);
  services_.advertise(private_node, changes);
  const auto every = [&](double period, void (CollisionNode::*action)()) {
    timers_.push_back(private_node.createSteadyTimer(
        ros::WallDuration(period),
        [this, action](const ros::SteadyTimerEvent&) { (this->*action)(); }));
  };
  every(kMarkerPeriod, &CollisionNode::publishMarkers);
  every(kDiagnosticPeriod, &CollisionNode::publishDiagnostics);
  every(kMasterPeriod, &CollisionNode::checkMaster);
  master_watch_.check();
  update_spinner_.start();
  change_spinner_.start();
  spinner_.start();
  for (const std::string& sentence : report(scene_, instruments_, organs_))
    ROS_INFO("%s", sentence.c_str());
  ROS_INFO("%zu organs, %zu instruments, %zu pairs: ready", scene_.organs.size(),
           scene_.instruments.size(), scene_.pairs.size() + scene_.like_pairs.size());
  updater_ = std::thread(&CollisionNode::updateOrgans, this);  // last: a thread cannot be left
}

CollisionNode::~CollisionNode() {
  update_spinner_.stop();
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
    ROS_ERROR("refused to be reconfigured: %s", error.what());
    wanted = toConfig(this->accuracy());
    return;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  accuracy_ = accuracy;
}

void CollisionNode::hearTf(const std::string& topic, bool is_static) {
  using Event = ros::MessageEvent<tf2_msgs::TFMessage const>;
  const boost::function<void(const Event&)> take = [this, is_static](const Event& event) {
    for (std::string& complaint : intake_.take(*event.getConstMessage(), event.getPublisherName(),
                                               is_static, ros::Time::now())) {
      if (tf_log_.allows(complaint)) ROS_WARN("%s", complaint.c_str());
      tf_complaints_.note(std::move(complaint));
    }
  };
  tf_subscribers_.push_back(tf_node_.subscribe<tf2_msgs::TFMessage>(
      topic, kTfQueue, take, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
}

void CollisionNode::run() {
  const ros::WallDuration silence(kSilence);
  CyclePace pace(scene_.rate, ros::SteadyTime::now());
  while (ros::ok()) {
    const ros::WallDuration to_heartbeat = pace.heartbeat() - ros::SteadyTime::now();
    // One at a time: every pose gets its contact, as long as the rate allows.
    tf_queue_.callOne(std::clamp(to_heartbeat, ros::WallDuration(0), silence));
    ros::SteadyTime now = ros::SteadyTime::now();
    for (; ros::ok() && now < pace.allowed(); now = ros::SteadyTime::now())
      tf_queue_.callAvailable(pace.allowed() - now);  // in time: the queue is bounded
    // Who cannot keep up answers the newest poses, not all of them ever later.
    if (pace.isBehind(now) && !tf_queue_.isEmpty()) {
      tf_queue_.callAvailable();
      ++times_behind_;
    }
    if (tf_queue_.isEmpty()) pace.noteCaughtUp(ros::SteadyTime::now());
    const bool tips_moved = cycle_.lookUpTips();
    const bool others_moved = proximity_cycle_.lookUp();
    if (!tips_moved && !others_moved && now < pace.heartbeat()) continue;
    publishCycle();
    pace.noteCycle(now);
  }
}

void CollisionNode::publishCycle() {
  const ros::Time now = ros::Time::now();
  const core::Accuracy accuracy = this->accuracy();
  auto cycle = std::make_shared<Cycle>();
  cycle->contacts = cycle_.contacts(now, accuracy);
  contacts_publisher_.publish(cycle->contacts);
  cycle->complaints = cycle_.complaints(now);
  if (proximities_publisher_) {
    cycle->proximities = proximity_cycle_.proximities(now, accuracy);
    proximities_publisher_.publish(cycle->proximities);
    for (Complaint& complaint : proximity_cycle_.complaints(now))
      cycle->complaints.push_back(std::move(complaint));
  }
  warn(cycle->complaints);
  std::shared_ptr<const Cycle> former = std::move(cycle);
  const std::lock_guard<std::mutex> lock(mutex_);
  last_cycle_.swap(former);  // if nobody reads it, it is freed after the lock
}

void CollisionNode::warn(const std::vector<Complaint>& complaints) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  std::map<std::string, ros::SteadyTime> warn_at;
  for (const Complaint& complaint : complaints) {
    const std::string pair = complaint.first + " to " + complaint.second;
    const auto known = warn_at_.find(pair);
    ros::SteadyTime& due = warn_at[pair] =
        known == warn_at_.end() ? now + ros::WallDuration(kPatience) : known->second;
    if (now < due) continue;
    due = now + ros::WallDuration(kWarningPeriod);
    ROS_WARN("%s: %s", pair.c_str(), complaint.reason.c_str());
  }
  warn_at_ = std::move(warn_at);  // who has nothing to complain of any more starts anew
}

std::shared_ptr<const CollisionNode::Cycle> CollisionNode::lastCycle() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return last_cycle_;
}

core::Accuracy CollisionNode::accuracy() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return accuracy_;
}

void CollisionNode::takeMeshUpdate(const ros::MessageEvent<MeshUpdate const>& event) {
  const MeshUpdate& update = *event.getConstMessage();
  missed_updates_ += missedBefore(event);
  try {
    Organ& organ = organNamed(organs_, update.organ);
    organ.countLostUpdates(std::exchange(missed_updates_, 0));  // its own, most likely
    enqueue(organ, update);
  } catch (const std::exception& error) {
    std::string refusal = "an update of the mesh of '" + update.organ + "' by " +
                          event.getPublisherName() + ": " + error.what();
    if (update_log_.allows(refusal)) ROS_ERROR("refused %s", refusal.c_str());
    update_refusals_.note(std::move(refusal));
  }
}

/// How many updates of this one's publisher did not come.
std::uint32_t CollisionNode::missedBefore(const ros::MessageEvent<MeshUpdate const>& event) {
  const std::string& publisher = event.getPublisherName();
  const std::uint32_t missed = update_gaps_.before(publisher, event.getConstMessage()->header.seq);
  // rospy counts up for each one that subscribes to what is latched.
  if (missed == 0 || isLatched(event)) return 0;
  const std::string loss =
      std::to_string(missed) + " mesh updates of " + publisher + " were lost on the way here";
  if (update_log_.allows(loss)) ROS_WARN("%s", loss.c_str());
  return missed;
}

void CollisionNode::enqueue(Organ& organ, const MeshUpdate& update) {
  try {
    organ.requireFrame(update.header.frame_id);
    organ.enqueue(movesFrom(update));
  } catch (const std::exception&) {
    organ.countLostUpdates(1);
    publishMeshInfo();
    throw;
  }
}

void CollisionNode::updateOrgans() {
  setDuty(Duty::kUpdate);
  while (true) {
    organs_wait_->wait();
    if (stopping_) return;
    bool changed = false;
    for (const auto& organ : organs_) {
      try {
        changed = organ->work() || changed;
      } catch (const std::exception& error) {  // memory, most likely: what is there goes on
        ROS_ERROR("%s: could not be updated: %s", organ->name().c_str(), error.what());
      }
    }
    if (changed) publishMeshInfo();
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

void CollisionNode::publishMarkers() {
  if (markers_publisher_.getNumSubscribers() == 0) return;
  const std::shared_ptr<const Cycle> cycle = lastCycle();
  visualization_msgs::MarkerArray markers = contactMarkers(cycle->contacts, scene_, organs_);
  const auto add = [&markers](visualization_msgs::MarkerArray more) {
    std::move(more.markers.begin(), more.markers.end(), std::back_inserter(markers.markers));
  };
  add(proximityMarkers(cycle->proximities));
  const ros::SteadyTime now = ros::SteadyTime::now();
  const bool redraw = (now - surfaces_drawn_).toSec() > kSurfacePeriod;
  if (redraw) surfaces_drawn_ = now;
  for (const auto& organ : organs_) {
    std::uint32_t& drawn = drawn_versions_[organ->name()];
    const std::uint32_t version = organ->snapshot()->version;
    if (!redraw && drawn == version) continue;
    drawn = version;
    add(organMarkers(*organ));
  }
  for (std::size_t i = 0; redraw && i < instruments_.size(); ++i)
    add(instrumentMarkers(instruments_, i));
  markers_publisher_.publish(markers);
}

/// Not update(), which waits for ROS time: that may stand still or jump back.
void CollisionNode::publishDiagnostics() { diagnostics_.force_update(); }

void CollisionNode::checkMaster() { master_watch_.check(); }

void CollisionNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const std::shared_ptr<const Cycle> cycle = lastCycle();
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, "contacts flow");
  for (const Complaint& complaint : cycle->complaints) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN,
                        complaint.first + " to " + complaint.second + ": " + complaint.reason);
  }
  if (ros::Time::isSimTime() && ros::Time::now().isZero()) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN,
                        "use_sim_time is set, but /clock stands at 0");
  }
  diagnoseHaste(status);
  diagnoseNews("complaints about tf", tf_complaints_, status);
  diagnoseNews("mesh updates refused", update_refusals_, status);
  status.add("computation time of the last cycle [us]", 1e6 * cycle->contacts.computation_time);
  for (const auto& organ : organs_) {
    const std::shared_ptr<const OrganSnapshot> snapshot = organ->snapshot();
    for (const std::string& sentence : core::warnings(snapshot->organ.health())) {
      status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, organ->name() + ": " + sentence);
    }
    warnOfHealth(organ->name(), *snapshot);
    const Organ::Counters counters = organ->counters();
    status.add(organ->name() + " mesh version", snapshot->version);
    status.add(organ->name() + " last action", snapshot->reason);
    const Organ::Builds builds = organ->builds();
    status.add(organ->name() + " builds", builds.count);
    status.add(organ->name() + " last build", builds.reason);
    status.add(organ->name() + " since then", builds.figures);
    if (!builds.failure.empty()) {
      status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN,
                          organ->name() + " could not be rebuilt: " + builds.failure);
    }
    status.add(organ->name() + " cost ratio", organ->costRatio());
    status.add(organ->name() + " updates merged", counters.updates_merged);
    status.add(organ->name() + " updates lost", counters.updates_lost);
  }
}

/// What an update has brought with it; the rest was told when the organ was loaded.
void CollisionNode::warnOfHealth(const std::string& organ, const OrganSnapshot& snapshot) {
  std::vector<std::string> sentences = core::warnings(snapshot.organ.health());
  const std::vector<std::string>& known = health_told_[organ];
  const std::string since = "'" + organ + "', since it was updated: ";
  for (const std::string& sentence : sentences) {
    if (std::count(known.begin(), known.end(), sentence) > 0) continue;
    const std::string warning = since + sentence;
    if (health_log_.allows(warning)) ROS_WARN("%s", warning.c_str());
  }
  health_told_[organ] = std::move(sentences);
}

/// A warning each time that it happened again.
void CollisionNode::diagnoseHaste(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const std::uint64_t times = times_behind_;
  status.add("times that poses were left out", times);
  if (times == std::exchange(times_behind_told_, times)) return;
  status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN,
                      "this machine cannot keep up with tf: poses are left out");
}

}  // namespace organ_collision::node
