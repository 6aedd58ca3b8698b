#include "core/greedy_search.h"

#include <array>
#include <bitset>
#include <optional>

#include "core/kernels/kernels.h"

namespace organ_collision::core {
namespace {

using Set = FarthestPairTree::Set;

// Rounding. Let a be the distance of two poles and o the sum of their offsets from the tip, all as
// sums of coordinates' magnitudes; r the tip's reach, at least 1; s the sum of the squares of the
// poles' distances from the tip. In single precision centroids are off by d <= 9 * 2^-25 in each
// coordinate (edges may be 2 long), the tip by 2^-25 * r. Of the difference of the squares that
// makes 2*d*o + 2^-24*r*a. What is calculated adds, from the poles' plane,
// 2^-24*o + (2^-21 + 2^-21*r)*a; from squares, 2^-21*s. So of r*a it is below kApartRounding
// (descend.h), of o below kOffsetRounding. No centroid has a coordinate above 1: a <= 6, and what
// stands for o, twice the sum of a pole's offset and the node's radius, is at most 18*r; both
// together are below kPlaneRounding of r. From squares, with a <= o, o^2 <= 6*s and s <= 6*r^2, all
// is below 2^-18.5 * r * sqrt(s). Squared together with a further term it is below kSquareRounding
// times r^2*s, and four times that term's square.

/// Farther away, squares could overflow in single precision: then the mesh decides all.
constexpr float kFarthest = 0x1p60F;

/// By the poles of the mesh.
bool isNearerToFirstPole(const CollisionMesh& organ, const Set& set, const Eigen::Vector3d& tip) {
  const auto squared_distance = [&](FarthestPairTree::Leaf pole) {
    return squaredLength(tip - centroid(organ.mesh().triangle(organ.wideTree().corners()[pole])));
  };
  const auto [first, second] = organ.tree().poles(set);
  return squared_distance(first) < squared_distance(second);
}

/// How many sets below a node go with the first pole of one of its splits, and with the second.
std::array<std::uint32_t, 2> setsBelow(const SplitPaths& paths, std::uint32_t split) {
  const auto count = [split](std::uint64_t splits) {
    return static_cast<std::uint32_t>(
        std::bitset<64>(splits >> split & 0x0101010101010101U).count());
  };
  return {count(paths.above & paths.firsts), count(paths.above & ~paths.firsts)};
}

/// Goes from a node to a set below; only what is in doubt is decided by the mesh.
Set setBelow(const CollisionMesh& organ, const Eigen::Vector3d& tip, Descent& descent) {
  const GreedyGuide& guide = organ.wideTree().guide();
  Set set = guide.sets[descent.node];
  std::uint32_t split = 0;
  for (std::uint32_t left = kLaneCount; left > 1 && !set.isLeaf();) {
    const std::uint32_t bit = 1U << split;
    const bool in_first = (descent.sure & bit) != 0 ? (descent.firsts & bit) != 0
                                                    : isNearerToFirstPole(organ, set, tip);
    const auto [of_first, of_second] = setsBelow(guide.nodes[descent.node].paths, split);
    set = organ.tree().children(set)[in_first ? 0 : 1];
    ++descent.splits;
    left = in_first ? of_first : of_second;
    split += in_first ? 1 : of_first;  // the first child's splits come before the other's
  }
  return set;
}

/// The same, to a node below or, by the mesh alone, to a leaf, which is returned.
std::optional<FarthestPairTree::Leaf> descendExactly(const CollisionMesh& organ,
                                                     const Eigen::Vector3d& tip, Descent& descent) {
  const WideNode& node = organ.wideTree().nodes()[descent.node];
  Set set = setBelow(organ, tip, descent);
  for (std::uint32_t child = node.first_node; child < node.first_node + node.node_count; ++child) {
    if (organ.wideTree().guide().sets[child].begin != set.begin) continue;
    descent.node = child;
    return std::nullopt;
  }
  for (; !set.isLeaf(); ++descent.splits)
    set = organ.tree().children(set)[isNearerToFirstPole(organ, set, tip) ? 0 : 1];
  return set.begin;
}

}  // namespace

GreedyPath greedySearch(const CollisionMesh& organ, const Eigen::Vector3d& tip) {
  Descent descent = descentTo(organ, tip);
  const bool is_far = !(descent.reach < kFarthest);
  const auto& descend = kernels().descend;
  while (is_far || !descend(descent)) {
    if (const auto leaf = descendExactly(organ, tip, descent)) return {*leaf, descent.splits};
  }
  return {descent.leaf, descent.splits};
}

}  // namespace organ_collision::core
