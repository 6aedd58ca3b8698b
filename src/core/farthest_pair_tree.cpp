#include "organ_collision/core/farthest_pair_tree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>

#include "organ_collision/core/closest_point.h"
#include "organ_collision/core/farthest_pair.h"

namespace organ_collision::core {
namespace {

bool lexicographicallyLess(const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
  return std::make_tuple(p.x(), p.y(), p.z()) < std::make_tuple(q.x(), q.y(), q.z());
}

std::array<Eigen::Vector3d, 3> cornersOf(const Triangle& triangle) {
  return {triangle.a, triangle.b, triangle.c};
}

std::array<Eigen::Vector3d, 3> sortedCorners(const Triangle& triangle) {
  std::array<Eigen::Vector3d, 3> corners = cornersOf(triangle);
  std::sort(corners.begin(), corners.end(), [](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    return lexicographicallyLess(p, q);
  });
  return corners;
}

bool lexicographicallyLess(const std::array<Eigen::Vector3d, 3>& p,
                           const std::array<Eigen::Vector3d, 3>& q) {
  return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end(),
                                      [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
                                        return lexicographicallyLess(a, b);
                                      });
}

struct Member {
  Eigen::Vector3d centroid;
  TriangleId triangle;
};

/// All triangles by centroid, then by sorted corners: from here on "lexicographically smaller" is
/// "comes first".
std::vector<Member> orderedMembers(const TriangleMesh& mesh) {
  std::vector<Member> members(mesh.triangleCount());
  for (std::size_t i = 0; i < members.size(); ++i) {
    const auto id = static_cast<TriangleId>(i);
    members[i] = {centroid(mesh.triangle(id)), id};
  }
  tbb::parallel_sort(members.begin(), members.end(),
                     [&](const Member& first, const Member& second) {
                       if (first.centroid != second.centroid)
                         return lexicographicallyLess(first.centroid, second.centroid);
                       const Triangle one = mesh.triangle(first.triangle);
                       const Triangle other = mesh.triangle(second.triangle);
                       for (const auto& corners :
                            {sortedCorners, cornersOf}) {  // the latter for turned duplicates
                         if (corners(one) != corners(other))
                           return lexicographicallyLess(corners(one), corners(other));
                       }
                       return first.triangle < second.triangle;
                     });
  return members;
}

/// Twice what rounding makes of the side of a plane, in single precision, at points of the unit
/// frame within reach 1; it grows with the reach.
constexpr float kPlaneRounding = 0x1p-20F;
/// The same for the distances to the poles themselves, in double precision.
constexpr double kPoleRounding = 0x1p-46;

constexpr std::size_t kGrain = 2048;  // nodes or leaves that are worth a task

double largestCoordinate(const Eigen::Vector3d& v) { return v.cwiseAbs().maxCoeff(); }

}  // namespace

/// Splits sets without disturbing the order of those that stay together; sets that are large are
/// split side by side.
class FarthestPairTree::Builder {
 public:
  Builder(const TriangleMesh& mesh, std::vector<Node>& nodes) : nodes_(nodes) {
    for (const Member& member : orderedMembers(mesh)) {
      centroids_.push_back(member.centroid);
      triangles_.push_back(member.triangle);
    }
    spare_centroids_.resize(centroids_.size());
    spare_triangles_.resize(triangles_.size());
  }

  void run() {
    if (nodes_.empty()) return;
    splitAll({{0, static_cast<Leaf>(triangles_.size()), 0}, 1});
    tasks_.wait();
    std::vector<Leaf> leaf_of(triangles_.size());
    for (Leaf leaf = 0; leaf < triangles_.size(); ++leaf) leaf_of[index(triangles_[leaf])] = leaf;
    for (Node& node : nodes_) {
      for (Leaf& pole : node.poles) pole = leaf_of[pole];
    }
  }

  std::vector<TriangleId>& triangles() { return triangles_; }
  std::size_t depth() const { return depth_; }

 private:
  struct Pending {
    Set set;
    std::size_t depth;
  };
  static constexpr std::uint32_t kTask = 4096;  // leaves that are worth a task

  /// Not by recursion: exponentially spaced triangles go some hundreds deep.
  void splitAll(const Pending& whole) {
    std::vector<Pending> pending = {whole};
    while (!pending.empty()) {
      const auto [set, depth] = pending.back();
      pending.pop_back();
      noteDepth(depth);
      const std::uint32_t first_size = split(set);
      const Set first = {set.begin, set.begin + first_size, set.node + 1};
      const Set second = {set.begin + first_size, set.end, set.node + first_size};
      for (const Set& child : {second, first}) {
        if (child.isLeaf()) continue;
        const Pending next = {child, depth + 1};
        if (child.size() >= kTask) {
          tasks_.run([this, next] { splitAll(next); });
        } else {
          pending.push_back(next);
        }
      }
    }
  }

  /// Fills the set's node, its poles as triangles; returns how many leaves go with the first.
  std::uint32_t split(const Set& set) {
    const FarthestPair pair = farthestPair(&centroids_[set.begin], set.size());
    const bool coincident = pair.squared_distance == 0.0;
    const std::size_t first = set.begin + pair.first;
    const std::size_t second = set.begin + (coincident ? set.size() / 2 : pair.second);
    Node& node = nodes_[set.node];
    node.poles = {static_cast<Leaf>(index(triangles_[first])),
                  static_cast<Leaf>(index(triangles_[second]))};
    const std::array<Eigen::Vector3d, 2> at = {centroids_[first], centroids_[second]};
    node.first_size = coincident ? set.size() / 2 : separate(set, at[0], at[1]);
    return node.first_size;
  }

  /// Puts those that are nearer to the first pole in front; returns how many they are.
  std::uint32_t separate(const Set& set, const Eigen::Vector3d& first_pole,
                         const Eigen::Vector3d& second_pole) {
    Leaf kept = set.begin;
    Leaf moved = set.begin;
    for (Leaf i = set.begin; i < set.end; ++i) {
      const Eigen::Vector3d at = centroids_[i];
      if (squaredLength(at - first_pole) < squaredLength(at - second_pole)) {
        centroids_[kept] = at;
        triangles_[kept++] = triangles_[i];
      } else {
        spare_centroids_[moved] = at;
        spare_triangles_[moved++] = triangles_[i];
      }
    }
    std::copy(&spare_centroids_[set.begin], &spare_centroids_[moved], &centroids_[kept]);
    std::copy(&spare_triangles_[set.begin], &spare_triangles_[moved], &triangles_[kept]);
    return kept - set.begin;
  }

  void noteDepth(std::size_t depth) {
    std::size_t known = depth_;
    while (known < depth && !depth_.compare_exchange_weak(known, depth)) {
    }
  }

  std::vector<Node>& nodes_;
  Points centroids_, spare_centroids_;
  std::vector<TriangleId> triangles_, spare_triangles_;
  std::atomic<std::size_t> depth_ = 0;
  tbb::task_group tasks_;
};

FarthestPairTree::FarthestPairTree(const TriangleMesh& mesh, const UnitFrame& frame)
    : nodes_(mesh.triangleCount() - 1) {
  Builder builder(mesh, nodes_);
  builder.run();
  leaves_ = std::move(builder.triangles());
  depth_ = builder.depth();
  refit(mesh, frame);
}

void FarthestPairTree::refit(const TriangleMesh& mesh, const UnitFrame& frame) {
  frame_ = frame;
  using Range = tbb::blocked_range<std::size_t>;
  Points centroids(leaves_.size());
  tbb::parallel_for(Range(0, leaves_.size(), kGrain), [&](const Range& some) {
    for (std::size_t leaf = some.begin(); leaf < some.end(); ++leaf)
      centroids[leaf] = centroidInFrame(mesh, static_cast<Leaf>(leaf));
  });
  tbb::parallel_for(Range(0, nodes_.size(), kGrain), [&](const Range& some) {
    for (std::size_t i = some.begin(); i < some.end(); ++i) {
      const auto [first, second] = nodes_[i].poles;
      placePlane(nodes_[i], centroids[first], centroids[second]);
    }
  });
}

void FarthestPairTree::refit(const TriangleMesh& mesh, const std::vector<Leaf>& moved) {
  struct Part {
    Set set;
    const Leaf *begin, *end;  // the moved leaves of the set
  };
  const auto has_moved = [&](Leaf leaf) {
    return std::binary_search(moved.begin(), moved.end(), leaf);
  };
  std::vector<Part> pending = {{root(), moved.data(), moved.data() + moved.size()}};
  while (!pending.empty()) {
    const auto [set, begin, end] = pending.back();
    pending.pop_back();
    if (begin == end || set.isLeaf()) continue;
    Node& node = nodes_[set.node];
    const auto [one, other] = node.poles;
    if (has_moved(one) || has_moved(other))
      placePlane(node, centroidInFrame(mesh, one), centroidInFrame(mesh, other));
    const auto [first, second] = children(set);
    const Leaf* middle = std::lower_bound(begin, end, first.end);
    pending.push_back({first, begin, middle});
    pending.push_back({second, middle, end});
  }
}

Eigen::Vector3d FarthestPairTree::centroidInFrame(const TriangleMesh& mesh, Leaf leaf) const {
  const Triangle triangle = mesh.triangle(leaves_[leaf]);
  return (frame_(triangle.a) + frame_(triangle.b) + frame_(triangle.c)) / 3.0;
}

void FarthestPairTree::placePlane(Node& node, const Eigen::Vector3d& first,
                                  const Eigen::Vector3d& second) {
  const Eigen::Vector3f normal = (second - first).cast<float>();
  node.normal = {normal.x(), normal.y(), normal.z()};
  node.offset = static_cast<float>(normal.cast<double>().dot(0.5 * (first + second)));
}

bool FarthestPairTree::isNearerToFirstPole(const TriangleMesh& mesh, const Node& node,
                                           const Eigen::Vector3d& tip) const {
  const auto squared_distance = [&](std::size_t i) {
    return squaredLength(tip - centroid(mesh.triangle(leaves_[node.poles[i]])));
  };
  return squared_distance(0) < squared_distance(1);
}

FarthestPairTree::GreedyPath FarthestPairTree::greedySearch(const TriangleMesh& mesh,
                                                            const Eigen::Vector3d& tip) const {
  const Eigen::Vector3d unit_tip = frame_(tip);
  const std::array<float, 3> q = {static_cast<float>(unit_tip.x()),
                                  static_cast<float>(unit_tip.y()),
                                  static_cast<float>(unit_tip.z())};
  const double reach = 1.0 + largestCoordinate(unit_tip);
  const double offset_of_mesh = largestCoordinate(frame_.center) * frame_.scale;
  const auto relative = static_cast<float>(kPlaneRounding * reach);
  const auto absolute = static_cast<float>(kPoleRounding * reach * (reach + offset_of_mesh));

  Set set = root();
  std::uint32_t nodes = 0;
  for (; !set.isLeaf(); ++nodes) {
    const Node& node = nodes_[set.node];
    const auto& [x, y, z] = node.normal;
    const float side = x * q[0] + y * q[1] + z * q[2] - node.offset;
    const float rounding = relative * (std::abs(x) + std::abs(y) + std::abs(z)) + absolute;
    // Not a number: not sure.
    const bool first =
        std::abs(side) > rounding ? side < 0.0F : isNearerToFirstPole(mesh, node, tip);
    set = children(set)[first ? 0 : 1];
  }
  return {set.begin, nodes};
}

std::size_t FarthestPairTree::memory() const {
  return nodes_.capacity() * sizeof(Node) + leaves_.capacity() * sizeof(TriangleId);
}

}  // namespace organ_collision::core
