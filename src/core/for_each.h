#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/partitioner.h>
#include <tbb/task_group.h>

#include <cstddef>

namespace organ_collision::core {

/// For all that runs side by side. Else it would belong to the caller's own tasks, if there are
/// any, and where one of those throws, oneTBB leaves out what else belongs to them, without a word.
struct OwnContext : tbb::task_group_context {
  OwnContext() : tbb::task_group_context(isolated) {}
};

/// Does action(0), ... action(count - 1) on all cores; `grain` of them are worth a task.
template <class Action>
void forEach(std::size_t count, std::size_t grain, const Action& action) {
  OwnContext context;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, grain),
      [&](const auto& some) {
        for (std::size_t i = some.begin(); i < some.end(); ++i) action(i);
      },
      context);
}

/// The same, each as a task of its own: a few, of whatever sizes.
template <class Action>
void forEachAlone(std::size_t count, const Action& action) {
  OwnContext context;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count), [&](const auto& one) { action(one.begin()); },
      tbb::simple_partitioner(), context);
}

/// Does both, if there are cores for both.
template <class First, class Second>
void sideBySide(const First& first, const Second& second) {
  OwnContext own;
  tbb::task_group_context& context = own;  // of this very type
  tbb::parallel_invoke(first, second, context);
}

}  // namespace organ_collision::core
