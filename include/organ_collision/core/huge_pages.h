#pragma once

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace organ_collision::core {

/// [bytes] The size of a huge page.
constexpr std::size_t kHugePage = std::size_t{1} << 21U;
/// [bytes] Arrays from this size on may lie in huge pages. Of smaller ones too much lies behind the
/// last whole page; and as malloc maps what begins at a page anew each time, the system would have
/// to give all the small pages of that anew, too, when organs are built again and again.
constexpr std::size_t kLeastInHugePages = 2 * kHugePage;

/// Memory for an array of `size` [bytes], in huge pages if it is that large and the system has some
/// to give. Throws std::bad_alloc.
void* allocateArray(std::size_t size, std::size_t alignment);
/// REQUIRES: what was allocated so.
void freeArray(void* array, std::size_t size, std::size_t alignment) noexcept;

/// For arrays that are read here and there: to find an address in one of many small pages can take
/// longer than to read it. New elements of plain types are left without a value: on all cores,
/// whoever writes first touches the memory.
template <class T>
struct HugePageAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): the name that std::vector wants

  HugePageAllocator() = default;
  template <class Other>
  HugePageAllocator(const HugePageAllocator<Other>& /*other*/) {}

  T* allocate(std::size_t count) {
    return static_cast<T*>(allocateArray(count * sizeof(T), alignof(T)));
  }
  void deallocate(T* array, std::size_t count) noexcept {
    freeArray(array, count * sizeof(T), alignof(T));
  }
  template <class Item, class... Arguments>
  void construct(Item* place, Arguments&&... arguments) {
    if constexpr (sizeof...(Arguments) == 0) {
      ::new (static_cast<void*>(place)) Item;
    } else {
      ::new (static_cast<void*>(place)) Item(std::forward<Arguments>(arguments)...);
    }
  }

  friend bool operator==(const HugePageAllocator& /*one*/, const HugePageAllocator& /*other*/) {
    return true;
  }
  friend bool operator!=(const HugePageAllocator& /*one*/, const HugePageAllocator& /*other*/) {
    return false;
  }
};

template <class T>
using HugePageVector = std::vector<T, HugePageAllocator<T>>;

}  // namespace organ_collision::core
