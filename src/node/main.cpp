#include <ros/ros.h>

#include <exception>

#include "node/collision_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "organ_collision");
  try {
    organ_collision::node::CollisionNode(ros::NodeHandle(), ros::NodeHandle("~")).run();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
