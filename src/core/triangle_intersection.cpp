#include "organ_collision/core/triangle_intersection.h"

#include <array>
#include <cstddef>
#include <optional>

#include "organ_collision/core/box.h"
#include "organ_collision/core/predicates.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

using Signs = std::array<int, 3>;

bool anyPositive(const Signs& s) { return s[0] > 0 || s[1] > 0 || s[2] > 0; }
bool anyNegative(const Signs& s) { return s[0] < 0 || s[1] < 0 || s[2] < 0; }
bool allPositive(const Signs& s) { return s[0] > 0 && s[1] > 0 && s[2] > 0; }
bool allNegative(const Signs& s) { return s[0] < 0 && s[1] < 0 && s[2] < 0; }

/// The sides of the plane of `t` that the corners of `other` are on; all 0 where `t` has no area.
Signs sidesOf(const Triangle& other, const Triangle& t) {
  return {orientation(t.a, t.b, t.c, other.a), orientation(t.a, t.b, t.c, other.b),
          orientation(t.a, t.b, t.c, other.c)};
}

/// True where p is a point of `t`. REQUIRES: p lies in the plane of t, or t has no area.
/// Along an axis that shows an area, mixed signs are outside; where t shows none, any sign is off
/// its line.
bool contains(const Triangle& t, const Vector3d& p) {
  if (!boxOf(t).contains(p)) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector2d a = alongAxis(t.a, axis);
    const Vector2d b = alongAxis(t.b, axis);
    const Vector2d c = alongAxis(t.c, axis);
    const Vector2d x = alongAxis(p, axis);
    const Signs signs{orientation(a, b, x), orientation(b, c, x), orientation(c, a, x)};
    if (anyPositive(signs) && anyNegative(signs)) return false;
  }
  return true;
}

/// True where the segments pq and rs cross in a point inside both.
bool cross(const Vector3d& p, const Vector3d& q, const Vector3d& r, const Vector3d& s) {
  const auto separates = [](const Vector2d& from, const Vector2d& to, const Vector2d& x,
                            const Vector2d& y) {
    return orientation(from, to, x) * orientation(from, to, y) < 0;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const Vector2d p2 = alongAxis(p, axis);
    const Vector2d q2 = alongAxis(q, axis);
    const Vector2d r2 = alongAxis(r, axis);
    const Vector2d s2 = alongAxis(s, axis);
    if (separates(p2, q2, r2, s2) && separates(r2, s2, p2, q2)) return orientation(p, q, r, s) == 0;
  }
  return false;
}

bool crossesAnEdge(const Vector3d& p, const Vector3d& q, const Triangle& t) {
  return cross(p, q, t.a, t.b) || cross(p, q, t.b, t.c) || cross(p, q, t.c, t.a);
}

/// True where pq, whose ends are on either side of the plane of `t`, passes through `t`.
bool pierces(const Vector3d& p, const Vector3d& q, const Triangle& t) {
  const Signs signs{orientation(p, q, t.a, t.b), orientation(p, q, t.b, t.c),
                    orientation(p, q, t.c, t.a)};
  return !(anyPositive(signs) && anyNegative(signs));
}

/// True where a corner of `other` lies in `t`, or one of its edges crosses an edge of `t` or
/// pierces its face.
bool boundaryMeets(const Triangle& other, const Signs& sides, const Triangle& t) {
  const std::array<Vector3d, 3> corners = cornersOf(other);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    const Vector3d& p = corners[i];
    const Vector3d& q = corners[next];
    if (sides[i] == 0 && contains(t, p)) return true;
    if (sides[i] == 0 && sides[next] == 0 && crossesAnEdge(p, q, t)) return true;
    if (sides[i] * sides[next] < 0 && pierces(p, q, t)) return true;
  }
  return false;
}

/// Whether a segment pq with one end on each side of the plane of `t`, or one in it, meets it:
/// otherwise nothing is said. A sign tells the side of an end.
std::optional<bool> segmentMeets(const Vector3d& p, int side_of_p, const Vector3d& q, int side_of_q,
                                 const Triangle& t) {
  if (side_of_p * side_of_q < 0) return pierces(p, q, t);
  if (side_of_p == 0 && side_of_q != 0) return contains(t, p);
  if (side_of_q == 0 && side_of_p != 0) return contains(t, q);
  return std::nullopt;
}

}  // namespace

bool trianglesIntersect(const Triangle& first, const Triangle& second) {
  if (!meet(boxOf(first), boxOf(second))) return false;
  const Signs sides_of_first = sidesOf(first, second);
  if (allPositive(sides_of_first) || allNegative(sides_of_first)) return false;
  if (first.b == first.c) {  // a segment, a shaft's say: its own plane tells nothing
    const std::optional<bool> meets =
        segmentMeets(first.a, sides_of_first[0], first.b, sides_of_first[1], second);
    if (meets) return *meets;
  }
  const Signs sides_of_second = sidesOf(second, first);
  if (allPositive(sides_of_second) || allNegative(sides_of_second)) return false;
  return boundaryMeets(first, sides_of_first, second) ||
         boundaryMeets(second, sides_of_second, first);
}

}  // namespace organ_collision::core
