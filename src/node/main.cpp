#include <ros/ros.h>
#include <sched.h>

#include <exception>
#include <future>
#include <memory>

#include "node/collision_node.h"

namespace {

using organ_collision::node::CollisionNode;

/// With threads of ordinary priority only, whatever was given to the process: they work for
/// milliseconds, and must not keep those waiting that answer in microseconds.
std::unique_ptr<CollisionNode> makeNode() {
  const sched_param none = {};
  sched_setscheduler(0, SCHED_OTHER, &none);  // of this thread, and of those that it starts
  return std::make_unique<CollisionNode>(ros::NodeHandle(), ros::NodeHandle("~"));
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "organ_collision");
  // It closes with the last handle, and the error below must get out. Starts the threads that read
  // and write sockets: they have a priority that was given to the process, as this thread has.
  const ros::NodeHandle keeps_the_log_open;
  try {
    std::async(std::launch::async, makeNode).get()->run();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
