#pragma once

#include <ros/callback_queue.h>

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>

namespace organ_collision::node {

/// Callbacks for one thread, the worker. While it waits for them, whoever brings one (roscpp's
/// thread at the sockets) may answer it at once: then no thread has to be woken, which takes longer
/// than most answers. Never do two of these threads answer at the same time, nor out of order.
class PromptQueue : public ros::CallbackQueueInterface {
 public:
  /// `answer_at_once` calls a callback that has come, or returns false without having called it:
  /// then it waits for the worker. Called by the thread that brings it. What it throws, wait()
  /// throws.
  explicit PromptQueue(std::function<bool(ros::CallbackInterface&)> answer_at_once);

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) override;
  void removeByID(std::uint64_t owner) override { waiting_.removeByID(owner); }

  /// Until a callback waits for the worker, or for so long; others are answered at once meanwhile.
  void wait(const ros::WallDuration& timeout);

  /// What waits for the worker.
  ros::CallbackQueue& waiting() { return waiting_; }

 private:
  const std::function<bool(ros::CallbackInterface&)> answer_at_once_;
  ros::CallbackQueue waiting_;
  std::mutex mutex_;  // of what is below; held while something is answered at once
  std::condition_variable came_;
  bool worker_waits_ = false;
  std::exception_ptr failure_;
};

}  // namespace organ_collision::node
