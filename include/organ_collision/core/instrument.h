#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "organ_collision/core/box.h"
#include "organ_collision/core/collision_mesh.h"

namespace organ_collision::core {

/// All points within `radius` of `centre`.
struct Sphere {
  Eigen::Vector3d centre;  ///< [m]
  double radius;           ///< [m] >= 0
};

/// All points within `radius` of the segment, a shaft say.
struct Capsule {
  Eigen::Vector3d start, end;  ///< [m] of the segment; may coincide
  double radius;               ///< [m] >= 0
};

/// A pose that is kept. Not aligned, as how is another matter for each vector unit: a program that
/// is translated for a wider one than this library shares it, too.
using Pose = Eigen::Transform<double, 3, Eigen::Isometry, Eigen::DontAlign>;

/// A surface, of a jaw say, that is solid where it is closed and wound. It is shared, not copied,
/// wherever it goes.
struct RigidMesh {
  std::shared_ptr<const CollisionMesh> surface;
  Pose pose;            ///< frame_from_surface
  bool convex = false;  ///< the node takes its convex hull, against others that are convex or
                        ///< round; proximity() does not
};

/// A piece of an instrument: a point, a triangle as in the paper, a sphere, a capsule or a mesh,
/// all in one frame [m].
using Shape = std::variant<Eigen::Vector3d, Triangle, Sphere, Capsule, RigidMesh>;

/// An instrument is the union of its pieces: one or more.
using Shapes = std::vector<Shape>;

/// The shape in another frame.
Shape transformed(const Shape& shape, const Eigen::Isometry3d& target_from_shape);

/// The box around the shape [m], but for rounding; of a mesh, the box around its turned box.
/// REQUIRES: as requireUsable().
Box boxOf(const Shape& shape);

/// The box around all of them, moved.
Box boxOf(const Shapes& shapes, const Eigen::Isometry3d& target_from_shapes);

/// Throws std::invalid_argument unless all coordinates are usable (see requireUsable() of a
/// position), the radius is finite and >= 0, and a mesh has a surface and a rigid pose.
void requireUsable(const Shape& shape);

/// A shape that is all points within `radius` of its core.
struct RoundShape {
  Triangle core;  ///< [m] of zero area where it is a point {a, a, a} or a segment {a, b, b}
  double radius;  ///< [m]
};

/// Nothing for a mesh.
std::optional<RoundShape> roundShape(const Shape& shape);

}  // namespace organ_collision::core
