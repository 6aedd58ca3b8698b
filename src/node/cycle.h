#pragma once

#include <organ_collision/ContactArray.h>
#include <organ_collision/ProximityArray.h>
#include <ros/time.h>

#include <vector>

#include "node/pair_pose.h"

namespace organ_collision::node {

/// What the node found at a time.
struct Cycle {
  ContactArray contacts;
  ProximityArray proximities;  // none where the scene has no such pairs
  std::vector<Complaint> complaints;
  ros::SteadyTime published;  // when it was; zero before the first
};

}  // namespace organ_collision::node
