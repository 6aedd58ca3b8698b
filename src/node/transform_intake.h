#pragma once

#include <ros/time.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include <map>
#include <string>
#include <vector>

#include "node/burst.h"

namespace organ_collision::node {

/// Puts into tf's buffer what comes from /tf and /tf_static, rotations normalized. Where time runs
/// backwards (a bag that loops, a simulation that is reset) all that moves is forgotten, as tf2_ros
/// does. What would spoil the buffer is refused:
/// - a transform ahead of the clock, which tf2_ros takes: the buffer drops what is much older than
///   its newest entry, so one from the future, or one sent before a reset and heard after it, would
///   shut out the true ones until their time has come;
/// - one on /tf without a stamp: tf2 would keep the first of them for ever;
/// - what is no transform at all;
/// - one that would close a loop, in which tf2 finds nothing any more;
/// - what moves a frame that was static, or the other way round: tf2 takes a frame for what it was
///   first, and would call it static for ever, or old;
/// - what has a stamp that the frame had, or is older than what tf keeps: tf2 drops it.
class TransformIntake {
 public:
  static constexpr double kFarthestAhead = 1.0;  ///< [s] so much may clocks of machines differ

  /// `buffer` must outlive this. From then on no buffer of this process warns on stderr.
  explicit TransformIntake(tf2::BufferCore& buffer);

  /// Forgets what moves where time has jumped back since the last call, and says so; else empty.
  /// `now` is the clock that the stamps are of.
  std::string noteTime(const ros::Time& now);

  /// Returns what there is to complain of: what noteTime() says, and why each transform was refused
  /// that was. Never throws for what a transform says.
  std::vector<std::string> take(const tf2_msgs::TFMessage& message, const std::string& publisher,
                                bool is_static, const ros::Time& now);

  /// All that has been taken is looked at.
  void noteAnswer() { burst_.noteAnswer(); }
  /// All that is likely to come together has been taken since then.
  bool isComplete() const { return burst_.isComplete(); }
  /// The message has a frame that was taken since then: what was taken would be looked at no more.
  bool overtakes(const tf2_msgs::TFMessage& message) const;

 private:
  /// What tf has of a frame.
  struct Known {
    bool is_static;
    ros::Time newest;    // since time last jumped back
    std::string parent;  // last; empty: forgotten
  };

  bool isBelow(const std::string& frame, const std::string& other) const;
  std::string conflictOf(const geometry_msgs::TransformStamped& transform, bool is_static) const;
  void note(const geometry_msgs::TransformStamped& transform, bool is_static);

  tf2::BufferCore& buffer_;
  ros::Time last_;                      // that noteTime() was told
  std::map<std::string, Known> known_;  // by frame; their parents make no loop
  Burst burst_;
};

}  // namespace organ_collision::node
