#include "node/background_thread.h"

#include <tbb/task_arena.h>

#include <utility>

#include "node/duty.h"

namespace organ_collision::node {

std::shared_ptr<BackgroundThread> BackgroundThread::shared() {
  static std::mutex mutex;
  static std::weak_ptr<BackgroundThread> known;
  const std::lock_guard<std::mutex> lock(mutex);
  std::shared_ptr<BackgroundThread> thread = known.lock();
  if (!thread) known = thread = std::make_shared<BackgroundThread>();
  return thread;
}

BackgroundThread::BackgroundThread() : thread_(&BackgroundThread::work, this) {}

BackgroundThread::~BackgroundThread() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void BackgroundThread::run(std::function<void()> task) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    tasks_.push_back(std::move(task));
  }
  changed_.notify_one();
}

void BackgroundThread::work() {
  setDuty(Duty::kRebuild);
  tbb::task_arena alone(1);  // without oneTBB's own threads, which do not step back
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stopping_ || !tasks_.empty(); });
    if (stopping_) return;
    std::function<void()> task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    alone.execute(task);
    task = nullptr;  // what it held is let go outside the lock
    lock.lock();
  }
}

}  // namespace organ_collision::node
