#include "node/background_thread.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <future>
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
  BackgroundThread thread;
  std::promise<int> priority;
  thread.run([&priority] { priority.set_value(priorityOfThisThread()); });
  EXPECT_GT(priority.get_future().get(), priorityOfThisThread());
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
