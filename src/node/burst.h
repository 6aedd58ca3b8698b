#pragma once

#include <set>
#include <string>

namespace organ_collision::node {

/// The frames that have moved since the last answer. Those of one step of a simulator mostly come
/// one right after another: which they are, the last bursts tell.
class Burst {
 public:
  void noteMove(const std::string& frame) { moved_.insert(frame); }
  /// All that has moved is looked at.
  void noteAnswer();

  bool holds(const std::string& frame) const { return moved_.count(frame) > 0; }
  /// All have moved that did before each of the last two answers to any: no more are likely to come
  /// with them. Never where there are none such.
  bool isComplete() const;

 private:
  std::set<std::string> moved_;
  std::set<std::string> former_;    // before the last answer to any
  std::set<std::string> expected_;  // then, and before the one before that
};

}  // namespace organ_collision::node
