#include "core/collapse.h"

#include <tbb/parallel_for_each.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace organ_collision::core {
namespace {

constexpr std::uint32_t kTask = 1024;    // leaves
constexpr float kPacketCost = 1.3F;      // of a node's
constexpr double kUsualDistance = 0.05;  // of tips, in the unit frame

}  // namespace

Collapse::Collapse(const FarthestPairTree& tree, const Points& centroids)
    : tree_(tree), costs_(centroids.size() - 1) {
  std::vector<Set> tasks;
  const std::vector<Set> above = setsBelow(tree.root(), kTask, tasks);
  tbb::parallel_for_each(tasks, [&](const Set& task) {
    std::vector<Set> leaves;
    weighUpwards(setsBelow(task, 1, leaves), centroids);
  });
  weighUpwards(above, centroids);
}

/// A set and all those below it that have more than `least` leaves, parents first; those of up to
/// `least` below them are added to `rest`.
std::vector<Collapse::Set> Collapse::setsBelow(const Set& top, std::uint32_t least,
                                               std::vector<Set>& rest) const {
  std::vector<Set> sets;
  std::vector<Set> pending = {top};
  while (!pending.empty()) {
    const Set set = pending.back();
    pending.pop_back();
    if (set.size() <= least) {
      rest.push_back(set);
      continue;
    }
    sets.push_back(set);
    for (const Set& child : tree_.children(set)) pending.push_back(child);
  }
  return sets;
}

/// REQUIRES: parents come first.
void Collapse::weighUpwards(const std::vector<Set>& sets, const Points& centroids) {
  for (auto set = sets.rbegin(); set != sets.rend(); ++set) weigh(*set, centroids);
}

/// Neighbours share a packet if there is room.
void Collapse::Parts::addPacket(const Set& set) {
  if (!packets.empty() && packets.back().end == set.begin &&
      set.end - packets.back().begin <= kLaneCount) {
    packets.back().end = set.end;
  } else {
    packets.push_back({set.begin, set.end});
  }
}

Collapse::Parts Collapse::partsOf(const Set& whole) const {
  Parts parts;
  if (isPacket(whole)) {
    parts.addPacket(whole);
    return parts;
  }
  std::vector<std::pair<Set, std::uint32_t>> pending = {{whole, kLaneCount}};
  bool first = true;
  while (!pending.empty()) {
    const auto [set, slots] = pending.back();
    pending.pop_back();
    const std::uint32_t used = set.isLeaf() ? 1 : costs_[set.node].slots[slots - 1];
    if (!first && used == 1) {
      if (isPacket(set)) {
        parts.addPacket(set);
      } else {
        parts.nodes.push_back(set);
      }
      continue;
    }
    const auto [one, other] = tree_.children(set);
    const std::uint32_t total = first ? kLaneCount : used;
    const std::uint32_t for_first = costs_[set.node].first_slots[total - 1];
    pending.emplace_back(other, total - for_first);
    pending.emplace_back(one, for_first);
    first = false;
  }
  return parts;
}

bool Collapse::isPacket(const Set& set) const {
  return set.isLeaf() || (set.size() <= kLaneCount && costs_[set.node].is_packet);
}

void Collapse::weigh(const Set& set, const Points& centroids) {
  Costs& costs = costs_[set.node];
  const auto [a, b] = tree_.poles(set);
  const double visited = (centroids[a] - centroids[b]).norm() + kUsualDistance;
  const auto weight = static_cast<float>(visited * visited);
  const auto [one, other] = tree_.children(set);
  std::array<float, kLaneCount> leaf;
  leaf.fill(kPacketCost * weight);
  const auto& of_one = one.isLeaf() ? leaf : costs_[one.node].cost;
  const auto& of_other = other.isLeaf() ? leaf : costs_[other.node].cost;
  std::array<float, kLaneCount> divided;
  for (std::uint32_t slots = 2; slots <= kLaneCount; ++slots) {
    if (slots > set.size()) {  // one for each leaf is enough
      divided[slots - 1] = divided[slots - 2];
      costs.first_slots[slots - 1] = costs.first_slots[slots - 2];
      continue;
    }
    divided[slots - 1] = std::numeric_limits<float>::infinity();
    for (std::uint32_t first = 1; first < slots; ++first) {
      const float cost = of_one[first - 1] + of_other[slots - first - 1];
      if (cost < divided[slots - 1]) {
        divided[slots - 1] = cost;
        costs.first_slots[slots - 1] = static_cast<std::uint8_t>(first);
      }
    }
  }
  const float as_node = weight + divided[kLaneCount - 1];
  const float as_packet =
      set.size() <= kLaneCount ? kPacketCost * weight : std::numeric_limits<float>::infinity();
  costs.is_packet = as_packet <= as_node;
  costs.cost[0] = std::min(as_node, as_packet);
  costs.slots[0] = 1;
  for (std::uint32_t slots = 2; slots <= kLaneCount; ++slots) {
    const bool divide = divided[slots - 1] < costs.cost[slots - 2];
    costs.cost[slots - 1] = divide ? divided[slots - 1] : costs.cost[slots - 2];
    costs.slots[slots - 1] = divide ? static_cast<std::uint8_t>(slots) : costs.slots[slots - 2];
  }
}

}  // namespace organ_collision::core
