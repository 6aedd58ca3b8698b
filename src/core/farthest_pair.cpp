#include "organ_collision/core/farthest_pair.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "organ_collision/core/box.h"

namespace organ_collision::core {
namespace {

constexpr std::size_t kBruteForceCount = 12;  // below it, all pairs cost less than sweeps
constexpr std::size_t kKdLeafCount = 16;
constexpr std::size_t kMaxScans =
    24;  // more points outside the ball than this are paired by branch and bound

bool isBetter(const FarthestPair& candidate, const FarthestPair& best) {
  if (candidate.squared_distance != best.squared_distance)
    return candidate.squared_distance > best.squared_distance;
  return std::tie(candidate.first, candidate.second) < std::tie(best.first, best.second);
}

FarthestPair pairOf(std::size_t i, std::size_t j, double squared_distance) {
  return {std::min(i, j), std::max(i, j), squared_distance};
}

/// A set of points and the best pair found so far.
class Diameter {
 public:
  Diameter(const Eigen::Vector3d* points, std::size_t count) : points_(points), count_(count) {}

  FarthestPair find() {
    walkFrom(0);
    if (best_.squared_distance == 0.0) return best_;  // all coincide
    while (true) {
      const std::vector<std::size_t> outside = pointsOutsideBall();
      if (outside.empty()) return best_;
      if (walkFrom(outside.front()))
        continue;  // a longer pair: its ball leaves fewer points outside
      if (outside.size() > kMaxScans) {
        pairByBranchAndBound(outside);
      } else {
        for (const std::size_t i : outside) scan(i);
      }
      return best_;
    }
  }

 private:
  /// Compares point i with all others; the best pair of which it is a member.
  FarthestPair scan(std::size_t i) {
    std::size_t farthest = 0;
    double squared_distance = -1.0;
    const Eigen::Vector3d from = points_[i];
    for (std::size_t j = 0; j < count_; ++j) {
      const double candidate = squaredLength(points_[j] - from);
      if (candidate > squared_distance) {
        squared_distance = candidate;
        farthest = j;
      }
    }
    const FarthestPair pair = pairOf(i, farthest, squared_distance);
    if (isBetter(pair, best_)) best_ = pair;
    return pair;
  }

  /// Goes from a point to its farthest, from there to its farthest, while the distance grows. Both
  /// ends of the best pair have then been compared with all. Returns whether a longer pair than
  /// before was found.
  bool walkFrom(std::size_t start) {
    const double before = best_.squared_distance;
    std::size_t from = start;
    double reached = -1.0;
    while (true) {
      const FarthestPair pair = scan(from);
      if (pair.squared_distance <= reached) break;
      reached = pair.squared_distance;
      from = pair.first == from ? pair.second : pair.first;
    }
    return best_.squared_distance > before;
  }

  /// The points other than the best pair's that can be an end of a pair as long as the best or
  /// longer: those not inside the ball whose diameter is the best pair. The one farthest outside
  /// comes first.
  std::vector<std::size_t> pointsOutsideBall() const {
    // Each product and sum below errs by at most a few u of squared_distance; ties must not fall
    // through.
    const double slack = 64.0 * std::numeric_limits<double>::epsilon() * best_.squared_distance;
    const Eigen::Vector3d p = points_[best_.first];
    const Eigen::Vector3d q = points_[best_.second];
    std::vector<std::size_t> outside;
    double farthest_out = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count_; ++i) {
      const Eigen::Vector3d to_p = points_[i] - p;
      const Eigen::Vector3d to_q = points_[i] - q;
      const double height = (to_p.x() * to_q.x() + to_p.y() * to_q.y()) + to_p.z() * to_q.z();
      if (height < -slack || i == best_.first || i == best_.second) continue;
      outside.push_back(i);
      if (height > farthest_out) {
        farthest_out = height;
        std::swap(outside.front(), outside.back());
      }
    }
    return outside;
  }

  void pairByBranchAndBound(const std::vector<std::size_t>& outside);

  const Eigen::Vector3d* points_;
  std::size_t count_;
  FarthestPair best_ = {0, 0, 0.0};
};

/// Balanced kd-tree over some of the points, in preorder: a node's first child follows it.
class KdTree {
 public:
  struct Node {
    Box box;
    std::size_t begin, end;    // members
    std::size_t lowest;        // index among the members
    std::size_t second_child;  // 0: a leaf
  };

  KdTree(const Eigen::Vector3d* points, std::vector<std::size_t> members)
      : points_(points), members_(std::move(members)) {
    build(0, members_.size());
  }

  const std::vector<Node>& nodes() const { return nodes_; }
  std::size_t member(std::size_t i) const { return members_[i]; }

 private:
  // Recursion is safe: halving keeps it as deep as the logarithm of the count, whatever the
  // positions.
  void build(std::size_t begin, std::size_t end) {
    const std::size_t self = nodes_.size();
    Node node = {Box(), begin, end, members_[begin], 0};
    for (std::size_t i = begin; i < end; ++i) {
      node.box.add(points_[members_[i]]);
      node.lowest = std::min(node.lowest, members_[i]);
    }
    nodes_.push_back(node);
    if (end - begin <= kKdLeafCount) return;
    Eigen::Index axis = 0;
    (node.box.high - node.box.low).maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [this](std::size_t i) {
      return members_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::nth_element(at(begin), at(middle), at(end), [this, axis](std::size_t i, std::size_t j) {
      return std::tie(points_[i][axis], i) < std::tie(points_[j][axis], j);
    });
    build(begin, middle);
    nodes_[self].second_child = nodes_.size();
    build(middle, end);
  }

  const Eigen::Vector3d* points_;
  std::vector<std::size_t> members_;
  std::vector<Node> nodes_;
};

/// The distance of opposite corners: no computed distance between members is larger, as rounding is
/// monotone.
double largestSquaredDistance(const Box& first, const Box& second) {
  return squaredLength((first.high - second.low).cwiseMax(second.high - first.low));
}

void Diameter::pairByBranchAndBound(const std::vector<std::size_t>& outside) {
  std::vector<std::size_t> all(count_);
  std::iota(all.begin(), all.end(), std::size_t{0});
  const KdTree ends(points_, outside);
  const KdTree others(points_, all);
  struct Candidate {
    double bound;
    std::size_t end, other;
  };
  const auto can_win = [this, &ends, &others](const Candidate& candidate) {
    const std::size_t i = ends.nodes()[candidate.end].lowest;
    const std::size_t j = others.nodes()[candidate.other].lowest;
    return isBetter(pairOf(i, j, candidate.bound), best_);
  };
  std::vector<Candidate> stack;
  const auto push_if_it_can_win = [&](std::size_t end, std::size_t other) {
    const Candidate candidate = {
        largestSquaredDistance(ends.nodes()[end].box, others.nodes()[other].box), end, other};
    if (can_win(candidate)) stack.push_back(candidate);
  };
  push_if_it_can_win(0, 0);
  while (!stack.empty()) {
    const Candidate candidate = stack.back();
    stack.pop_back();
    if (!can_win(candidate)) continue;
    const KdTree::Node& end = ends.nodes()[candidate.end];
    const KdTree::Node& other = others.nodes()[candidate.other];
    if (end.second_child == 0 && other.second_child == 0) {
      for (std::size_t i = end.begin; i < end.end; ++i) {
        for (std::size_t j = other.begin; j < other.end; ++j) {
          const std::size_t p = ends.member(i);
          const std::size_t q = others.member(j);
          const FarthestPair pair = pairOf(p, q, squaredLength(points_[p] - points_[q]));
          if (isBetter(pair, best_)) best_ = pair;
        }
      }
      continue;
    }
    const std::size_t first_new = stack.size();
    const bool split_end =
        other.second_child == 0 ||
        (end.second_child != 0 &&
         squaredLength(end.box.high - end.box.low) > squaredLength(other.box.high - other.box.low));
    if (split_end) {
      push_if_it_can_win(candidate.end + 1, candidate.other);
      push_if_it_can_win(end.second_child, candidate.other);
    } else {
      push_if_it_can_win(candidate.end, candidate.other + 1);
      push_if_it_can_win(candidate.end, other.second_child);
    }
    // The farther pair is looked at first.
    std::sort(stack.begin() + static_cast<std::ptrdiff_t>(first_new), stack.end(),
              [](const Candidate& a, const Candidate& b) { return a.bound < b.bound; });
  }
}

}  // namespace

FarthestPair farthestPair(const Eigen::Vector3d* points, std::size_t count) {
  assert(count >= 1);
  if (count <= kBruteForceCount) return farthestPairBruteForce(points, count);
  return Diameter(points, count).find();
}

FarthestPair farthestPairBruteForce(const Eigen::Vector3d* points, std::size_t count) {
  assert(count >= 1);
  FarthestPair best = {0, 0, 0.0};
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      const double squared_distance = squaredLength(points[j] - points[i]);
      if (squared_distance > best.squared_distance) best = {i, j, squared_distance};
    }
  }
  return best;
}

}  // namespace organ_collision::core
