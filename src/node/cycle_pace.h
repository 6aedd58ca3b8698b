#pragma once

#include <ros/time.h>

namespace organ_collision::node {

/// When the next cycle is due, and in which thread. At most `rate` a second and a hundredth more,
/// as clocks differ, or 10 if that is less; but poses that came late, a tenth of a second of them
/// at most, are answered when they come, and those behind them no later for it. And 10 a second
/// where nothing is new. Where messages come faster than the rate they are crowded, each instrument
/// in its own most likely: those that come together are answered together, when they are complete
/// or no more come. Times are of a clock that is neither set nor simulated.
class CyclePace {
 public:
  /// `rate` [Hz] > 0.
  CyclePace(double rate, ros::SteadyTime now);

  /// The rate allows the next one from then on.
  ros::SteadyTime allowed() const { return allowed_; }
  /// It is due from then on, be there news or not.
  ros::SteadyTime heartbeat() const;
  /// From then on an answer is due. To messages: when the rate allows it, and where they are
  /// crowded, they are complete or no more come with them. Without any: the heart beats, or no
  /// answer has looked for a hundredth of a second whether organs moved; sooner, besides those to
  /// messages, they would give cycles that the rate has no room for.
  ros::SteadyTime due() const;
  /// Messages are crowded, and some wait for those that come with them.
  bool isGathering() const { return is_crowded_ && has_unanswered_ && !is_complete_; }
  /// They are crowded, and those that wait may be answered though more come: answers are short, and
  /// the rate allows another.
  bool hasRoomBetween(ros::SteadyTime now) const;
  /// So much has waited for so long that only the newest can be answered in time.
  bool isBehind(ros::SteadyTime now) const;

  /// The thread that brings a pose may answer it, which keeps that thread from all else: one
  /// of the last two cycles took less than half a millisecond, and the last has been over for as
  /// long. Not where messages are crowded, until they are complete.
  bool isPrompt(ros::SteadyTime now) const;

  /// One that may have brought poses.
  void noteMessage(ros::SteadyTime now);
  /// All have come that came together the last time.
  void noteComplete() { is_complete_ = true; }
  void noteCycle(ros::SteadyTime now);
  /// A look whether a cycle is due, and the cycle, if it was.
  void noteAnswer(ros::SteadyTime began, ros::SteadyTime ended);
  /// Nothing waits.
  void noteCaughtUp(ros::SteadyTime now) { caught_up_ = now; }

 private:
  /// One of the last two cycles was.
  bool isShort() const;

  ros::WallDuration shortest_;  // from one cycle to the next
  ros::SteadyTime last_, allowed_, caught_up_, ended_;
  // Of the last answer that was a cycle, and the shorter of it and the one before: not to take a
  // stall of the machine for a long cycle.
  ros::WallDuration former_length_, length_;
  bool has_unanswered_ = false, is_complete_ = false;
  ros::SteadyTime first_unanswered_, last_message_;
  ros::SteadyTime allowed_for_each_;  // what allowed_ would be with a cycle for each message
  bool is_crowded_ = false;
};

}  // namespace organ_collision::node
