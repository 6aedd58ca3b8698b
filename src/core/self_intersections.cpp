#include "organ_collision/core/self_intersections.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/for_each_leaf.h"
#include "organ_collision/core/box.h"
#include "organ_collision/core/predicates.h"
#include "organ_collision/core/triangle_intersection.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector3d;

/// Boxes and triangles that are looked at for each triangle, on average, at most.
constexpr std::size_t kPatience = 1024;

/// REQUIRES: all are in one plane, the first three not on one line.
bool areOnOneSide(const Vector3d& a, const Vector3d& b, const Vector3d& p, const Vector3d& q) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto side_of = [&](const Vector3d& point) {
      return orientation(alongAxis(a, axis), alongAxis(b, axis), alongAxis(point, axis));
    };
    if (const int side = side_of(p); side != 0) return side == side_of(q);
  }
  return false;
}

/// The edge opposite to a corner, as a triangle.
Triangle edgeAcross(const std::array<Vector3d, 3>& corners, std::size_t corner) {
  const Vector3d& end = corners[(corner + 2) % 3];
  return {corners[(corner + 1) % 3], end, end};
}

/// More than the corners, and the edge between them, that are at the same places.
/// REQUIRES: both have an area.
bool haveMoreInCommon(const Triangle& first, const Triangle& second) {
  const std::array<Vector3d, 3> ours = cornersOf(first);
  const std::array<Vector3d, 3> theirs = cornersOf(second);
  std::size_t shared = 0, our_sum = 0, their_sum = 0;  // of the numbers of corners
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (ours[i] != theirs[k]) continue;
      ++shared;
      our_sum += i;
      their_sum += k;
    }
  }
  switch (shared) {
    case 0:
      return trianglesIntersect(first, second);
    case 1:  // from there, whatever else they share goes on to where one of them ends
      return trianglesIntersect(edgeAcross(ours, our_sum), second) ||
             trianglesIntersect(edgeAcross(theirs, their_sum), first);
    case 2: {
      const std::size_t our_own = 3 - our_sum;  // 0 + 1 + 2 - our_sum: the one that is left
      const Vector3d& apex = theirs[3 - their_sum];
      return orientation(first.a, first.b, first.c, apex) == 0 &&
             areOnOneSide(ours[(our_own + 1) % 3], ours[(our_own + 2) % 3], ours[our_own], apex);
    }
    default:
      return true;
  }
}

/// Looks for the others of one triangle after the other.
class Finder {
 public:
  explicit Finder(const CollisionMesh& organ)
      : organ_(organ), patience_(kPatience * organ.mesh().triangleCount()) {}

  /// Of those after it; adds them to the pairs found.
  void find(TriangleId id, std::vector<TrianglePair>& pairs) {
    const Triangle triangle = organ_.mesh().triangle(id);
    if (collinear(triangle.a, triangle.b, triangle.c)) return;
    const Box box = inUnitFrame(boxOf(triangle));
    const auto is_wanted = [&](const Box& of_set) { return looksOn() && meet(of_set, box); };
    forEachLeaf(organ_.wideTree(), is_wanted, [&](FarthestPairTree::Leaf leaf) {
      const TriangleId other_id = organ_.tree().triangle(leaf);
      if (other_id <= id || !looksOn()) return;
      const Triangle other = organ_.mesh().triangle(other_id);
      if (collinear(other.a, other.b, other.c)) return;
      if (haveMoreInCommon(triangle, other)) pairs.push_back({id, other_id});
    });
  }

  bool isPatient() const { return patience_ > 0; }

 private:
  bool looksOn() { return patience_ > 0 && --patience_ > 0; }

  Box inUnitFrame(const Box& box) const {
    constexpr double kRounding = 0x1p-45;  // more than that of coordinates below 2
    const UnitFrame& frame = organ_.wideTree().frame();
    return {frame(box.low).array() - kRounding, frame(box.high).array() + kRounding};
  }

  const CollisionMesh& organ_;
  std::size_t patience_;
};

}  // namespace

SelfIntersections selfIntersections(const CollisionMesh& organ, std::size_t max_pairs) {
  SelfIntersections found{{}, true};
  Finder finder(organ);
  for (std::size_t i = 0; i < organ.mesh().triangleCount(); ++i) {
    const auto first_new = static_cast<std::ptrdiff_t>(found.pairs.size());
    finder.find(static_cast<TriangleId>(i), found.pairs);
    std::sort(found.pairs.begin() + first_new, found.pairs.end(),
              [](const TrianglePair& left, const TrianglePair& right) {
                return left.second < right.second;
              });
    found.complete = finder.isPatient() && found.pairs.size() <= max_pairs;
    if (!found.complete) break;
  }
  found.pairs.resize(std::min(found.pairs.size(), max_pairs));
  return found;
}

std::string warning(const SelfIntersections& found) {
  if (found.pairs.empty()) {
    return found.complete ? ""
                          : "whether the surface crosses itself is not known: too many triangles "
                            "are in each other's boxes";
  }
  const auto number = [](TriangleId id) { return std::to_string(index(id)); };
  return "triangles " + number(found.pairs.front().first) + " and " +
         number(found.pairs.front().second) +
         " cross or touch each other (such pairs: " + std::to_string(found.pairs.size()) +
         (found.complete ? "" : " or more") + "): what is inside there is not known";
}

}  // namespace organ_collision::core
