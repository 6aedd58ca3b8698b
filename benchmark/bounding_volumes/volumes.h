#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>

#include "best_first.h"
#include "organ_collision/core/box.h"

// Volumes around sets of triangles: convex, so they hold the triangles if they hold their corners.
// bound(): a squared distance [m^2] that no point of the set is nearer than.
namespace organ_collision::bench {

using Corners3X = Eigen::Ref<const Eigen::Matrix3Xd>;  // [m], in columns
using Eigen::Vector3d;

struct Tip {
  Vector3d point;  ///< [m]
  double slack;    ///< [m] what rounding can do to a distance from it
};

/// Only boxes along the axes are monotone under rounding from end to end. Elsewhere a tip and a
/// corner are turned, 4 roundings of the extent each, by axes that are not quite at right angles.
inline Tip tipAt(const Vector3d& point, const core::Box& organ) {
  constexpr double kSlack = 16.0 * 0.5 * std::numeric_limits<double>::epsilon();
  const Vector3d extent = (point - organ.low).cwiseAbs().cwiseMax((organ.high - point).cwiseAbs());
  return {point, kSlack * extent.norm()};
}

inline double squaredIfPositive(double distance) {
  return distance > 0.0 ? distance * distance : 0.0;
}

inline core::Box boxAround(const Corners3X& corners) {
  return {corners.rowwise().minCoeff(), corners.rowwise().maxCoeff()};
}

inline double bound(const core::Box& box, const Tip& tip) {
  const Vector3d gap = (box.low - tip.point).cwiseMax(tip.point - box.high).array() - tip.slack;
  return core::squaredLength(gap.cwiseMax(Vector3d::Zero()));
}

struct Ball {
  Vector3d centre;
  double radius;

  Ball(const Corners3X& corners, const Vector3d& around)
      : centre(around), radius((corners.colwise() - around).colwise().norm().maxCoeff()) {}
  double bound(const Tip& tip) const {
    return squaredIfPositive((tip.point - centre).norm() - radius - tip.slack);
  }
};

/// About the pole, which moves with the mesh: cheap to keep, as the spheres of J. Brown et al.,
/// "Real-time simulation of deformable objects" (2001).
struct PoleBall : Ball {
  PoleBall(const Corners3X& corners, const Set& set) : Ball(corners, set.pole) {}
};

/// Within some per cent of the smallest: the best that spheres can do (P. Hubbard, "Approximating
/// polyhedra with spheres for time-critical collision detection", 1996). Source: M. Bădoiu and K.
/// Clarkson, "Smaller core-sets for balls" (2003).
struct SmallBall : Ball {
  SmallBall(const Corners3X& corners, const Set&) : Ball(corners, middle(corners)) {}

  static Vector3d middle(const Corners3X& corners) {
    Vector3d centre = corners.col(0);
    for (int step = 2; step < 50; ++step) {
      Eigen::Index farthest = 0;
      (corners.colwise() - centre).colwise().squaredNorm().maxCoeff(&farthest);
      centre += (corners.col(farthest) - centre) / step;
    }
    return centre;
  }
};

/// What is behind the plane that is parallel to the poles' bisector and touches the set.
struct HalfSpace {
  Vector3d pole, outwards;  ///< [m]; unit, or zero where the poles coincide
  double offset;            ///< [m] of the plane from the pole

  HalfSpace(const Corners3X& corners, const Set& set)
      : pole(set.pole),
        outwards((set.other_pole - pole).stableNormalized()),
        offset((outwards.transpose() * (corners.colwise() - pole)).maxCoeff()) {}
  double bound(const Tip& tip) const {
    return squaredIfPositive(outwards.dot(tip.point - pole) - offset - tip.slack);
  }
};

/// Source: G. van den Bergen, "Efficient collision detection of complex deformable models using
/// AABB trees" (1997).
struct AlignedBox {
  core::Box box;

  AlignedBox(const Corners3X& corners, const Set&) : box(boxAround(corners)) {}
  double bound(const Tip& tip) const { return core::squaredDistance(box, tip.point); }
};

/// The principal axes of some corners, the flattest direction first.
struct Frame {
  Vector3d origin;
  Eigen::Matrix3d axes;  ///< in rows

  explicit Frame(const Corners3X& corners) : origin(corners.rowwise().mean()) {
    const Eigen::Matrix3Xd centred = corners.colwise() - origin;
    axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(centred * centred.transpose())
               .eigenvectors()
               .transpose();
  }
  Tip local(const Tip& tip) const { return {axes * (tip.point - origin), tip.slack}; }
  Eigen::Matrix3Xd local(const Corners3X& corners) const {
    return axes * (corners.colwise() - origin);
  }
};

/// Source: S. Gottschalk, M. Lin, D. Manocha, "OBBTree: a hierarchical structure for rapid
/// interference detection" (1996).
struct OrientedBox {
  Frame frame;
  core::Box box;

  OrientedBox(const Corners3X& corners, const Set&)
      : frame(corners), box(boxAround(frame.local(corners))) {}
  double bound(const Tip& tip) const { return bench::bound(box, frame.local(tip)); }
};

/// All that is within a radius of a rectangle across the flattest direction. Source: E. Larsen et
/// al., "Fast proximity queries with swept sphere volumes" (1999); but for corners that stick out
/// the radius grows, not the rectangle.
struct SweptRectangle {
  Frame frame;
  core::Box rectangle;
  double radius = 0.0;

  SweptRectangle(const Corners3X& corners, const Set&)
      : frame(corners), rectangle(boxAround(frame.local(corners))) {
    const Eigen::Matrix3Xd local = frame.local(corners);
    const double middle = 0.5 * (rectangle.low.x() + rectangle.high.x());
    const double half = rectangle.high.x() - middle;
    const Eigen::RowVectorXd height = local.row(0).array() - middle;
    const Eigen::RowVectorXd reach = (half * half - height.array().square()).max(0.0).sqrt();
    rectangle.low = (local.rowwise() + reach).rowwise().minCoeff();
    rectangle.high = (local.rowwise() - reach).rowwise().maxCoeff();
    const Vector3d centre = 0.5 * (rectangle.low + rectangle.high);
    rectangle.low = rectangle.low.cwiseMin(centre);
    rectangle.high = rectangle.high.cwiseMax(centre);
    rectangle.low.x() = rectangle.high.x() = middle;
    for (const auto corner : local.colwise())
      radius = std::max(radius, std::sqrt(core::squaredDistance(rectangle, corner)));
  }
  double bound(const Tip& tip) const {
    const double distance = std::sqrt(core::squaredDistance(rectangle, frame.local(tip).point));
    return squaredIfPositive(distance - radius - tip.slack);
  }
};

/// A volume for each set of a hierarchy.
template <class Volume>
class OneEach {
 public:
  explicit OneEach(const Hierarchy& hierarchy) {
    for (const Set& set : hierarchy.sets()) volumes_.emplace_back(hierarchy.corners(set), set);
  }
  /// The tip as the bounds of the set's children want it.
  const Tip& seenFrom(std::size_t /*set*/, const Tip& tip) const { return tip; }
  double bound(const Tip& tip, std::size_t set) const { return volumes_[set].bound(tip); }

 private:
  std::vector<Volume> volumes_;
};

/// A box for each set along the principal axes of its parent: one rotation for all children.
class BoxesInParentsFrame {
 public:
  explicit BoxesInParentsFrame(const Hierarchy& hierarchy) : boxes_(hierarchy.sets().size()) {
    for (const Set& set : hierarchy.sets()) {
      frames_.emplace_back(hierarchy.corners(set));
      for (std::size_t i = set.first_child; i < set.first_child + set.child_count; ++i)
        boxes_[i] = boxAround(frames_.back().local(hierarchy.corners(hierarchy.sets()[i])));
    }
  }
  Tip seenFrom(std::size_t set, const Tip& tip) const { return frames_[set].local(tip); }
  double bound(const Tip& tip, std::size_t set) const { return bench::bound(boxes_[set], tip); }

 private:
  std::vector<Frame> frames_;
  std::vector<core::Box> boxes_;
};

}  // namespace organ_collision::bench
