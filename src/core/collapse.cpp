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
  const std::vector<Set> above = setsLargerThan(kTask, tree.root());
  std::vector<Set> tasks;
  if (above.empty()) tasks.push_back(tree.root());
  for (const Set& set : above) {
    for (const Set& child : tree.children(set)) {
      if (child.size() <= kTask) tasks.push_back(child);
    }
  }
  tbb::parallel_for_each(
      tasks, [&](const Set& task) { weighUpwards(setsLargerThan(1, task), centroids); });
  weighUpwards(above, centroids);
}

/// Of a set and all those below it, those with more leaves than that, parents first.
std::vector<Collapse::Set> Collapse::setsLargerThan(std::uint32_t least, const Set& top) const {
  std::vector<Set> sets;
  std::vector<Set> pending = {top};
  while (!pending.empty()) {
    const Set set = pending.back();
    pending.pop_back();
    if (set.size() <= least) continue;
    sets.push_back(set);
    for (const Set& child : tree_.children(set)) pending.push_back(child);
  }
  return sets;
}

/// REQUIRES: parents come first.
void Collapse::weighUpwards(const std::vector<Set>& sets, const Points& centroids) {
  for (auto set = sets.rbegin(); set != sets.rend(); ++set) weigh(*set, centroids);
}

Collapse::Layout Collapse::layout() const {
  Layout layout;
  layout.nodes.push_back({tree_.root(), 0, 0, 0, 0, 0});
  for (std::uint32_t node = 0; node < layout.nodes.size();) {
    layout.levels.push_back(node);
    const auto next_level = static_cast<std::uint32_t>(layout.nodes.size());
    for (; node < next_level; ++node) addChildren(node, layout);
  }
  return layout;
}

/// Neighbours share a packet if there is room.
void Collapse::Layout::addPacket(const Set& set, std::uint32_t parent) {
  if (!packets.empty() && packets.back().parent == parent && packets.back().end == set.begin &&
      set.end - packets.back().begin <= kLaneCount) {
    packets.back().end = set.end;
  } else {
    packets.push_back({set.begin, set.end, parent});
  }
}

void Collapse::addChildren(std::uint32_t parent, Layout& layout) const {
  const Set whole = layout.nodes[parent].set;
  const std::size_t first_node = layout.nodes.size();
  const std::size_t first_packet = layout.packets.size();
  struct Pending {
    Set set;
    std::uint32_t slots;
  };
  std::array<Pending, kLaneCount> pending;
  std::size_t count = 0;
  const auto divide = [&](const Set& set, std::uint32_t slots) {
    const auto [one, other] = tree_.children(set);
    const std::uint32_t for_first = costs_[set.node].first_slots[slots - 1];
    pending[count++] = {other, slots - for_first};
    pending[count++] = {one, for_first};
  };
  if (isPacket(whole)) {
    layout.addPacket(whole, parent);
  } else {
    divide(whole, kLaneCount);
  }
  while (count > 0) {
    const auto [set, slots] = pending[--count];
    const std::uint32_t used = set.isLeaf() ? 1 : costs_[set.node].slots[slots - 1];
    if (used > 1) {
      divide(set, used);
    } else if (isPacket(set)) {
      layout.addPacket(set, parent);
    } else {
      layout.nodes.push_back({set, parent, 0, 0, 0, 0});
    }
  }
  Node& node = layout.nodes[parent];
  node.first_node = static_cast<std::uint32_t>(first_node);
  node.first_packet = static_cast<std::uint32_t>(first_packet);
  node.node_count = static_cast<std::uint8_t>(layout.nodes.size() - first_node);
  node.packet_count = static_cast<std::uint8_t>(layout.packets.size() - first_packet);
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
