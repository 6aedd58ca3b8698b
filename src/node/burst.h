#pragma once

#include <map>
#include <string>

namespace organ_collision::node {

/// The frames that have moved since the last answer. Those of one step of a simulator mostly come
/// one right after another: which they are, the last bursts tell.
class Burst {
 public:
  void noteMove(const std::string& frame) { frames_[frame].has_moved = true; }
  /// All that has moved is looked at.
  void noteAnswer();

  bool holds(const std::string& frame) const;
  /// All have moved that did before each of the last two answers to any: no more are likely to come
  /// with them. Never where there are none such. O(frames), as noteAnswer().
  bool isComplete() const;

 private:
  struct Frame {
    bool has_moved = false;
    bool had_moved = false;    // before the last answer to any
    bool is_expected = false;  // had, and before the one before that
  };

  std::map<std::string, Frame> frames_;  // that have moved since, or before the last answer to any
};

}  // namespace organ_collision::node
