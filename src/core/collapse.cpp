#include "core/collapse.h"

#include <tbb/parallel_for_each.h>

#include <limits>

#include "core/for_each.h"
#include "core/kernels/kernels.h"

namespace organ_collision::core {
namespace {

constexpr std::uint32_t kTask = 1024;  // leaves
constexpr std::size_t kGrain = 512;    // nodes that are worth a task
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// As a packet.
LaneFloats costsOfLeaf(float weight_of_parent) {
  LaneFloats costs;
  costs.fill(Collapse::kPacketCost * weight_of_parent);
  return costs;
}

}  // namespace

Collapse::Collapse(const FarthestPairTree& tree, const Centroids& centroids)
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
  OwnContext context;
  tbb::parallel_for_each(
      tasks, [&](const Set& task) { weighUpwards(nodesOf(task), centroids); }, context);
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
void Collapse::weighUpwards(const std::vector<Set>& sets, const Centroids& centroids) {
  for (auto set = sets.rbegin(); set != sets.rend(); ++set) weigh(*set, centroids);
}

WideLayout Collapse::layout() const {
  WideLayout layout;
  layout.nodes.push_back({tree_.root(), 0, 0, 0, 0, 0});
  std::vector<WideLayout::Children> children;  // of a level's nodes
  for (std::size_t level = 0; level < layout.nodes.size(); level += children.size()) {
    layout.levels.push_back(static_cast<std::uint32_t>(level));
    children.resize(layout.nodes.size() - level);
    forEach(children.size(), kGrain,
            [&](std::size_t i) { children[i] = childrenOf(layout.nodes[level + i].set); });
    for (std::size_t i = 0; i < children.size(); ++i)
      layout.add(children[i], static_cast<std::uint32_t>(level + i));
  }
  return layout;
}

void WideLayout::add(const Children& children, std::uint32_t parent) {
  Node& node = nodes[parent];
  node.first_node = static_cast<std::uint32_t>(nodes.size());
  node.first_packet = static_cast<std::uint32_t>(packets.size());
  node.node_count = children.node_count;
  node.packet_count = children.packet_count;
  for (std::size_t i = 0; i < children.node_count; ++i)
    nodes.push_back({children.nodes[i], parent, 0, 0, 0, 0});
  for (std::size_t i = 0; i < children.packet_count; ++i)
    packets.push_back({children.packets[i].begin, children.packets[i].end, parent});
}

/// Neighbours share a packet if there is room.
void WideLayout::Children::addPacket(const Set& set) {
  const bool shares = packet_count > 0 && packets[packet_count - 1].end == set.begin &&
                      set.end - packets[packet_count - 1].begin <= kLaneCount;
  if (shares) {
    packets[packet_count - 1].end = set.end;
  } else {
    packets[packet_count++] = set;
  }
}

WideLayout::Children Collapse::childrenOf(const Set& whole) const {
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
  WideLayout::Children children;
  if (isPacket(whole)) {
    children.addPacket(whole);
  } else {
    divide(whole, kLaneCount);
  }
  while (count > 0) {
    const auto [set, lanes] = pending[--count];
    const std::uint32_t used = lanesUsed(set, lanes);
    if (used > 1) {
      divide(set, used);
    } else if (isPacket(set)) {
      children.addPacket(set);
    } else {
      children.nodes[children.node_count++] = set;
    }
  }
  return children;
}

bool Collapse::isPacket(const Set& set) const {
  if (set.isLeaf()) return true;
  const auto& [costs, weight] = weighed_[set.node];
  return set.size() <= kLaneCount && costs.front() == kPacketCost * weight;
}

/// Of a set's child: a leaf is a packet, whatever the lanes.
const Collapse::Costs& Collapse::costsOf(const Set& child, const Costs& of_leaf) const {
  return child.isLeaf() ? of_leaf : weighed_[child.node].costs;
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
  const Costs of_leaf = costsOfLeaf(weighed_[set.node].weight);
  const Costs& of_one = costsOf(one, of_leaf);
  const Costs& of_other = costsOf(other, of_leaf);
  const auto cost = [&](std::uint32_t first) {
    return of_one[first - 1] + of_other[lanes - first - 1];
  };
  std::uint32_t best = 1;
  for (std::uint32_t first = 2; first < lanes; ++first) {
    if (cost(first) < cost(best)) best = first;
  }
  return best;
}

void Collapse::weigh(const Set& set, const Centroids& centroids) {
  auto& [costs, weight] = weighed_[set.node];
  const auto [a, b] = tree_.poles(set);
  const double visited = (centroids[a] - centroids[b]).norm() + kUsualDistance;
  weight = static_cast<float>(visited * visited);
  const auto [one, other] = tree_.children(set);
  const Costs of_leaf = costsOfLeaf(weight);
  const float as_packet = set.size() <= kLaneCount ? kPacketCost * weight : kInfinity;
  kernels().weigh(costsOf(one, of_leaf), costsOf(other, of_leaf), as_packet, weight, costs);
}

}  // namespace organ_collision::core
