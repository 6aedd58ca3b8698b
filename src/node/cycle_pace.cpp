#include "node/cycle_pace.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

namespace organ_collision::node {
namespace {

constexpr double kMoreThanRate = 1.01;     // clocks differ, and a cycle too many is made up for
constexpr double kHeartbeat = 0.099;       // [s] without news: 10 times a second, and time to wake
constexpr double kSilence = 0.01;          // [s]
constexpr double kCatchUp = 0.1;           // [s] of poses that came together are answered at once
constexpr double kFarthestBehind = 0.2;    // [s] then poses are left out
constexpr double kLongestPrompt = 0.0005;  // [s] of a cycle
constexpr double kQuiet = 0.0005;  // [s] without a message, or half a cycle: no more will come

}  // namespace

CyclePace::CyclePace(double rate, ros::SteadyTime now)
    : shortest_(std::min(1.0 / (kMoreThanRate * rate), kHeartbeat)),
      last_(now),
      allowed_(now),
      caught_up_(now),
      ended_(now),
      former_length_(std::numeric_limits<std::int32_t>::max(), 0),
      first_unanswered_(now),
      last_message_(now),
      allowed_for_each_(now - ros::WallDuration(kCatchUp)) {}

ros::SteadyTime CyclePace::heartbeat() const { return last_ + ros::WallDuration(kHeartbeat); }

ros::SteadyTime CyclePace::due() const {
  if (!has_unanswered_) return std::min(heartbeat(), ended_ + ros::WallDuration(kSilence));
  if (!isGathering()) return allowed_;
  const ros::SteadyTime quiet =
      last_message_ + std::min(shortest_ * 0.5, ros::WallDuration(kQuiet));
  return std::max(allowed_, std::min(first_unanswered_ + shortest_, quiet));
}

bool CyclePace::isBehind(ros::SteadyTime now) const {
  return now - caught_up_ > ros::WallDuration(kFarthestBehind);
}

bool CyclePace::hasRoomBetween(ros::SteadyTime now) const {
  return is_crowded_ && has_unanswered_ && isShort() && allowed_ + shortest_ <= now;
}

bool CyclePace::isPrompt(ros::SteadyTime now) const {
  return (!is_crowded_ || is_complete_) && isShort() && allowed_ <= now && now - ended_ >= length_;
}

bool CyclePace::isShort() const { return length_ < ros::WallDuration(kLongestPrompt); }

void CyclePace::noteMessage(ros::SteadyTime now) {
  if (!has_unanswered_) first_unanswered_ = now;
  has_unanswered_ = true;
  last_message_ = now;
  const ros::WallDuration credit(kCatchUp);
  allowed_for_each_ = std::clamp(allowed_for_each_, now - credit, now + credit) + shortest_;
  // Only those with news use the rate up, as allowed_ knows, but it forgets once they are gathered.
  is_crowded_ = now < allowed_for_each_ && (is_crowded_ || now < allowed_);
}

void CyclePace::noteCycle(ros::SteadyTime now) {
  last_ = now;
  allowed_ = std::max(allowed_, now - ros::WallDuration(kCatchUp)) + shortest_;
}

void CyclePace::noteAnswer(ros::SteadyTime began, ros::SteadyTime ended) {
  has_unanswered_ = is_complete_ = false;
  ended_ = ended;
  // A look without a cycle does not tell how long one takes.
  if (began != last_) return;
  const ros::WallDuration length = ended - began;
  length_ = std::min(length, std::exchange(former_length_, length));
}

}  // namespace organ_collision::node
