#pragma once

#include <semaphore.h>

#include <atomic>

namespace organ_collision::node {

/// Tells one thread that there is work. Raised while the thread is busy, it is heard afterwards.
/// Has no lock: whoever raises it, of whatever priority, holds up nobody.
class Signal {
 public:
  Signal() { sem_init(&semaphore_, 0, 0); }
  ~Signal() { sem_destroy(&semaphore_); }
  Signal(const Signal&) = delete;
  Signal& operator=(const Signal&) = delete;

  void raise() {
    if (!raised_.exchange(true)) sem_post(&semaphore_);
  }

  /// Returns when it has been raised since the last time.
  void wait() {
    while (sem_wait(&semaphore_) != 0) {
    }
    raised_ = false;
  }

 private:
  sem_t semaphore_;
  std::atomic<bool> raised_{false};
};

}  // namespace organ_collision::node
