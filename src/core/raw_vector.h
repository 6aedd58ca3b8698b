#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace organ_collision::core {

/// Leaves new elements of plain types without a value.
template <class T>
class RawAllocator : public std::allocator<T> {
 public:
  template <class Other>
  struct rebind {  // NOLINT(readability-identifier-naming): the name that std::vector wants
    using other = RawAllocator<Other>;
  };

  RawAllocator() = default;
  template <class Other>
  RawAllocator(const RawAllocator<Other>& other) : std::allocator<T>(other) {}

  template <class Item, class... Arguments>
  void construct(Item* place, Arguments&&... arguments) {
    if constexpr (sizeof...(Arguments) == 0) {
      ::new (static_cast<void*>(place)) Item;
    } else {
      ::new (static_cast<void*>(place)) Item(std::forward<Arguments>(arguments)...);
    }
  }
};

/// For what is written on all cores, or only in part: whoever writes first touches the memory.
template <class T>
using RawVector = std::vector<T, RawAllocator<T>>;

}  // namespace organ_collision::core
