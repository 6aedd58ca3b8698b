// What happens to an organ where its background thread finds no memory: this program's operator new
// throws there, when it is told to.
#include <gmock/gmock.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <future>
#include <memory>
#include <new>

#include "node/background_thread.h"
#include "node/cube_organ.h"
#include "node/moves.h"
#include "node/organ.h"
#include "test_meshes.h"

namespace {

thread_local bool is_background = false;
std::atomic<bool> background_has_memory{true};

void* allocate(std::size_t size, std::size_t alignment) {
  const bool fails = is_background && !background_has_memory;
  void* const memory =
      fails ? nullptr
            : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

[[gnu::noinline]] void* operator new(std::size_t size) {
  return allocate(size, alignof(std::max_align_t));
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
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

namespace organ_collision::node {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// While it lives, the background thread has no memory.
class NoMemory {
 public:
  NoMemory() {
    std::promise<void> known;
    thread_->run([&] {
      is_background = true;
      known.set_value();
    });
    known.get_future().wait();
    background_has_memory = false;
  }
  ~NoMemory() { background_has_memory = true; }
  NoMemory(const NoMemory&) = delete;
  NoMemory& operator=(const NoMemory&) = delete;

 private:
  const std::shared_ptr<BackgroundThread> thread_ = BackgroundThread::shared();
};

TEST(OrganOutOfMemory, TellsWhoAskedForARebuildAndNobodyElse) {
  Organ organ("liver", "liver_frame", test::blob(4));
  {
    const NoMemory no_memory;
    EXPECT_THROW(organ.update({}, UpdateMode::kRebuild, 0), std::bad_alloc);
  }
  EXPECT_EQ(organ.builds().count, 1U);
  EXPECT_THAT(organ.builds().failure, HasSubstr("bad_alloc"));
  EXPECT_EQ(organ.update({}, UpdateMode::kRebuild, 0).action, Action::kRebuild);
  EXPECT_EQ(organ.builds().count, 2U);
  EXPECT_THAT(organ.builds().failure, IsEmpty());
}

TEST(OrganOutOfMemory, MovesOnWhereARebuildFailedThatNobodyAskedFor) {
  Organ organ("liver", "liver_frame", test::blob(4));
  const auto signal = std::make_shared<Signal>();
  organ.setSignal(signal);
  const NoMemory no_memory;
  wearOut(organ);
  for (int turn = 0; turn < 100 && organ.builds().failure.empty(); ++turn) {
    signal->wait();  // raised by the queries, and by the rebuild that is over
    EXPECT_FALSE(organ.work());
  }
  EXPECT_THAT(organ.builds().failure, HasSubstr("bad_alloc"));
  const core::Points positions = test::blob(4).positions();
  organ.enqueue(test::movesOf({3}, {positions[3]}));
  EXPECT_TRUE(organ.work());
  EXPECT_EQ(organ.snapshot()->organ.mesh().positions()[3], positions[3]);
  EXPECT_EQ(organ.counters().updates_lost, 0U);
}

}  // namespace
}  // namespace organ_collision::node
