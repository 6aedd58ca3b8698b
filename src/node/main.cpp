#include <ros/ros.h>

#include <exception>

#include "node/collision_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "organ_collision");
  const ros::NodeHandle
      keeps_the_log_open;  // it closes with the last handle, and the error below must get out
  try {
    organ_collision::node::CollisionNode(ros::NodeHandle(), ros::NodeHandle("~")).run();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
