#pragma once

#include <chrono>
#include <ctime>

namespace organ_collision::node {

class Stopwatch {
 public:
  /// [s] since it was made
  double elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Counts only while this thread runs: what a job costs, whoever else wants the processor.
class CostStopwatch {
 public:
  /// [s] of this thread since it was made
  double elapsed() const { return threadTime() - start_; }

 private:
  static double threadTime() {
    timespec time = {};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  double start_ = threadTime();
};

}  // namespace organ_collision::node
