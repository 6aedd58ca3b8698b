#include <ros/ros.h>
#include <ros/topic_manager.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <clocale>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <future>
#include <memory>
#include <optional>
#include <thread>

#include "node/collision_node.h"
#include "node/duty.h"

namespace {

using organ_collision::node::CollisionNode;
using organ_collision::node::Duty;
using organ_collision::node::setDuty;

constexpr std::chrono::milliseconds kGrace(500);  // for an orderly end, before it is a quick one

std::atomic<bool> told_to_end{false};
std::atomic<int> exit_code{0};

/// Ends the process when it is told to (Ctrl-C, roslaunch, rosnode kill, another of its name),
/// wherever main() is then: waiting for the master, loading a mesh, within an update. REQUIRES: no
/// other thread runs yet.
void endWhenTold() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // in all threads: they inherit it
  std::thread([signals] {
    const timespec a_while = {0, 100'000'000};
    while (sigtimedwait(&signals, nullptr, &a_while) < 0 && !ros::isShuttingDown()) {
    }
    told_to_end = true;
    ros::requestShutdown();
    std::this_thread::sleep_for(kGrace);
    std::_Exit(exit_code);
  }).detach();
}

/// With threads that work for milliseconds, and must not keep those waiting that answer in
/// microseconds.
std::unique_ptr<CollisionNode> makeNode() {
  setDuty(Duty::kServe);
  return std::make_unique<CollisionNode>(ros::NodeHandle(), ros::NodeHandle("~"));
}

/// What is logged before rosout listens is told on the console alone. A master may have no rosout.
void waitForRosout() {
  ros::V_string nodes;
  ros::master::getNodes(nodes);
  if (std::find(nodes.begin(), nodes.end(), "/rosout") == nodes.end()) return;
  const ros::SteadyTime patience_ends = ros::SteadyTime::now() + ros::WallDuration(1.0);
  while (ros::TopicManager::instance()->getNumSubscribers("/rosout") == 0 &&
         ros::SteadyTime::now() < patience_ends)
    ros::WallDuration(0.01).sleep();
}

}  // namespace

int main(int argc, char** argv) {
  std::setlocale(LC_CTYPE, "");  // the log shows names of files as they are
  endWhenTold();
  std::optional<ros::NodeHandle> keeps_the_log_open;  // it closes with the last handle
  try {
    ros::init(argc, argv, "organ_collision", ros::init_options::NoSigintHandler);
    setDuty(Duty::kAnswer);
    // Starts the threads that read and write sockets: they answer tips too.
    keeps_the_log_open.emplace();
    waitForRosout();
    std::async(std::launch::async, makeNode).get()->run();
  } catch (const std::exception& error) {
    if (told_to_end) return 0;  // what loads while the node ends finds no master
    exit_code = 1;
    ROS_FATAL("%s", error.what());
    ros::WallDuration(0.2).sleep();  // until rosout has it
  }
  return exit_code;
}
