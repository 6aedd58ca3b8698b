#include "node/background_thread.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace organ_collision::node {
namespace {

int priorityOfThisThread() {
  return getpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)));
}

TEST(BackgroundThread, RunsItsTasksInOrder) {
  BackgroundThread thread;
  std::vector<int> ran;
  std::promise<void> done;
  for (const int i : {1, 2, 3}) thread.run([&ran, i] { ran.push_back(i); });
  thread.run([&done] { done.set_value(); });
  done.get_future().wait();
  EXPECT_EQ(ran, (std::vector<int>{1, 2, 3}));
}

TEST(BackgroundThread, StepsBackBehindTheOthers) {
  if (priorityOfThisThread() >= 19) GTEST_SKIP() << "nothing steps back farther";
  BackgroundThread thread;
  std::promise<int> priority;
  thread.run([&priority] { priority.set_value(priorityOfThisThread()); });
  EXPECT_GT(priority.get_future().get(), priorityOfThisThread());
}

TEST(BackgroundThread, LeavesTheOtherProcessorsToTheOthers) {
  BackgroundThread thread;
  std::mutex mutex;
  std::set<std::thread::id> threads;
  std::promise<std::thread::id> done;
  thread.run([&] {
    tbb::parallel_for(0, 100, [&](int /*part*/) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      const std::lock_guard<std::mutex> lock(mutex);
      threads.insert(std::this_thread::get_id());
    });
    done.set_value(std::this_thread::get_id());
  });
  const std::thread::id own = done.get_future().get();
  EXPECT_EQ(threads, std::set<std::thread::id>{own});
}

TEST(BackgroundThread, IsOneForAllWhoHoldIt) {
  EXPECT_EQ(BackgroundThread::shared(), BackgroundThread::shared());
  const auto first = BackgroundThread::shared();
  EXPECT_EQ(first, BackgroundThread::shared());
}

TEST(BackgroundThread, FinishesWhatItBegan) {
  bool finished = false;
  std::promise<void> started;
  {
    BackgroundThread thread;
    thread.run([&] {
      started.set_value();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      finished = true;
    });
    started.get_future().wait();
  }
  EXPECT_TRUE(finished);
}

}  // namespace
}  // namespace organ_collision::node
