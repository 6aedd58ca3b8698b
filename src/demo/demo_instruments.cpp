// The demo's surgeon: moves two instruments over the organ and into it, and publishes their joints.
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <tf2_eigen/tf2_eigen.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "closed_path.h"
#include "parameters.h"
#include "trocar.h"

namespace organ_collision::demo {
namespace {

/// An instrument whose tip goes round a closed path again and again.
struct Instrument {
  std::string name;
  std::vector<Eigen::Vector3d> waypoints;  ///< [m] in the trocar's frame
  double period;                           ///< [s] of one turn
};

double requiredPositive(const ros::NodeHandle& node, const std::string& key) {
  const auto value = required<double>(node, key);
  if (std::isfinite(value) && value > 0.0) return value;
  throw std::invalid_argument("parameter " + node.resolveName(key) + " is " +
                              std::to_string(value) + ", wanted a number above zero");
}

/// The transform of static frames; waits for the first one. Throws tf2::TransformException if it
/// does not come.
Eigen::Isometry3d trocarFromPath(const std::string& trocar, const std::string& frame) {
  const ros::Duration patience(10.0);
  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer);
  return tf2::transformToEigen(buffer.lookupTransform(trocar, frame, ros::Time(0), patience));
}

/// `flat`: x y z of each waypoint [m], one after another.
std::vector<Eigen::Vector3d> toPoints(const std::vector<double>& flat,
                                      const Eigen::Isometry3d& trocar_from_path) {
  if (flat.empty() || flat.size() % 3 != 0) {
    throw std::invalid_argument("a path has " + std::to_string(flat.size()) +
                                " coordinates, wanted three for each waypoint");
  }
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < flat.size(); i += 3) {
    points.push_back(trocar_from_path * Eigen::Vector3d(flat[i], flat[i + 1], flat[i + 2]));
    if (!points.back().allFinite())
      throw std::invalid_argument("a path's waypoint " + std::to_string(i / 3) + " is not finite");
  }
  return points;
}

Instrument instrumentFromParameters(const ros::NodeHandle& node, const std::string& name) {
  const auto trocar_from_path =
      trocarFromPath(name + "_trocar", required<std::string>(node, "frame"));
  const auto flat = required<std::vector<double>>(node, name + "/waypoints");
  return Instrument{name, toPoints(flat, trocar_from_path),
                    requiredPositive(node, name + "/period")};
}

/// Appends the joints that put the tip where it belongs `elapsed` [s] after the start.
void append(sensor_msgs::JointState& state, const Instrument& instrument, double elapsed) {
  const double turn = std::fmod(elapsed, instrument.period) / instrument.period;
  const TrocarJoints joints = jointsForTip(pointOnClosedPath(instrument.waypoints, turn));
  state.name.insert(state.name.end(), {instrument.name + "_yaw", instrument.name + "_pitch",
                                       instrument.name + "_insertion", instrument.name + "_roll"});
  state.position.insert(state.position.end(), {joints.yaw, joints.pitch, joints.insertion, 0.0});
}

void moveInstruments(ros::NodeHandle& node, const ros::NodeHandle& parameters) {
  const double frequency = requiredPositive(parameters, "rate");  // [Hz]
  const std::vector<Instrument> instruments = {instrumentFromParameters(parameters, "left"),
                                               instrumentFromParameters(parameters, "right")};
  const ros::Publisher publisher = node.advertise<sensor_msgs::JointState>("joint_states", 10);
  const ros::SteadyTime start = ros::SteadyTime::now();  // a clock set back must not move the tips
  ros::Rate rate(frequency);
  while (ros::ok()) {
    sensor_msgs::JointState state;
    state.header.stamp = ros::Time::now();
    const double elapsed = (ros::SteadyTime::now() - start).toSec();
    for (const Instrument& instrument : instruments) append(state, instrument, elapsed);
    publisher.publish(state);
    ros::spinOnce();
    rate.sleep();
  }
}

}  // namespace
}  // namespace organ_collision::demo

int main(int argc, char** argv) {
  ros::init(argc, argv, "demo_instruments");
  ros::NodeHandle node;  // the log closes with the last one
  try {
    organ_collision::demo::moveInstruments(node, ros::NodeHandle("~"));
    return 0;
  } catch (const std::exception& error) {
    if (!ros::ok()) return 0;  // asked to stop while it waited
    ROS_FATAL("%s", error.what());
    return 1;
  }
}
