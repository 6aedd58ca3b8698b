#pragma once

#include <ros/time.h>

namespace organ_collision::node {

/// When the next cycle is due, and in which thread. At most `rate` a second, or 10 if that is less;
/// but poses that came late, a tenth of a second of them at most, are answered when they come, and
/// those behind them no later for it. And 10 a second where nothing is new. Times are of a clock
/// that is neither set nor simulated.
class CyclePace {
 public:
  /// `rate` [Hz] > 0.
  CyclePace(double rate, ros::SteadyTime now);

  /// The rate allows the next one from then on.
  ros::SteadyTime allowed() const { return allowed_; }
  /// It is due from then on, be there news or not.
  ros::SteadyTime heartbeat() const;
  /// From then on a look is due though no pose has come: the heart beats, or no answer has looked
  /// for a hundredth of a second whether organs moved. A look besides those of poses, sooner, would
  /// give cycles that the rate has no room for.
  ros::SteadyTime look() const;
  /// So much has waited for so long that only the newest can be answered in time.
  bool isBehind(ros::SteadyTime now) const;

  /// The thread that brings a pose may answer it, which keeps that thread from all else: the last
  /// answer took less than half a millisecond, and is over for as long as it took.
  bool isPrompt(ros::SteadyTime now) const;

  void noteCycle(ros::SteadyTime now);
  /// A look whether a cycle is due, and the cycle, if it was.
  void noteAnswer(ros::SteadyTime began, ros::SteadyTime ended);
  /// Nothing waits.
  void noteCaughtUp(ros::SteadyTime now) { caught_up_ = now; }

 private:
  ros::WallDuration shortest_;  // from one cycle to the next
  ros::WallDuration credit_;    // so far back the rate is made up for
  ros::SteadyTime last_, allowed_, caught_up_, ended_;
  ros::WallDuration length_;  // of the last answer
};

}  // namespace organ_collision::node
