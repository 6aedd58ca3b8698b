#pragma once

#include <organ_collision/ProximityArray.h>
#include <ros/time.h>
#include <tf2/buffer_core.h>

#include <array>
#include <cstdint>
#include <vector>

#include "node/instrument.h"
#include "node/organ.h"
#include "node/pair_pose.h"
#include "organ_collision/core/proximity.h"
#include "organ_collision/io/scene.h"

namespace organ_collision::node {

/// From poses to proximities: the pairs of two instruments or of two organs. Knows tf's buffer, not
/// the master.
class ProximityCycle {
 public:
  /// All four must outlive this. REQUIRES: instruments and organs are the scene's, in its order.
  ProximityCycle(const io::Scene& scene, const Instruments& instruments, const Organs& organs,
                 const tf2::BufferCore& buffer);

  /// Asks tf where all are; true if something has moved since the last time.
  bool lookUp();

  /// The proximities of all pairs for the poses last looked up, in the scene's frame.
  ProximityArray proximities(const ros::Time& now, const core::Accuracy& accuracy);

  /// What is wrong with a pair's pose; empty if nothing is.
  std::vector<Complaint> complaints(const ros::Time& now) const;

 private:
  struct Tracked {
    io::LikePair pair;
    PairPose pose;
    std::array<std::uint32_t, 2> versions{};  // of the organs when last looked
    core::ProximityTracker tracker = {};      // of organs
  };

  const std::string& nameOf(io::LikePair::Of of, std::size_t i) const;
  Proximity proximityOf(Tracked& tracked, const OrganSnapshots& snapshots, const ros::Time& now,
                        const core::Accuracy& accuracy) const;
  Proximity measure(Tracked& tracked, const OrganSnapshots& snapshots,
                    const core::Accuracy& accuracy) const;
  /// What `measure` finds, unless the boxes or that are farther apart than the scene looks.
  template <class Measure>
  Proximity unlessFar(const Tracked& tracked, const core::Box& first, const core::Box& second,
                      const Measure& measure) const;

  const io::Scene& scene_;
  const Instruments& instruments_;
  const Organs& organs_;
  const tf2::BufferCore& buffer_;
  std::vector<Tracked> tracked_;  // of the scene's pairs, in order
};

}  // namespace organ_collision::node
