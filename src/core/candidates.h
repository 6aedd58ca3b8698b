#pragma once

#include <cstdint>

namespace organ_collision::core {
namespace {

/// What may be nearest and waits to be measured. An Item has a lower bound of its distance.
template <class Item>
class Candidates {
 public:
  bool isEmpty() const { return count_ == 0; }
  bool isFull() const { return count_ == kMost; }
  /// REQUIRES: it is not full.
  void add(const Item& item) { items_[count_++] = item; }
  /// REQUIRES: it is not empty.
  Item takeNearest() {
    std::uint32_t nearest = 0;
    for (std::uint32_t i = 1; i < count_; ++i)
      if (items_[i].bound < items_[nearest].bound) nearest = i;
    const Item taken = items_[nearest];
    items_[nearest] = items_[--count_];
    return taken;
  }

 private:
  static constexpr std::uint32_t kMost = 16;
  Item items_[kMost];
  std::uint32_t count_ = 0;
};

}  // namespace
}  // namespace organ_collision::core
