#pragma once

#include <ros/ros.h>

#include <cstdint>
#include <vector>

#include "node/cycle.h"
#include "node/instrument.h"
#include "node/organ.h"
#include "organ_collision/io/scene.h"

namespace organ_collision::node {

/// Shows rviz what the node answers, while someone listens. For one thread.
class MarkerPublisher {
 public:
  /// All three must outlive this. REQUIRES: instruments and organs are the scene's, in its order.
  MarkerPublisher(const io::Scene& scene, const Instruments& instruments, const Organs& organs);

  void advertise(ros::NodeHandle& node);

  /// A cycle's answers; organs that have changed since they were drawn; and all organs and
  /// instruments for who starts to listen, and now and then for whose start was not seen.
  void publish(const Cycle& cycle);

 private:
  const io::Scene& scene_;
  const Instruments& instruments_;
  const Organs& organs_;
  ros::Publisher publisher_;
  std::vector<std::uint32_t> drawn_versions_;  // of the organs
  ros::SteadyTime all_drawn_;
  std::uint32_t listeners_ = 0;  // the last time
};

}  // namespace organ_collision::node
