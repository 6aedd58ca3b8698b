#include "node/burst.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace organ_collision::node {

void Burst::noteAnswer() {
  const auto has_moved = [](const auto& frame) { return frame.second.has_moved; };
  if (std::none_of(frames_.begin(), frames_.end(), has_moved)) return;
  for (auto i = frames_.begin(); i != frames_.end();) {
    Frame& frame = i->second;
    frame.is_expected = frame.has_moved && frame.had_moved;
    frame.had_moved = std::exchange(frame.has_moved, false);
    i = frame.had_moved ? std::next(i) : frames_.erase(i);
  }
}

bool Burst::holds(const std::string& frame) const {
  const auto found = frames_.find(frame);
  return found != frames_.end() && found->second.has_moved;
}

bool Burst::isComplete() const {
  bool expects_any = false;
  for (const auto& [name, frame] : frames_) {
    if (frame.is_expected && !frame.has_moved) return false;
    expects_any = expects_any || frame.is_expected;
  }
  return expects_any;
}

}  // namespace organ_collision::node
