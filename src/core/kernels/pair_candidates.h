#pragma once

#include <cstdint>

namespace organ_collision::core {
namespace {

/// Triangles that may be the nearest two.
struct PairCandidate {
  float bound;  ///< of their distance, from below
  std::uint32_t leaf_of_first, leaf_of_second;
};

/// Those that wait to be measured.
class PairCandidates {
 public:
  bool isEmpty() const { return count_ == 0; }
  bool isFull() const { return count_ == kMost; }
  /// REQUIRES: it is not full.
  void add(const PairCandidate& item) { items_[count_++] = item; }
  /// REQUIRES: it is not empty.
  PairCandidate takeNearest() {
    std::uint32_t nearest = 0;
    for (std::uint32_t i = 1; i < count_; ++i)
      if (items_[i].bound < items_[nearest].bound) nearest = i;
    const PairCandidate taken = items_[nearest];
    items_[nearest] = items_[--count_];
    return taken;
  }

 private:
  static constexpr std::uint32_t kMost = 16;
  PairCandidate items_[kMost];
  std::uint32_t count_ = 0;
};

}  // namespace
}  // namespace organ_collision::core
