#include "node/update_policy.h"

#include <algorithm>
#include <cstdio>

namespace organ_collision::node {
namespace {

template <class... Values>
std::string text(const char* format, Values... values) {
  std::array<char, 160> buffer;
  std::snprintf(buffer.data(), buffer.size(), format, values...);
  return buffer.data();
}

constexpr double kMicroseconds = 1e6;  // in a second
constexpr double kMilliseconds = 1e3;

}  // namespace

std::size_t RefitPolicy::sizeOf(std::size_t moved) {
  std::size_t size = 0;
  while (size + 1 < kSizes && (moved >>= 1) > 0) ++size;
  return size;
}

bool RefitPolicy::prefersPartial(std::size_t moved) const {
  const Partial& partial = partial_[sizeOf(moved)];
  return !partial.per_vertex || partial.isDueAgain() ||
         *partial.per_vertex * static_cast<double>(moved) < full_;
}

std::string RefitPolicy::figures(std::size_t moved) const {
  const Partial& partial = partial_[sizeOf(moved)];
  if (!partial.per_vertex) return "a partial refit of so many is to be tried";
  return text("a partial refit costs about %.0f us%s, a full one %.0f us",
              kMicroseconds * *partial.per_vertex * static_cast<double>(moved),
              partial.isDueAgain() ? " and is tried again" : "", kMicroseconds * full_);
}

void RefitPolicy::recordPartial(std::size_t moved, double duration) {
  partial_[sizeOf(moved)] = {duration / static_cast<double>(moved), 0};
}

void RefitPolicy::recordFull(std::optional<std::size_t> moved, double duration) {
  full_ = std::min(full_, duration);
  if (moved) ++partial_[sizeOf(*moved)].passed_over;
}

void RebuildPolicy::recordQueries(std::uint64_t queries, const Wear& wear) {
  last_ = wear;
  const double extra_work = std::max(0.0, 1.0 - 1.0 / wear.work_ratio) * wear.query_duration;
  const double mending = std::max(0.0, wear.newly_wrong) * wear.exact_duration;
  lost_ += static_cast<double>(queries) * (extra_work + mending);
}

void RebuildPolicy::recordRebuild(double cost) { *this = RebuildPolicy(cost); }

std::string RebuildPolicy::figures() const {
  return text(
      "queries lost %.1f ms to wear (%.2f times the work, %.0f %% more answers wrong), "
      "a rebuild costs %.1f ms",
      kMilliseconds * lost_, last_.work_ratio, 100.0 * last_.newly_wrong, kMilliseconds * cost_);
}

}  // namespace organ_collision::node
