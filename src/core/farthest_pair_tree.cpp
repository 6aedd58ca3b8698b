#include "organ_collision/core/farthest_pair_tree.h"

#include <tbb/parallel_sort.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>
#include <tuple>

#include "core/for_each.h"
#include "core/kernels/kernels.h"
#include "organ_collision/core/farthest_pair.h"
#include "organ_collision/core/huge_pages.h"

namespace organ_collision::core {
namespace {

bool lexicographicallyLess(const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
  return std::make_tuple(p.x(), p.y(), p.z()) < std::make_tuple(q.x(), q.y(), q.z());
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

using Columns = std::array<HugePageVector<double>, 3>;

constexpr std::size_t kTrianglesPerTask = 8192;

Columns columnsOf(std::size_t size) {
  return {HugePageVector<double>(size), HugePageVector<double>(size), HugePageVector<double>(size)};
}

Columns centroidsOf(const TriangleMesh& mesh) {
  Columns centroids = columnsOf(mesh.triangleCount());
  forEach(mesh.triangleCount(), kTrianglesPerTask, [&](std::size_t i) {
    const Eigen::Vector3d at = centroid(mesh.triangle(static_cast<TriangleId>(i)));
    for (std::size_t axis = 0; axis < 3; ++axis)
      centroids[axis][i] = at[static_cast<Eigen::Index>(axis)];
  });
  return centroids;
}

/// By centroid, then by sorted corners: of two triangles, the lexicographically smaller.
bool comesFirst(const TriangleMesh& mesh, const Columns& centroids, TriangleId first,
                TriangleId second) {
  for (const HugePageVector<double>& column : centroids) {
    const double one = column[index(first)];
    const double other = column[index(second)];
    if (one != other) return one < other;
  }
  const Triangle one = mesh.triangle(first);
  const Triangle other = mesh.triangle(second);
  for (const auto& corners : {sortedCorners, cornersOf}) {  // the latter for turned duplicates
    if (corners(one) != corners(other)) return lexicographicallyLess(corners(one), corners(other));
  }
  return first < second;
}

/// All triangles so that from here on "lexicographically smaller" is "comes first": dealt into as
/// many slices along x as they are, then sorted slice by slice.
std::vector<TriangleId> orderedTriangles(const TriangleMesh& mesh, const Columns& centroids) {
  const std::size_t count = mesh.triangleCount();
  const auto [low, high] = std::minmax_element(centroids[0].begin(), centroids[0].end());
  // Rounding is monotone: whoever has the smaller x is in no later slice.
  const auto slice_of = [&, least = *low, width = *high - *low](std::size_t i) {
    const double part = width > 0.0 ? (centroids[0][i] - least) / width : 0.0;
    return std::min(static_cast<std::size_t>(part * static_cast<double>(count)), count - 1);
  };
  std::vector<std::uint32_t> slices(count);
  forEach(count, kTrianglesPerTask,
          [&](std::size_t i) { slices[i] = static_cast<std::uint32_t>(slice_of(i)); });
  std::vector<std::uint32_t> ends(count + 1, 0);  // of the slices; until all are dealt, their next
  for (const std::uint32_t slice : slices) ++ends[slice + 1];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<TriangleId> triangles(count);
  for (std::size_t i = 0; i < count; ++i) triangles[ends[slices[i]]++] = static_cast<TriangleId>(i);
  const auto comes_first = [&](TriangleId first, TriangleId second) {
    return comesFirst(mesh, centroids, first, second);
  };
  forEach(count, kTrianglesPerTask, [&](std::size_t slice) {
    const std::uint32_t begin = slice > 0 ? ends[slice - 1] : 0;
    const std::uint32_t end = ends[slice];
    if (end - begin > 1)
      tbb::parallel_sort(&triangles[begin], &triangles[begin] + (end - begin), comes_first);
  });
  return triangles;
}

}  // namespace

/// Splits sets without disturbing the order of those that stay together; sets that are large are
/// split side by side.
class FarthestPairTree::Builder {
 public:
  Builder(const TriangleMesh& mesh, HugePageVector<Node>& nodes)
      : nodes_(nodes),
        count_(mesh.triangleCount()),
        centroids_(columnsOf(2 * count_)),
        triangles_(2 * count_) {
    const Columns centroids = centroidsOf(mesh);
    const std::vector<TriangleId> ordered = orderedTriangles(mesh, centroids);
    forEach(count_, kTrianglesPerTask, [&](std::size_t i) {
      triangles_[i] = ordered[i];
      for (std::size_t axis = 0; axis < 3; ++axis)
        centroids_[axis][i] = centroids[axis][index(ordered[i])];
    });
  }

  void run() {
    if (nodes_.empty()) return;
    splitAll({{0, static_cast<Leaf>(count_), 0}, 1});
    tasks_.wait();
    std::vector<Leaf> leaf_of(count_);
    for (Leaf leaf = 0; leaf < count_; ++leaf) leaf_of[index(triangles_[leaf])] = leaf;
    for (Node& node : nodes_) {
      for (Leaf& pole : node.poles) pole = leaf_of[pole];
    }
  }

  /// In the leaves' order.
  std::vector<TriangleId> triangles() const {
    return {triangles_.begin(), triangles_.begin() + static_cast<std::ptrdiff_t>(count_)};
  }
  std::size_t depth() const { return depth_; }

 private:
  struct Pending {
    Set set;
    std::size_t depth;
  };
  static constexpr std::uint32_t kTask = 512;  // leaves that are worth a task

  /// Not by recursion: exponentially spaced triangles go some hundreds deep.
  void splitAll(const Pending& whole) {
    std::vector<Pending> pending = {whole};
    while (!pending.empty()) {
      const auto [set, depth] = pending.back();
      pending.pop_back();
      if (set.size() <= kLaneCount) {
        noteDepth(depth - 1 + splitFew(set));
        continue;
      }
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

  /// Splits a set of a few all the way down; returns how many levels that takes.
  std::size_t splitFew(const Set& set) {
    FewSplits few;
    kernels().splitFew(pointsOf(set), set.size(), few);
    std::array<TriangleId, kLaneCount> triangles;
    std::copy(&triangles_[set.begin], &triangles_[set.end], triangles.begin());
    const auto leaf = [&](std::uint32_t i) { return static_cast<Leaf>(index(triangles[i])); };
    for (std::uint32_t i = 0; i + 1 < set.size(); ++i) {
      const auto& [poles, first_size] = few.splits[i];
      nodes_[set.node + i] = {{leaf(poles[0]), leaf(poles[1])}, first_size};
    }
    for (std::uint32_t i = 0; i < set.size(); ++i)
      triangles_[set.begin + i] = triangles[few.order[i]];
    return few.levels;
  }

  /// Fills the set's node, its poles as triangles; returns how many leaves go with the first.
  std::uint32_t split(const Set& set) {
    const FarthestPair pair = farthestPair(pointsOf(set), set.size());
    const bool coincident = pair.squared_distance == 0.0;
    const std::size_t first = set.begin + pair.first;
    const std::size_t second = set.begin + (coincident ? set.size() / 2 : pair.second);
    Node& node = nodes_[set.node];
    node.poles = {static_cast<Leaf>(index(triangles_[first])),
                  static_cast<Leaf>(index(triangles_[second]))};
    node.first_size =
        coincident ? set.size() / 2 : separate(set, centroid(first), centroid(second));
    return node.first_size;
  }

  PointColumns pointsOf(const Set& set) const {
    return {&centroids_[0][set.begin], &centroids_[1][set.begin], &centroids_[2][set.begin]};
  }

  std::array<double, 3> centroid(std::size_t i) const {
    return {centroids_[0][i], centroids_[1][i], centroids_[2][i]};
  }

  /// Puts those that are nearer to the first pole in front; returns how many they are.
  std::uint32_t separate(const Set& set, const std::array<double, 3>& first_pole,
                         const std::array<double, 3>& second_pole) {
    const PlainTriangles all = {&centroids_[0][set.begin], &centroids_[1][set.begin],
                                &centroids_[2][set.begin], &triangles_[set.begin]};
    const std::size_t first_size =
        kernels().separate(all, set.size(), count_, first_pole, second_pole);
    const std::size_t second_size = set.size() - first_size;
    for (double* column : {all.x, all.y, all.z})
      std::copy_n(column + count_, second_size, column + first_size);
    std::copy_n(all.ids + count_, second_size, all.ids + first_size);
    return static_cast<std::uint32_t>(first_size);
  }

  void noteDepth(std::size_t depth) {
    std::size_t known = depth_;
    while (known < depth && !depth_.compare_exchange_weak(known, depth)) {
    }
  }

  HugePageVector<Node>& nodes_;
  std::size_t count_;
  // In the leaves' order; then as much again, for those that are moved out of the way.
  Columns centroids_;
  HugePageVector<TriangleId> triangles_;
  std::atomic<std::size_t> depth_ = 0;
  OwnContext context_;
  tbb::task_group tasks_{context_};
};

FarthestPairTree::FarthestPairTree(const TriangleMesh& mesh) : nodes_(mesh.triangleCount() - 1) {
  Builder builder(mesh, nodes_);
  builder.run();
  leaves_ = builder.triangles();
  depth_ = builder.depth();
}

std::size_t FarthestPairTree::memory() const {
  return nodes_.capacity() * sizeof(Node) + leaves_.capacity() * sizeof(TriangleId);
}

}  // namespace organ_collision::core
