#include "organ_collision/core/contact.h"

#include <algorithm>

#include "core/perhaps_inside.h"
#include "core/unit_vector.h"
#include "organ_collision/core/nearest_pair.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector3d;

bool isPoint(const Triangle& core) { return core.a == core.b && core.b == core.c; }

/// Asks an organ, anew or from what is known of the last time.
class Asker {
 public:
  explicit Asker(const CollisionMesh& organ) : organ_(organ) {}
  Asker(const CollisionMesh& organ, double travel, Tracker& tracker, PairTracker& pair_tracker)
      : organ_(organ), travel_(travel), tracker_(&tracker), pair_tracker_(&pair_tracker) {}

  const CollisionMesh& organ() const { return organ_; }

  NearestTriangle nearestToCore(const Triangle& core, const Accuracy& accuracy) const {
    return isPoint(core) ? nearest(core.a, accuracy) : nearest(core, accuracy);
  }

  NearestTriangle nearestToMesh(const RigidMesh& mesh, const Accuracy& accuracy) const {
    if (!follows(accuracy)) return nearestPair(*mesh.surface, mesh.pose, organ_, accuracy).nearest;
    return pair_tracker_->nearestPair(*mesh.surface, 0.0, mesh.pose, organ_, travel_).nearest;
  }

 private:
  /// Who asks for a number of leaves is to get what they find, not more.
  bool follows(const Accuracy& accuracy) const {
    requireUsable(accuracy);
    return tracker_ != nullptr && accuracy.max_leaves == 0;
  }

  template <class Tip>
  NearestTriangle nearest(const Tip& tip, const Accuracy& accuracy) const {
    if (!follows(accuracy)) return nearestTriangle(organ_, tip, accuracy);
    return tracker_->nearestTriangle(organ_, travel_, tip);
  }

  const CollisionMesh& organ_;
  const double travel_ = 0.0;  // [m]
  Tracker* tracker_ = nullptr;
  PairTracker* pair_tracker_ = nullptr;
};

/// Whether an answer to the core is good enough for the shape: a relative error is allowed of what
/// is left without the radius only.
bool isGoodEnough(const NearestTriangle& nearest, double radius, const Accuracy& accuracy) {
  if (nearest.isExact() || radius == 0.0 || accuracy.max_relative_error == 0.0) return true;
  const bool spent = accuracy.max_leaves != 0 && nearest.work.triangles >= accuracy.max_leaves;
  const double least = nearest.lower_bound - radius;
  const double found = nearest.upper_bound - radius;
  return spent || found <= 0.0 || found - least <= accuracy.max_absolute_error ||
         found <= (1.0 + accuracy.max_relative_error) * least;
}

NearestTriangle nearestWithin(const Asker& asker, const RoundShape& shape,
                              const Accuracy& accuracy) {
  NearestTriangle nearest = asker.nearestToCore(shape.core, accuracy);
  if (isGoodEnough(nearest, shape.radius, accuracy)) return nearest;
  const double allowed =
      accuracy.max_relative_error * std::max(0.0, nearest.lower_bound - shape.radius);
  NearestTriangle better = asker.nearestToCore(
      shape.core, {0.0, std::max(accuracy.max_absolute_error, allowed), accuracy.max_leaves});
  better.work += nearest.work;
  return better;
}

/// The unit vector perpendicular to `axis` that is nearest to `direction`, which has length 1 or 0;
/// any where the two are parallel, but for rounding.
Vector3d perpendicularTo(const Vector3d& axis, const Vector3d& direction) {
  constexpr double kParallel = 0x1p-20;  // of 1: above it rounding does not decide what is left
  const Vector3d along = unit(axis);
  const Vector3d perpendicular = direction - along.dot(direction) * along;
  if (perpendicular.norm() < kParallel) return along.unitOrthogonal();
  return (perpendicular - along.dot(perpendicular) * along).normalized();
}

/// Unit, from the core into the organ, where its nearest point is.
Vector3d directionInwards(const NearestTriangle& nearest) {
  const Vector3d& offset = nearest.closest.offset;
  if (!offset.isZero(0.0)) return (nearest.distance > 0.0 ? 1.0 : -1.0) * unit(offset);
  return nearest.normal.isZero(0.0) ? Vector3d(1, 0, 0) : Vector3d(-nearest.normal);
}

/// The direction in which the surface of the shape is just one radius from its core's nearest or
/// deepest point, and nearest to `direction`: on a segment perpendicular to it, at an end anywhere
/// but back along it.
Vector3d towardsSurface(const Vector3d& direction, const NearestTriangle& nearest,
                        const Triangle& core) {
  const Vector3d axis = core.b - core.a;
  const double along = direction.dot(axis);
  const bool at_a = nearest.tip_point == core.a;
  const bool at_b = nearest.tip_point == core.b;
  // Rounding chooses between the ends of an axis that is far too short to tell them apart.
  const bool is_short = nearest.distance > axis.stableNorm();
  if (axis.isZero(0.0) || (at_a && (along <= 0.0 || is_short)) ||
      (at_b && (along >= 0.0 || is_short)))
    return direction;
  return perpendicularTo(axis, direction);
}

/// The answer to a core as that of the shape around it.
NearestTriangle inflated(NearestTriangle nearest, const RoundShape& shape) {
  if (shape.radius == 0.0) return nearest;
  nearest.tip_point +=
      shape.radius * towardsSurface(directionInwards(nearest), nearest, shape.core);
  nearest.distance -= shape.radius;
  nearest.lower_bound -= shape.radius;
  nearest.upper_bound -= shape.radius;
  return nearest;
}

NearestTriangle nearestToShape(const Asker& asker, const Shape& shape, const Accuracy& accuracy) {
  if (const auto* mesh = std::get_if<RigidMesh>(&shape))
    return asker.nearestToMesh(*mesh, accuracy);
  const RoundShape round = *roundShape(shape);
  return inflated(nearestWithin(asker, round, accuracy), round);
}

double deepestOf(const NearestTriangle& nearest, const Shape& shape) {
  const auto round = roundShape(shape);
  return lowerBoundIfInside(nearest, round ? round->radius : 0.0);
}

Contact contactOf(const Asker& asker, const Shape& shape, const Accuracy& accuracy) {
  requireUsable(shape);
  const bool is_solid = asker.organ().health().isSolid();
  NearestTriangle nearest = nearestToShape(asker, shape, accuracy);
  nearest.distance_signed = nearest.distance_signed && is_solid;  // or what is around it has one
  const bool colliding = nearest.distance <= 0.0;
  const bool knows_side = nearest.distance_signed || !is_solid;
  return {nearest, colliding, colliding || (nearest.lower_bound > 0.0 && knows_side)};
}

/// A sign is proven where both bounds have it: that of a core may not be that of the shape around
/// it. Without one, what overlaps is as near as can be: only a sign tells how deep.
Contact withProvenSign(Contact contact) {
  NearestTriangle& nearest = contact.nearest;
  if (nearest.lower_bound < 0.0 && nearest.upper_bound > 0.0) nearest.distance_signed = false;
  if (nearest.distance_signed) return contact;
  for (double* distance : {&nearest.distance, &nearest.lower_bound, &nearest.upper_bound})
    *distance = std::max(*distance, 0.0);
  return contact;
}

bool tellsDepth(const Contact& contact) {
  return contact.colliding && contact.nearest.distance_signed;
}

/// Of two pieces of an instrument: a depth that is proven says more than that surfaces meet.
bool isNearer(const Contact& one, const Contact& other) {
  if (tellsDepth(one) != tellsDepth(other)) return tellsDepth(one);
  return one.nearest.distance < other.nearest.distance;
}

/// `asker(i)` asks for the i-th piece.
template <class AskerOf>
Contact contactOf(const AskerOf& asker, const Shapes& shapes,
                  const Eigen::Isometry3d& organ_from_shapes, const Accuracy& accuracy) {
  Contact whole = contactOf(asker(0), transformed(shapes.front(), organ_from_shapes), accuracy);
  bool any_colliding = whole.colliding;
  bool all_certain = whole.colliding_certain;
  bool all_signed = whole.nearest.distance_signed;
  double lower_bound = whole.nearest.lower_bound;
  double deepest = deepestOf(whole.nearest, shapes.front());
  SearchWork work = whole.nearest.work;
  for (std::size_t i = 1; i < shapes.size(); ++i) {
    const Contact piece = contactOf(asker(i), transformed(shapes[i], organ_from_shapes), accuracy);
    any_colliding = any_colliding || piece.colliding;
    all_certain = all_certain && piece.colliding_certain;
    all_signed = all_signed && piece.nearest.distance_signed;
    lower_bound = std::min(lower_bound, piece.nearest.lower_bound);
    deepest = std::min(deepest, deepestOf(piece.nearest, shapes[i]));
    work += piece.nearest.work;
    if (isNearer(piece, whole)) whole = piece;
  }
  whole.nearest.lower_bound = lower_bound;
  const bool is_perhaps_deeper =
      tellsDepth(whole) && (!all_signed || lower_bound < whole.nearest.distance);
  if (is_perhaps_deeper) {
    whole.nearest.lower_bound = deepest;
    whole.nearest.distance = whole.nearest.upper_bound;
  }
  whole.nearest.distance_signed = whole.nearest.distance_signed && (all_signed || whole.colliding);
  whole.nearest.work = work;
  whole.colliding = any_colliding;
  whole.colliding_certain = any_colliding || all_certain;
  return withProvenSign(whole);
}

}  // namespace

Contact contact(const CollisionMesh& organ, const Shape& shape, const Accuracy& accuracy) {
  return withProvenSign(contactOf(Asker(organ), shape, accuracy));
}

Contact contact(const CollisionMesh& organ, const Shapes& shapes,
                const Eigen::Isometry3d& organ_from_shapes, const Accuracy& accuracy) {
  const auto asker = [&](std::size_t) { return Asker(organ); };
  return contactOf(asker, shapes, organ_from_shapes, accuracy);
}

Contact ContactTracker::contact(const CollisionMesh& organ, double travel, const Shapes& shapes,
                                const Eigen::Isometry3d& organ_from_shapes,
                                const Accuracy& accuracy) {
  pieces_.resize(shapes.size());
  const auto asker = [&](std::size_t i) {
    return Asker(organ, travel, pieces_[i].round, pieces_[i].mesh);
  };
  return contactOf(asker, shapes, organ_from_shapes, accuracy);
}

}  // namespace organ_collision::core
