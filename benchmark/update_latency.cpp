// Do queries wait while the organ deforms? Latency of exact queries on 131,072 triangles:
// idle; while 60 whole updates a second are refitted; and while the hierarchy is rebuilt over and
// over too. In rounds, one after the other: a machine has phases.
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "node/organ.h"
#include "node/stopwatch.h"
#include "organs.h"
#include "test_meshes.h"
#include "tools/arguments.h"
#include "tools/program.h"
#include "tools/statistics.h"

namespace organ_collision {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kOrgan = "blob@7";                          // 131,072 triangles
constexpr auto kUpdatePeriod = std::chrono::microseconds(16667);  // 60 Hz
constexpr double kMicroseconds = 1e6;                             // in a second
constexpr std::size_t kMostQueries = 20000000;
constexpr int kRounds = 5;
constexpr int kRebuilds = 2;       // in a round are waited for where the machine is busy, but
constexpr double kLongest = 12.0;  // [s] no longer

/// Keeps a thread on one processor: queries get the last one for themselves, all others share the
/// rest. On a machine with one processor nothing is gained, and nothing is done.
void pin(pthread_t thread, bool is_query) {
  const auto processors = static_cast<int>(std::thread::hardware_concurrency());
  if (processors < 2) return;
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (is_query) {
    CPU_SET(processors - 1, &allowed);
  } else {
    for (int i = 0; i + 1 < processors; ++i) CPU_SET(i, &allowed);
  }
  pthread_setaffinity_np(thread, sizeof allowed, &allowed);
}

core::Points tipsNear(const core::Points& points) {
  std::mt19937 generator(1);
  core::Points tips;
  for (int i = 0; i < 10000; ++i) {
    tips.push_back(points[generator() % points.size()] + test::randomPoint(generator, 0.005));
  }
  return tips;
}

struct Latencies {
  std::vector<double> sorted;  // [s]
  long preempted = 0;          // times that something else took the processor of the queries

  void add(const Latencies& other) {
    sorted.insert(sorted.end(), other.sorted.begin(), other.sorted.end());
    std::sort(sorted.begin(), sorted.end());
    preempted += other.preempted;
  }
};

long preemptions() {
  rusage usage = {};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nivcsw;
}

/// Asks for so long [s], and then until `enough`.
template <class Enough>
Latencies latencies(node::Organ& organ, const core::Points& tips, double duration,
                    const Enough& enough) {
  std::vector<double> result;
  result.reserve(kMostQueries);
  const long preempted = preemptions();
  const node::Stopwatch all;
  for (std::size_t i = 0;
       i < kMostQueries && all.elapsed() < kLongest && (all.elapsed() < duration || !enough());
       ++i) {
    const node::Stopwatch watch;
    {
      const auto snapshot = organ.snapshot();
      const auto nearest = core::nearestTriangle(snapshot->organ, tips[i % tips.size()]);
      organ.account(nearest.tip_point, core::Accuracy::exact());
    }
    result.push_back(watch.elapsed());
  }
  std::sort(result.begin(), result.end());
  return {std::move(result), preemptions() - preempted};
}

void print(const char* name, const Latencies& measured) {
  const std::vector<double>& sorted = measured.sorted;
  std::printf(
      "%-24s %9zu queries  p50 %6.2f  p99 %6.2f  p99.9 %7.2f  max %8.1f us, preempted %ld times\n",
      name, sorted.size(), kMicroseconds * tools::percentile(sorted, 0.5),
      kMicroseconds * tools::percentile(sorted, 0.99),
      kMicroseconds * tools::percentile(sorted, 0.999), kMicroseconds * sorted.back(),
      measured.preempted);
}

/// Threads that repeat something until they are stopped.
class Load {
 public:
  ~Load() {
    stop_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  template <class Work>
  void repeat(Work work) {
    threads_.emplace_back([this, work]() mutable {
      while (!stop_) work();
    });
    pin(threads_.back().native_handle(), false);
  }

 private:
  std::atomic<bool> stop_{false};
  std::vector<std::thread> threads_;
};

void run(const std::vector<std::string>& words) {
  const tools::Arguments arguments(words, {"--seconds"});
  arguments.requireNoWords();
  const double duration = arguments.aboveZero("--seconds", 10.0);  // each of the three
  pin(pthread_self(), false);  // the organ's background thread inherits that
  node::Organ organ("organ", "organ", bench::organNamed(kOrgan));
  const core::Points original = organ.snapshot()->organ.mesh().positions();
  const core::Points tips = tipsNear(original);
  pin(pthread_self(), true);
  const auto measure = [&](const auto& enough) {
    return latencies(organ, tips, duration / kRounds, enough);
  };
  const auto at_once = [] { return true; };
  measure(at_once);  // caches and clock are warm now

  const auto new_stream = [&] {
    return [&, at = Clock::now(), phase = 0.0]() mutable {
      phase += 0.1;
      core::Points moved = original;
      for (Eigen::Vector3d& point : moved) point.z() += 0.001 * std::sin(30.0 * point.x() + phase);
      organ.enqueue({{}, std::move(moved)});
      organ.work();
      std::this_thread::sleep_until(at += kUpdatePeriod);
    };
  };
  std::atomic<int> rebuilds{0};
  const auto rebuild = [&] {
    organ.update({}, node::UpdateMode::kRebuild, 0);
    ++rebuilds;
  };
  const std::uint32_t version = organ.snapshot()->version;
  Latencies idle, updated, rebuilt;
  std::vector<double> ratios;
  for (int round = 0; round < kRounds; ++round) {
    const Latencies before = measure(at_once);
    idle.add(before);
    {
      Load load;
      load.repeat(new_stream());
      updated.add(measure(at_once));
    }
    Load load;
    load.repeat(new_stream());
    load.repeat(rebuild);
    const Latencies after =
        measure([&, wanted = rebuilds + kRebuilds] { return rebuilds >= wanted; });
    rebuilt.add(after);
    ratios.push_back(tools::percentile(after.sorted, 0.999) /
                     tools::percentile(before.sorted, 0.999));
    std::printf("round %d: p99.9 is %.2f times the idle one\n", round + 1, ratios.back());
  }
  print("idle", idle);
  print("updated at 60 Hz", updated);
  print("updated and rebuilt", rebuilt);
  std::sort(ratios.begin(), ratios.end());
  std::printf("%u updates and %d rebuilds; p99.9 is %.2f times the idle one, the median of %d\n",
              organ.snapshot()->version - version, rebuilds.load(), ratios[kRounds / 2], kRounds);
}

}  // namespace
}  // namespace organ_collision

int main(int count, char** words) {
  using namespace organ_collision;
  return tools::runProgram({"update_latency", "usage: update_latency [--seconds S]\n"},
                           {words + 1, words + count}, std::cout, std::cerr, run);
}
