// The demo's soft organ: instruments of tf press into it, and its vertices are streamed, as by any
// simulator.
#include <organ_collision/MeshUpdate.h>
#include <ros/ros.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <string>
#include <vector>

#include "node/frame_lookup.h"
#include "node/log_limit.h"
#include "node/stopwatch.h"
#include "organ_collision/io/mesh_io.h"
#include "parameters.h"
#include "soft_organ.h"

namespace organ_collision::demo {
namespace {

constexpr double kWarningPeriod = 5.0;  // [s]
constexpr double kSlowest = 1.05;       // [s] of the clock for a simulated one; more is told

/// Warns of a simulation that falls behind the clock.
class Pace {
 public:
  void countStep() {
    simulated_ += SoftOrgan::kStep;
    if (simulated_ < kWarningPeriod) return;
    const double passed = watch_.elapsed();
    if (passed > kSlowest * simulated_)
      ROS_WARN("slower than real time: it took %.1f s to simulate %.1f s", passed, simulated_);
    *this = Pace();
  }

 private:
  node::Stopwatch watch_;
  double simulated_ = 0.0;  // [s] since it runs
};

/// What tf last said of each tip.
std::vector<SoftOrgan::TipPose> tipPoses(const tf2::BufferCore& buffer, const std::string& organ,
                                         const std::vector<std::string>& tips,
                                         node::LogLimit& log) {
  std::vector<SoftOrgan::TipPose> organ_from_tips;
  for (const std::string& tip : tips) {
    const node::FrameLookup lookup = node::lookUpFrame(buffer, organ, tip);
    const std::string warning = "'" + tip + "': " + lookup.reason;
    if (!lookup.pose && log.allows(warning)) ROS_WARN("%s", warning.c_str());
    organ_from_tips.push_back(lookup.pose ? SoftOrgan::TipPose(lookup.pose->target_from_source)
                                          : std::nullopt);
  }
  return organ_from_tips;
}

void setPositions(MeshUpdate& update, const core::Points& positions) {
  update.positions.clear();
  update.positions.reserve(3 * positions.size());
  for (const Eigen::Vector3d& position : positions) {
    for (const double coordinate : position)
      update.positions.push_back(static_cast<float>(coordinate));
  }
}

void simulate(ros::NodeHandle& node, const ros::NodeHandle& parameters) {
  MeshUpdate update;
  update.organ = required<std::string>(parameters, "organ");
  update.header.frame_id = required<std::string>(parameters, "frame");
  const auto tips = required<std::vector<std::string>>(parameters, "tips");
  SoftOrgan organ(io::loadMesh(required<std::string>(parameters, "mesh")), tips.size());

  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer);
  const ros::Publisher publisher = node.advertise<MeshUpdate>("mesh_update", 10);
  ros::WallRate rate(1.0 / SoftOrgan::kStep);
  Pace pace;
  node::LogLimit log;
  while (ros::ok()) {
    const std::string torn = update.organ + " was torn too far: it is put back to rest";
    if (!organ.step(tipPoses(buffer, update.header.frame_id, tips, log)) && log.allows(torn))
      ROS_WARN("%s", torn.c_str());
    update.header.stamp = ros::Time::now();
    setPositions(update, organ.positions());
    publisher.publish(update);
    pace.countStep();
    rate.sleep();
  }
}

}  // namespace
}  // namespace organ_collision::demo

int main(int argc, char** argv) {
  ros::init(argc, argv, "demo_organ");
  ros::NodeHandle node;  // the log closes with the last one
  try {
    organ_collision::demo::simulate(node, ros::NodeHandle("~"));
    return 0;
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
}
