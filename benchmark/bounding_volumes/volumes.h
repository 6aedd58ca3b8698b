#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "hierarchy.h"
#include "organ_collision/core/box.h"

// Volumes around sets of triangles. Each is convex, so it holds the triangles if it holds their
// corners, and each bounds the squared distance [m^2] from a tip to all that it holds from below.
namespace organ_collision::bench {

using Corners3X = Eigen::Ref<const Eigen::Matrix3Xd>;  // [m], in columns
using Eigen::Vector3d;

/// A point, and how far [m] rounding can move a computed distance from it.
struct Tip {
  Vector3d point;
  double slack;
};

/// Rounding of a distance that is not, as the boxes' is, monotone from end to end: up to 4
/// roundings to turn a corner, as many to turn the tip, and axes that are not quite at right
/// angles.
constexpr double kSlack = 16.0 * 0.5 * std::numeric_limits<double>::epsilon();

inline Tip tipAt(const Vector3d& point, const core::Box& organ) {
  return {point,
          kSlack * (point - organ.low).cwiseAbs().cwiseMax((organ.high - point).cwiseAbs()).norm()};
}

inline double squared(double value) { return value * value; }
inline double squaredUnlessNegative(double value) { return squared(std::max(value, 0.0)); }

inline core::Box boxOf(const Corners3X& corners) {
  return {corners.rowwise().minCoeff(), corners.rowwise().maxCoeff()};
}

struct Ball {
  Vector3d centre;
  double radius;

  Ball(const Vector3d& around, const Corners3X& corners)
      : centre(around),
        radius(std::sqrt((corners.colwise() - around).colwise().squaredNorm().maxCoeff())) {}
  double bound(const Tip& tip) const {
    return squaredUnlessNegative((tip.point - centre).norm() - radius - tip.slack);
  }
};

/// Around the set's pole, which the tree has anyway. Like the spheres of J. Brown et al.,
/// "Real-time simulation of deformable objects" (2001), easy to keep up with what moves.
struct PoleBall : Ball {
  PoleBall(const Corners3X& corners, const Set& set) : Ball(set.pole, corners) {}
};

/// Within some per cent of the smallest, the best case of P. Hubbard, "Approximating polyhedra with
/// spheres for time-critical collision detection" (1996). Source: M. Bădoiu and K. Clarkson,
/// "Smaller core-sets for balls" (2003).
struct SmallBall : Ball {
  SmallBall(const Corners3X& corners, const Set&) : Ball(middle(corners), corners) {}

 private:
  static Vector3d middle(const Corners3X& corners) {
    constexpr int kPasses = 50;
    const core::Box box = boxOf(corners);
    Vector3d centre = 0.5 * (box.low + box.high);
    for (int pass = 2; pass < kPasses + 2; ++pass) {
      Eigen::Index farthest = 0;
      (corners.colwise() - centre).colwise().squaredNorm().maxCoeff(&farthest);
      centre += (corners.col(farthest) - centre) / pass;
    }
    return centre;
  }
};

/// What lies on one side of a plane that is parallel to the poles' bisector and touches the set.
struct BisectorHalfSpace {
  Vector3d pole;
  Vector3d outwards;  ///< unit; zero where the poles coincide
  double offset;      ///< [m] of the plane from the pole

  BisectorHalfSpace(const Corners3X& corners, const Set& set)
      : pole(set.pole),
        outwards((set.other_pole - set.pole).stableNormalized()),
        offset((outwards.transpose() * (corners.colwise() - pole)).maxCoeff()) {}
  double bound(const Tip& tip) const {
    return squaredUnlessNegative(outwards.dot(tip.point - pole) - offset - tip.slack);
  }
};

/// Source: G. van den Bergen, "Efficient collision detection of complex deformable models using
/// AABB trees" (1997).
struct AxisAlignedBox {
  core::Box box;

  AxisAlignedBox(const Corners3X& corners, const Set&) : box(boxOf(corners)) {}
  double bound(const Tip& tip) const { return core::squaredDistance(box, tip.point); }
};

/// The principal axes of some corners, the flattest direction first.
struct Frame {
  Vector3d origin;
  Eigen::Matrix3d axes;  ///< in rows

  explicit Frame(const Corners3X& corners) : origin(corners.rowwise().mean()) {
    const Eigen::Matrix3Xd centred = corners.colwise() - origin;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(centred * centred.transpose());
    axes = solver.eigenvectors().transpose();
  }
  Vector3d local(const Vector3d& point) const { return axes * (point - origin); }
  Eigen::Matrix3Xd allLocal(const Corners3X& corners) const {
    return axes * (corners.colwise() - origin);
  }
};

inline double squaredDistance(const core::Box& box, const Vector3d& point, double slack) {
  const Vector3d gap = (box.low - point).cwiseMax(point - box.high).array() - slack;
  return core::squaredLength(gap.cwiseMax(Vector3d::Zero()));
}

/// Source: S. Gottschalk, M. Lin, D. Manocha, "OBBTree: a hierarchical structure for rapid
/// interference detection" (1996).
struct OrientedBox {
  Frame frame;
  core::Box box;

  OrientedBox(const Corners3X& corners, const Set&)
      : frame(corners), box(boxOf(frame.allLocal(corners))) {}
  double bound(const Tip& tip) const {
    return squaredDistance(box, frame.local(tip.point), tip.slack);
  }
};

/// All that is within a radius of a rectangle across the flattest direction. Source: E. Larsen et
/// al., "Fast proximity queries with swept sphere volumes" (1999); here corners that stick out make
/// the radius larger, not the rectangle.
struct SweptRectangle {
  Frame frame;
  core::Box rectangle;
  double radius;

  SweptRectangle(const Corners3X& corners, const Set&) : frame(corners) {
    const Eigen::Matrix3Xd local = frame.allLocal(corners);
    rectangle = boxOf(local);
    const double height = 0.5 * (rectangle.low.x() + rectangle.high.x());
    const double half = 0.5 * (rectangle.high.x() - rectangle.low.x());
    const Eigen::ArrayXXd reach =
        (squared(half) - (local.row(0).array() - height).square()).max(0.0).sqrt();
    rectangle.low.x() = rectangle.high.x() = height;
    for (const int side : {1, 2}) {
      double& low = rectangle.low[side];
      double& high = rectangle.high[side];
      low = (local.row(side).array() + reach).minCoeff();
      high = (local.row(side).array() - reach).maxCoeff();
      if (low > high) low = high = 0.5 * (low + high);
    }
    radius = 0.0;
    for (const auto corner : local.colwise())
      radius = std::max(radius, std::sqrt(core::squaredDistance(rectangle, corner)));
  }
  double bound(const Tip& tip) const {
    const double distance = std::sqrt(core::squaredDistance(rectangle, frame.local(tip.point)));
    return squaredUnlessNegative(distance - radius - tip.slack);
  }
};

/// A volume for each set of a hierarchy.
template <class Volume>
class OneEach {
 public:
  static constexpr std::size_t kBytesPerSet = sizeof(Volume);

  explicit OneEach(const Hierarchy& hierarchy) {
    for (const Set& set : hierarchy.sets()) volumes_.emplace_back(hierarchy.corners(set), set);
  }
  /// The tip as the bounds of the set's children want it.
  const Tip& seenFrom(std::size_t, const Tip& tip) const { return tip; }
  double bound(const Tip& tip, std::size_t set) const { return volumes_[set].bound(tip); }

 private:
  std::vector<Volume> volumes_;
};

/// A box for each set, along the principal axes of its parent: one rotation for all children.
class BoxesInParentsFrame {
 public:
  static constexpr std::size_t kBytesPerSet = sizeof(core::Box);  // and a frame per 8

  explicit BoxesInParentsFrame(const Hierarchy& hierarchy) : boxes_(hierarchy.sets().size()) {
    for (const Set& set : hierarchy.sets()) {
      frames_.emplace_back(hierarchy.corners(set));
      for (std::size_t i = 0; i < set.child_count; ++i) {
        const std::size_t child = set.first_child + i;
        boxes_[child] = boxOf(frames_.back().allLocal(hierarchy.corners(hierarchy.sets()[child])));
      }
    }
  }
  Tip seenFrom(std::size_t set, const Tip& tip) const {
    return {frames_[set].local(tip.point), tip.slack};
  }
  double bound(const Tip& local, std::size_t set) const {
    return squaredDistance(boxes_[set], local.point, local.slack);
  }

 private:
  std::vector<Frame> frames_;
  std::vector<core::Box> boxes_;
};

}  // namespace organ_collision::bench
