#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace organ_collision::node {

/// A thread for work that can wait: all others come before it, where the system lets it step back.
/// What a task does in parallel elsewhere, it does alone here.
/// Nothing that holds up a query may hang on a lock that it takes.
class BackgroundThread {
 public:
  /// The one of this process, for all who hold it at the same time.
  static std::shared_ptr<BackgroundThread> shared();

  BackgroundThread();
  /// Finishes the task under way and drops those that wait.
  ~BackgroundThread();
  BackgroundThread(const BackgroundThread&) = delete;
  BackgroundThread& operator=(const BackgroundThread&) = delete;

  /// One after the other. REQUIRES: `task` does not throw and does not hold this thread.
  void run(std::function<void()> task);

 private:
  void work();

  std::mutex mutex_;  // of the two below
  std::deque<std::function<void()>> tasks_;
  bool stopping_ = false;
  std::condition_variable changed_;
  std::thread thread_;
};

}  // namespace organ_collision::node
