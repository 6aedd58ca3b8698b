#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "volumes.h"

namespace organ_collision::bench {

/// An exact answer and what it cost.
struct Answer {
  double squared_distance = std::numeric_limits<double>::infinity();  ///< [m^2]
  std::size_t bounds = 0;                                             ///< volumes measured
  std::size_t triangles = 0;                                          ///< triangles measured
  std::size_t opened = 0;  ///< sets whose children were looked at
};

/// The library's exact search, with any volumes: down to the nearer pole first, then always the set
/// whose bound is least.
template <class Volumes>
class BestFirst {
 public:
  explicit BestFirst(const Hierarchy& hierarchy) : hierarchy_(hierarchy), volumes_(hierarchy) {}

  Answer nearest(const Tip& tip) {
    answer_ = {};
    queue_.clear();
    dive(tip);
    while (!queue_.empty() && queue_.front().bound <= answer_.squared_distance) {
      const Entry entry = pop();
      if (hierarchy_.sets()[entry.set].child_count == 0) {
        measure(entry.set, tip);
      } else {
        open(entry.set, tip, entry.bound, kNone);
      }
    }
    return answer_;
  }

 private:
  static constexpr std::size_t kNone = 0;  // the root is nobody's child

  struct Entry {
    double bound;  // [m^2]
    std::size_t set;
    bool operator<(const Entry& other) const { return bound > other.bound; }
  };

  void dive(const Tip& tip) {
    std::size_t set = 0;
    while (hierarchy_.sets()[set].child_count > 0) {
      const std::size_t next = childOfNearestPole(hierarchy_.sets()[set], tip.point);
      open(set, tip, 0.0, next);
      set = next;
    }
    measure(set, tip);
  }

  std::size_t childOfNearestPole(const Set& set, const Eigen::Vector3d& point) const {
    std::size_t nearest = set.first_child;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = set.first_child; i < set.first_child + set.child_count; ++i) {
      const double distance = core::squaredLength(point - hierarchy_.sets()[i].pole);
      if (distance > least) continue;
      least = distance;
      nearest = i;
    }
    return nearest;
  }

  /// Puts all children but `taken` into the queue that may hold something nearer; none can be
  /// nearer than `least`, the set's own bound.
  void open(std::size_t opened, const Tip& tip, double least, std::size_t taken) {
    ++answer_.opened;
    const Set& set = hierarchy_.sets()[opened];
    const auto& seen = volumes_.seenFrom(opened, tip);
    for (std::size_t i = set.first_child; i < set.first_child + set.child_count; ++i) {
      if (i == taken) continue;
      ++answer_.bounds;
      const double bound = std::max(least, volumes_.bound(seen, i));
      if (bound > answer_.squared_distance) continue;
      queue_.push_back({bound, i});
      std::push_heap(queue_.begin(), queue_.end());
    }
  }

  Entry pop() {
    std::pop_heap(queue_.begin(), queue_.end());
    const Entry entry = queue_.back();
    queue_.pop_back();
    return entry;
  }

  void measure(std::size_t set, const Tip& tip) {
    ++answer_.triangles;
    const core::Triangle& triangle = hierarchy_.triangle(hierarchy_.sets()[set]);
    const double squared = core::closestPointOnTriangle(tip.point, triangle).squared_distance;
    answer_.squared_distance = std::min(answer_.squared_distance, squared);
  }

  const Hierarchy& hierarchy_;
  Volumes volumes_;
  Answer answer_;
  std::vector<Entry> queue_;  // a heap
};

}  // namespace organ_collision::bench
