#include "core/collapse.h"

#include <tbb/parallel_for_each.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "core/kernels.h"

namespace organ_collision::core {
namespace {

constexpr std::uint32_t kTask = 1024;    // leaves
constexpr float kPacketCost = 1.3F;      // of a node's
constexpr double kUsualDistance = 0.05;  // of tips, in the unit frame
constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

Collapse::Collapse(const FarthestPairTree& tree, const Points& centroids)
    : tree_(tree), weighed_(centroids.size() - 1) {
  std::vector<Set> above;
  std::vector<Set> tasks;
  std::vector<Set> pending = {tree.root()};
  while (!pending.empty()) {
    const Set set = pending.back();
    pending.pop_back();
    (set.size() <= kTask ? tasks : above).push_back(set);
    if (set.size() <= kTask) continue;
    for (const Set& child : tree.children(set)) pending.push_back(child);
  }
  tbb::parallel_for_each(tasks, [&](const Set& task) { weighUpwards(nodesOf(task), centroids); });
  weighUpwards(above, centroids);
}

/// A set and all below it but the leaves, in the order of the nodes: parents first.
std::vector<Collapse::Set> Collapse::nodesOf(const Set& top) const {
  std::vector<Set> sets(top.size());
  sets.front() = top;
  const std::uint32_t end = top.size() - 1;
  for (std::uint32_t i = 0; i < end; ++i) {
    for (const Set& child : tree_.children(sets[i]))  // leaves too: no branch could be foreseen
      sets[child.isLeaf() ? end : child.node - top.node] = child;
  }
  sets.pop_back();
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
    std::uint32_t lanes;
  };
  std::array<Pending, kLaneCount> pending;
  std::size_t count = 0;
  const auto divide = [&](const Set& set, std::uint32_t lanes) {
    const auto [one, other] = tree_.children(set);
    const std::uint32_t of_first = lanesOfFirst(set, lanes);
    pending[count++] = {other, lanes - of_first};
    pending[count++] = {one, of_first};
  };
  if (isPacket(whole)) {
    layout.addPacket(whole, parent);
  } else {
    divide(whole, kLaneCount);
  }
  while (count > 0) {
    const auto [set, lanes] = pending[--count];
    const std::uint32_t used = lanesUsed(set, lanes);
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
  if (set.isLeaf()) return true;
  const auto& [costs, weight] = weighed_[set.node];
  return set.size() <= kLaneCount && costs.front() == kPacketCost * weight;
}

/// A leaf is a packet, whatever the lanes.
Collapse::Costs Collapse::costsOf(const Set& set, float weight_of_parent) const {
  if (!set.isLeaf()) return weighed_[set.node].costs;
  Costs costs;
  costs.fill(kPacketCost * weight_of_parent);
  return costs;
}

/// Of those that it may use: more only if they cost less.
std::uint32_t Collapse::lanesUsed(const Set& set, std::uint32_t lanes) const {
  if (set.isLeaf()) return 1;
  const Costs& costs = weighed_[set.node].costs;
  while (lanes > 1 && costs[lanes - 2] == costs[lanes - 1]) --lanes;
  return lanes;
}

/// Of those that a set's children share.
std::uint32_t Collapse::lanesOfFirst(const Set& set, std::uint32_t lanes) const {
  const auto [one, other] = tree_.children(set);
  const Costs of_one = costsOf(one, weighed_[set.node].weight);
  const Costs of_other = costsOf(other, weighed_[set.node].weight);
  const auto cost = [&](std::uint32_t first) {
    return of_one[first - 1] + of_other[lanes - first - 1];
  };
  std::uint32_t best = 1;
  for (std::uint32_t first = 2; first < lanes; ++first) {
    if (cost(first) < cost(best)) best = first;
  }
  return best;
}

void Collapse::weigh(const Set& set, const Points& centroids) {
  auto& [costs, weight] = weighed_[set.node];
  const auto [a, b] = tree_.poles(set);
  const double visited = (centroids[a] - centroids[b]).norm() + kUsualDistance;
  weight = static_cast<float>(visited * visited);
  const auto [one, other] = tree_.children(set);
  const float as_packet = set.size() <= kLaneCount ? kPacketCost * weight : kInfinity;
  kernels().weigh(costsOf(one, weight), costsOf(other, weight), as_packet, weight, costs);
}

}  // namespace organ_collision::core
