#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "core/greedy_search.h"
#include "core/kernels/kernels.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/sign.h"
#include "organ_collision/core/triangle_distance.h"

// A search for the nearest triangle, between the kernels, which know no organ, and the public
// functions.
namespace organ_collision::core {

/// What the search asks of a tip: its corners, where to route it, how near a triangle is.
class PointTip {
 public:
  static constexpr std::size_t kCorners = 1;

  explicit PointTip(const Eigen::Vector3d& point) : point_(point) {}
  const Eigen::Vector3d& corner(std::size_t /*i*/) const { return point_; }
  const Eigen::Vector3d& routingPoint() const { return point_; }
  double squaredDistanceTo(const Box& box) const { return squaredDistance(box, point_); }
  ClosestPair measure(const TriangleMesh& mesh, const Corners& corners) const {
    return {point_, closestPointOnTriangle(point_, mesh.position(corners[0]),
                                           mesh.position(corners[1]), mesh.position(corners[2]))};
  }

 private:
  const Eigen::Vector3d& point_;
};

class TriangleTip {
 public:
  static constexpr std::size_t kCorners = 3;

  explicit TriangleTip(const Triangle& tip) : tip_(tip), centroid_(centroid(tip)) {}
  const Eigen::Vector3d& corner(std::size_t i) const {
    return i == 0 ? tip_.a : i == 1 ? tip_.b : tip_.c;
  }
  const Eigen::Vector3d& routingPoint() const { return centroid_; }
  double squaredDistanceTo(const Box& box) const { return squaredDistance(box, boxOf(tip_)); }
  ClosestPair measure(const TriangleMesh& mesh, const Corners& corners) const {
    return closestPoints(tip_, mesh.triangle(corners));
  }

 private:
  const Triangle& tip_;
  Eigen::Vector3d centroid_;
};

/// Makes the nearest points, which are known, an answer with neither normal nor sign. All other
/// triangles are farther than `of_rest` [m], or as far.
inline void nameUnsigned(TriangleId triangle, double of_rest, const SearchWork& work,
                         NearestTriangle& nearest) {
  nearest.triangle = triangle;
  nearest.normal.setZero();
  nearest.distance = nearest.upper_bound = std::sqrt(nearest.closest.squared_distance);
  nearest.lower_bound = std::min(nearest.distance, of_rest);
  nearest.distance_signed = false;
  nearest.work = work;
}

/// Adds what the surface around the nearest point tells: the normal, and the sign where it is
/// proven. `corner` is one of the tip's.
void addSign(const CollisionMesh& organ, const Eigen::Vector3d& corner, NearestTriangle& nearest);
/// REQUIRES: `normal` is the surface's at the nearest point.
void addSign(const CollisionMesh& organ, const Eigen::Vector3d& corner, const SurfaceNormal& normal,
             NearestTriangle& nearest);

/// Room for what waits while a tree is searched; the calling thread's.
const FrontierRoom& roomFor(const WideTree& tree);

/// More than that are not to be found in a core's own cache.
constexpr std::size_t kUncachedPackets = 1U << 12U;

template <class Tip>
class NearestSearch : protected Search {
 public:
  /// `nearest` is written to all the while, and is the answer in the end.
  NearestSearch(const CollisionMesh& organ, const Tip& tip, const Accuracy& accuracy, Sign sign,
                NearestTriangle& nearest)
      : NearestSearch(organ, tip, sign, nearest) {
    prepare(accuracy);
  }

  void run() {
    if (sparing) {
      const GreedyPath greedy = greedySearch(organ_, tip_.routingPoint());
      measure(greedy.end);
      bounds += greedy.splits;
      --leaves_left;
      ++triangles;
    }
    if (farthest < kBeyond) {
      walk();
    } else {
      measureAll();
    }
    answer();
  }

  /// Adds normal and sign to the answer. REQUIRES: run().
  void addSign() const {
    addSign(surfaceNormal(organ_, nearest_.triangle, nearest_.closest.feature));
  }

 protected:
  /// Only to measure triangles; all else needs prepare().
  NearestSearch(const CollisionMesh& organ, const Tip& tip, Sign sign, NearestTriangle& nearest)
      : organ_(organ), tip_(tip), nearest_(nearest), scale_(organ.wideTree().frame().scale) {
    leaf_corners = organ.wideTree().corners().data();
    Search::measure = sign == Sign::kProven ? measureIn<Sign::kProven> : measureIn<Sign::kNone>;
    best = std::numeric_limits<double>::infinity();
    best_leaf = kNoLeaf;
    best_vertex = kNoVertex;
  }

  void prepare(const Accuracy& accuracy) {
    const WideTree& tree = organ_.wideTree();
    nodes = tree.nodes().data();
    splits = tree.guide().nodes.data();
    packets = tree.packets().data();
    positions = organ_.mesh().positions().front().data();
    fetches = tree.packets().size() > kUncachedPackets;
    for (std::size_t i = 0; i < Tip::kCorners; ++i) {
      if (i > 0 && tip_.corner(i) == tip_.corner(i - 1)) continue;  // a segment or a point
      const Eigen::Vector3d unit = tree.frame()(tip_.corner(i));
      corners[corner_count++] = {unit.x(), unit.y(), unit.z()};
      farthest = std::max(farthest, largestCoordinate(unit));
    }
    sparing = accuracy.max_leaves != 0;
    leaves_left =
        accuracy.max_leaves == 0 ? std::numeric_limits<std::uint32_t>::max() : accuracy.max_leaves;
    Search::roomOfTie = [](const Search& search, FarthestPairTree::Leaf leaf) {
      return static_cast<const NearestSearch&>(search).roomOfTie(leaf);
    };
    is_exact = accuracy.max_relative_error == 0.0 && accuracy.max_absolute_error == 0.0 && !sparing;
    share = is_exact ? 1.0 : 1.0 / (1.0 + accuracy.max_relative_error);  // where it is, no division
    allowance = accuracy.max_absolute_error * scale_;
    unopened = std::numeric_limits<double>::infinity();
  }

  void walk() {
    room = &roomFor(organ_.wideTree());
    kernels().walk(*this);
  }

  /// Of the surface at the nearest point; not clear where another may be meant.
  void addSign(SurfaceNormal normal) const {
    normal.is_clear = normal.is_clear && !is_contested_;
    core::addSign(organ_, tip_.corner(0), normal, nearest_);
  }

  void measure(FarthestPairTree::Leaf leaf) { Search::measure(*this, leaf); }

  template <Sign kSign>
  static void measureIn(Search& search, FarthestPairTree::Leaf leaf) {
    static_cast<NearestSearch&>(search).measureFor<kSign>(leaf);
  }

  template <Sign kSign>
  void measureFor(FarthestPairTree::Leaf leaf) {
    if (squared_best_ == 0.0 && leaf > best_leaf) return;
    if (nameIfTied(leaf)) return;
    const Corners& vertices = leaf_corners[leaf];
    const ClosestPair candidate = tip_.measure(organ_.mesh(), vertices);
    const double squared_distance = candidate.on_second.squared_distance;
    if constexpr (kSign == Sign::kProven) {
      if (squared_distance <= squared_tie_) contest(leaf, candidate.on_second);
    }
    if (squared_distance > squared_best_ || (squared_distance == squared_best_ && leaf > best_leaf))
      return;
    nearest_.closest = candidate.on_second;
    nearest_.tip_point = candidate.point_on_first;
    best_vertex = nearestVertex(vertices);
    best_leaf = leaf;
    squared_best_ = squared_distance;
    const double distance = std::sqrt(squared_distance);
    if constexpr (kSign == Sign::kProven) squared_tie_ = squaredTie(distance);
    best = std::min(best, distance * scale_);
  }

  /// The square of how far away what is as near as that [m] may seem to be: more than rounding
  /// takes of both.
  double squaredTie(double distance) const {
    constexpr double kTie = 0x1p-48;
    const double most = distance + kTie * (distance + 4.0 / scale_);
    return most * most;
  }

  /// Notes whether a triangle that is nearer than the best, or about as near, has another feature
  /// there.
  void contest(FarthestPairTree::Leaf leaf, const ClosestPoint& closest) {
    if (squared_best_ > squaredTie(std::sqrt(closest.squared_distance))) {
      is_contested_ = false;
    } else if (leaf != best_leaf) {
      is_contested_ =
          is_contested_ || !isSameFeature(organ_.topology(), leaf_corners[leaf], closest.feature,
                                          leaf_corners[best_leaf], nearest_.closest.feature);
    }
  }

  /// That a point is nearest to, of the best triangle's.
  VertexId nearestVertex(const Corners& vertices) const {
    const Feature feature = nearest_.closest.feature;
    if (!std::is_same_v<Tip, PointTip> || feature > Feature::kVertexC) return kNoVertex;
    return vertices[static_cast<std::size_t>(feature)];
  }

  /// Around a vertex that is nearest all triangles tie, and beside an edge: this is told sooner
  /// than they are measured, which would find the same point. Whether this one does; it is named
  /// then, if it comes before the one that was.
  bool nameIfTied(FarthestPairTree::Leaf leaf) {
    if (best_vertex != kNoVertex) return nameIfTiedAtVertex(leaf);
    return std::is_same_v<Tip, PointTip> && best_leaf != kNoLeaf && nameIfTiedAtEdge(leaf);
  }
  bool nameIfTiedAtVertex(FarthestPairTree::Leaf leaf) {
    if (!fromBestVertex(leaf, false, isClosestCorner)) return false;
    if (leaf < best_leaf) {
      const std::size_t corner = cornerAt(best_vertex, leaf_corners[leaf]);
      nameInstead(leaf, static_cast<Feature>(corner),
                  Eigen::Vector3d::Unit(static_cast<Eigen::Index>(corner)));
    }
    return true;
  }
  bool nameIfTiedAtEdge(FarthestPairTree::Leaf leaf) {
    constexpr auto kFirst = static_cast<std::size_t>(Feature::kEdgeAB);
    const std::size_t edge = static_cast<std::size_t>(nearest_.closest.feature) - kFirst;
    if (edge > 2) return false;
    const auto after = [](std::size_t corner) { return corner == 2 ? 0 : corner + 1; };
    const VertexId start = leaf_corners[best_leaf][edge];
    const VertexId end = leaf_corners[best_leaf][after(edge)];
    const Corners& vertices = leaf_corners[leaf];
    const std::size_t at_start = cornerAt(start, vertices);
    const std::size_t at_end = cornerAt(end, vertices);
    if (vertices[at_start] != start || vertices[at_end] != end) return false;
    const TriangleMesh& mesh = organ_.mesh();
    if (!isClosestOnEdge(tip_.corner(0), nearest_.closest, mesh.position(start), mesh.position(end),
                         mesh.position(vertices[3 - at_start - at_end])))
      return false;
    if (leaf < best_leaf) {
      Eigen::Vector3d weights = Eigen::Vector3d::Zero();
      weights[at_start] = nearest_.closest.barycentric[edge];
      weights[at_end] = nearest_.closest.barycentric[after(edge)];
      nameInstead(leaf,
                  static_cast<Feature>(kFirst + (after(at_start) == at_end ? at_start : at_end)),
                  weights);
    }
    return true;
  }
  /// For the same point.
  void nameInstead(FarthestPairTree::Leaf leaf, Feature feature, const Eigen::Vector3d& weights) {
    best_leaf = leaf;
    nearest_.closest.feature = feature;
    nearest_.closest.barycentric = weights;
  }
  double roomOfTie(FarthestPairTree::Leaf leaf) const {
    if (leaf <= best_leaf) return -1.0;
    return fromBestVertex(leaf, -1.0, [this](const auto&... seen) {
      return isClosestCorner(seen...) ? roomAtClosestCorner(seen...) * scale_ : -1.0;
    });
  }
  /// What `ask` says of the nearest vertex' offset and a triangle's edges from there; `otherwise`
  /// of triangles without it. REQUIRES: there is one.
  template <class Answer, class Ask>
  Answer fromBestVertex(FarthestPairTree::Leaf leaf, Answer otherwise, const Ask& ask) const {
    const Corners& vertices = leaf_corners[leaf];
    const std::size_t corner = cornerAt(best_vertex, vertices);
    if (vertices[corner] != best_vertex) return otherwise;
    const auto edge_to = [&](std::size_t other) -> Eigen::Vector3d {
      return organ_.mesh().position(vertices[other]) - nearest_.closest.point;
    };
    return ask(nearest_.closest.offset, edge_to(corner == 2 ? 0 : corner + 1),
               edge_to(corner == 0 ? 2 : corner - 1));
  }
  /// Of a triangle that has the vertex; c of others.
  static std::size_t cornerAt(VertexId vertex, const Corners& vertices) {
    return vertices[0] == vertex ? 0 : vertices[1] == vertex ? 1 : 2;
  }

  void measureAll() {
    for (FarthestPairTree::Leaf leaf = 0; leaf < organ_.tree().root().size(); ++leaf) {
      if (leaves_left == 0) {
        unopened = 0.0;
        return;
      }
      measure(leaf);
      --leaves_left;
      ++triangles;
    }
  }

  void answer() {
    const double of_rest = unopened < best ? lowerBound() : std::numeric_limits<double>::infinity();
    nameUnsigned(organ_.tree().triangle(best_leaf), of_rest, {bounds, triangles}, nearest_);
  }

  /// [m] Of all triangles.
  double lowerBound() const {
    const double to_box = std::sqrt(tip_.squaredDistanceTo(organ_.health().box));
    return std::max(to_box, unopened / scale_);
  }

  const CollisionMesh& organ_;
  const Tip& tip_;
  NearestTriangle& nearest_;  // its points are those of the best so far
  const double scale_;
  double squared_best_ = std::numeric_limits<double>::infinity();
  double squared_tie_ = std::numeric_limits<double>::infinity();
  bool is_contested_ = false;  // another feature is as near, but for rounding
};

}  // namespace organ_collision::core
