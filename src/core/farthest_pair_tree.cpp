#include "organ_collision/core/farthest_pair_tree.h"

#include <algorithm>
#include <tuple>

#include "organ_collision/core/farthest_pair.h"

namespace organ_collision::core {
namespace {

bool lexicographicallyLess(const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
  return std::make_tuple(p.x(), p.y(), p.z()) < std::make_tuple(q.x(), q.y(), q.z());
}

std::array<Eigen::Vector3d, 3> sortedCorners(const Triangle& triangle) {
  std::array<Eigen::Vector3d, 3> corners = {triangle.a, triangle.b, triangle.c};
  std::sort(corners.begin(), corners.end(), lexicographicallyLess);
  return corners;
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
  std::sort(members.begin(), members.end(), [&mesh](const Member& first, const Member& second) {
    if (first.centroid != second.centroid)
      return lexicographicallyLess(first.centroid, second.centroid);
    const auto corners = sortedCorners(mesh.triangle(first.triangle));
    const auto others = sortedCorners(mesh.triangle(second.triangle));
    if (corners != others) {
      return std::lexicographical_compare(corners.begin(), corners.end(), others.begin(),
                                          others.end(), lexicographicallyLess);
    }
    return first.triangle < second.triangle;  // duplicates
  });
  return members;
}

/// Centroids and their triangles, in step, split again and again without disturbing the order of
/// those that stay together.
class Partition {
 public:
  explicit Partition(const std::vector<Member>& members)
      : spare_centroids_(members.size()), spare_(members.size()) {
    for (const Member& member : members) {
      centroids_.push_back(member.centroid);
      triangles_.push_back(member.triangle);
    }
  }

  const Eigen::Vector3d* centroids(std::size_t begin) const { return &centroids_[begin]; }
  TriangleId triangle(std::size_t i) const { return triangles_[i]; }
  const std::vector<TriangleId>& triangles() const { return triangles_; }

  /// Puts those of [begin, end) that are nearer to the first pole in front; returns where the
  /// others begin.
  std::size_t split(std::size_t begin, std::size_t end,
                    const std::array<Eigen::Vector3d, 2>& poles) {
    std::size_t kept = begin;
    std::size_t moved = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d at = centroids_[i];
      if (squaredLength(at - poles[0]) < squaredLength(at - poles[1])) {
        centroids_[kept] = at;
        triangles_[kept++] = triangles_[i];
      } else {
        spare_centroids_[moved] = at;
        spare_[moved++] = triangles_[i];
      }
    }
    std::copy_n(spare_centroids_.begin(), moved,
                centroids_.begin() + static_cast<std::ptrdiff_t>(kept));
    std::copy_n(spare_.begin(), moved, triangles_.begin() + static_cast<std::ptrdiff_t>(kept));
    return kept;
  }

 private:
  Points centroids_, spare_centroids_;
  std::vector<TriangleId> triangles_, spare_;
};

/// A set that waits to be split, and the place that its node's number goes to.
struct Pending {
  std::size_t begin, end, parent, side, depth;
};

}  // namespace

FarthestPairTree::FarthestPairTree(const TriangleMesh& mesh) {
  Partition partition(orderedMembers(mesh));
  nodes_.reserve(mesh.triangleCount() - 1);
  std::vector<Pending>
      pending;  // not recursion: exponentially spaced triangles go some hundreds deep
  if (mesh.triangleCount() > 1) pending.push_back({0, mesh.triangleCount(), 0, 0, 1});
  while (!pending.empty()) {
    const auto [begin, end, parent, side, depth] = pending.back();
    pending.pop_back();
    const std::size_t self = nodes_.size();
    depth_ = std::max(depth_, depth);
    if (self != 0) nodes_[parent].children[side] = Child::node(self);

    const FarthestPair pair = farthestPair(partition.centroids(begin), end - begin);
    const bool coincident = pair.squared_distance == 0.0;
    const std::size_t first = begin + pair.first;
    const std::size_t second = coincident ? begin + (end - begin) / 2 : begin + pair.second;
    Node node = {{*partition.centroids(first), *partition.centroids(second)},
                 {partition.triangle(first), partition.triangle(second)},
                 {Child::leaf(0), Child::leaf(0)}};
    const std::size_t middle = coincident ? second : partition.split(begin, end, node.poles);
    const std::array<std::size_t, 3> bounds = {begin, middle, end};
    for (const std::size_t child :
         {std::size_t{1}, std::size_t{0}}) {  // the first child is popped first
      if (bounds[child + 1] - bounds[child] == 1) {
        node.children[child] = Child::leaf(static_cast<Leaf>(bounds[child]));
      } else {
        pending.push_back({bounds[child], bounds[child + 1], self, child, depth + 1});
      }
    }
    nodes_.push_back(node);
  }
  leaves_ = partition.triangles();
  boxes_.resize(nodes_.size());
  refit(mesh);
}

void FarthestPairTree::refit(const TriangleMesh& mesh) {
  for (std::size_t i = nodes_.size(); i-- > 0;) {  // children before parents
    Node& node = nodes_[i];
    Box box;
    for (const std::size_t side : {0, 1}) {
      node.poles[side] = centroid(mesh.triangle(node.pole_triangles[side]));
      const Child child = node.children[side];
      box.add(child.isLeaf() ? boxOf(mesh.triangle(triangle(child.leaf()))) : boxes_[child.node()]);
    }
    boxes_[i] = box;
  }
}

std::size_t FarthestPairTree::memory() const {
  return nodes_.capacity() * sizeof(Node) + boxes_.capacity() * sizeof(Box) +
         leaves_.capacity() * sizeof(TriangleId);
}

}  // namespace organ_collision::core
