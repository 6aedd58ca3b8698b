#include "node/burst.h"

#include <algorithm>
#include <iterator>

namespace organ_collision::node {

void Burst::noteAnswer() {
  if (moved_.empty()) return;
  expected_.clear();
  std::set_intersection(moved_.begin(), moved_.end(), former_.begin(), former_.end(),
                        std::inserter(expected_, expected_.end()));
  former_.swap(moved_);
  moved_.clear();
}

bool Burst::isComplete() const {
  return !expected_.empty() &&
         std::includes(moved_.begin(), moved_.end(), expected_.begin(), expected_.end());
}

}  // namespace organ_collision::node
