#pragma once

#include <organ_collision/ContactArray.h>
#include <ros/time.h>
#include <tf2/buffer_core.h>

#include <vector>

#include "node/instrument.h"
#include "node/organ.h"
#include "node/pair_pose.h"
#include "organ_collision/core/contact.h"
#include "organ_collision/io/scene.h"

namespace organ_collision::node {

/// From tip poses to contacts: what the node does when tf has news. Knows tf's buffer, not the
/// master.
class ContactCycle {
 public:
  /// All four must outlive this. REQUIRES: instruments and organs are the scene's, in its order.
  ContactCycle(const io::Scene& scene, const Instruments& instruments, const Organs& organs,
               const tf2::BufferCore& buffer);

  /// Asks tf where the tips are; true if a tip or an organ has moved since the last time.
  bool lookUpTips();

  /// The contacts of all pairs for the poses last looked up, in the scene's frame.
  ContactArray contacts(const ros::Time& now, const core::Accuracy& accuracy);

  /// What is wrong with a pair's pose; empty if nothing is.
  std::vector<Complaint> complaints(const ros::Time& now) const;

 private:
  struct Tracked {
    PairPose pose;              // of the tip, the first, to the organ
    std::uint32_t version = 0;  // of the organ when last looked
    core::ContactTracker tracker = {};
  };

  Contact contactOf(const io::Pair& pair, const OrganSnapshot& snapshot, Tracked& tracked,
                    const ros::Time& now, const core::Accuracy& accuracy);

  const io::Scene& scene_;
  const Instruments& instruments_;
  const Organs& organs_;
  const tf2::BufferCore& buffer_;
  std::vector<Tracked> tracked_;  // of the scene's pairs, in order
};

}  // namespace organ_collision::node
