#pragma once

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <new>
#include <utility>

// A program with one source, which includes this, has an operator new that throws when it is told
// to.
namespace organ_collision::test {

/// For the calling thread.
class Memory {
 public:
  static Memory& ofThisThread() {
    thread_local Memory memory;
    return memory;
  }

  /// The next allocation but `count` fails, no other.
  void failAfter(std::size_t count) { left_ = count; }
  /// All allocations fail while `is_out` is set.
  void failWhile(const std::atomic<bool>* is_out) { is_out_ = is_out; }
  /// Whether the failure that was asked for has happened.
  bool recover() { return std::exchange(left_, kNever) == kNever; }

  void* allocate(std::size_t size, std::size_t alignment) {
    const bool fails = left_ == 0 || (is_out_ != nullptr && *is_out_);
    if (left_ != kNever) left_ = left_ == 0 ? kNever : left_ - 1;
    void* const memory =
        fails ? nullptr
              : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
  }

 private:
  static constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();
  std::size_t left_ = kNever;
  const std::atomic<bool>* is_out_ = nullptr;
};

/// Does `action` with each of its allocations failing in turn, then with none; `check(failed)`
/// comes after each. `prepare()` comes before.
template <class Prepare, class Action, class Check>
void failEachAllocation(const Prepare& prepare, const Action& action, const Check& check) {
  bool happened = true;
  for (std::size_t count = 0; happened; ++count) {
    prepare();
    bool failed = false;  // or somebody bore it
    Memory::ofThisThread().failAfter(count);
    try {
      action();
    } catch (const std::bad_alloc&) {
      failed = true;
    }
    happened = Memory::ofThisThread().recover();
    check(failed);
  }
}

}  // namespace organ_collision::test

[[gnu::noinline]] void* operator new(std::size_t size) {
  return organ_collision::test::Memory::ofThisThread().allocate(size, alignof(std::max_align_t));
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  return organ_collision::test::Memory::ofThisThread().allocate(
      size, static_cast<std::size_t>(alignment));
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t /*alignment*/) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/,
                                       std::align_val_t /*alignment*/) noexcept {
  std::free(memory);
}
