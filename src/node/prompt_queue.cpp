#include "node/prompt_queue.h"

#include <chrono>
#include <utility>

namespace organ_collision::node {

PromptQueue::PromptQueue(std::function<bool(ros::CallbackInterface&)> answer_at_once)
    : answer_at_once_(std::move(answer_at_once)) {}

void PromptQueue::addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) {
  const std::lock_guard<std::mutex> lock(mutex_);
  try {
    if (worker_waits_ && !failure_ && waiting_.isEmpty() && answer_at_once_(*callback)) return;
    waiting_.addCallback(callback, owner);
  } catch (...) {  // roscpp's thread would end the process without a word
    failure_ = std::current_exception();
  }
  came_.notify_one();
}

void PromptQueue::wait(const ros::WallDuration& timeout) {
  std::unique_lock<std::mutex> lock(mutex_);
  worker_waits_ = true;
  came_.wait_for(lock, std::chrono::nanoseconds(timeout.toNSec()),
                 [this] { return failure_ || !waiting_.isEmpty(); });
  worker_waits_ = false;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

}  // namespace organ_collision::node
