#include "node/cycle_pace.h"

#include <algorithm>

namespace organ_collision::node {
namespace {

constexpr double kHeartbeat = 0.099;       // [s] without news: 10 times a second, and time to wake
constexpr double kSilence = 0.01;          // [s]
constexpr double kCatchUp = 0.1;           // [s] of poses that came together are answered at once
constexpr double kFarthestBehind = 0.2;    // [s] then poses are left out
constexpr double kLongestPrompt = 0.0005;  // [s]

}  // namespace

CyclePace::CyclePace(double rate, ros::SteadyTime now)
    : shortest_(std::min(1.0 / rate, kHeartbeat)),
      credit_(std::max(shortest_, ros::WallDuration(kCatchUp))),
      last_(now),
      allowed_(now),
      caught_up_(now),
      ended_(now) {}

ros::SteadyTime CyclePace::heartbeat() const { return last_ + ros::WallDuration(kHeartbeat); }

ros::SteadyTime CyclePace::look() const {
  return std::min(heartbeat(), ended_ + ros::WallDuration(kSilence));
}

bool CyclePace::isBehind(ros::SteadyTime now) const {
  return now - caught_up_ > ros::WallDuration(kFarthestBehind);
}

bool CyclePace::isPrompt(ros::SteadyTime now) const {
  return allowed_ <= now && length_ < ros::WallDuration(kLongestPrompt) && now - ended_ >= length_;
}

void CyclePace::noteCycle(ros::SteadyTime now) {
  last_ = now;
  allowed_ = std::max(allowed_, now - credit_) + shortest_;
}

void CyclePace::noteAnswer(ros::SteadyTime began, ros::SteadyTime ended) {
  ended_ = ended;
  length_ = ended - began;
}

}  // namespace organ_collision::node
