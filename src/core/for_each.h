#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <cstddef>

namespace organ_collision::core {

/// Does action(0), ... action(count - 1) on all cores; `grain` of them are worth a task.
template <class Action>
void forEach(std::size_t count, std::size_t grain, const Action& action) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& some) {
    for (std::size_t i = some.begin(); i < some.end(); ++i) action(i);
  });
}

/// The same, each as a task of its own: a few, of whatever sizes.
template <class Action>
void forEachAlone(std::size_t count, const Action& action) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count), [&](const auto& one) { action(one.begin()); },
      tbb::simple_partitioner());
}

}  // namespace organ_collision::core
