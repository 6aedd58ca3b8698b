#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <utility>

#include "brute_force.h"
#include "inspect.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/sign.h"
#include "test_meshes.h"

// How tests deform an organ, and what they ask of it afterwards.
namespace organ_collision::test {

/// Some vertices, all if none is named, and where they go [m].
struct Deformation {
  /// Bending space bends the surface with it; folding may let it touch or cut itself.
  enum class Kind { kBend, kFold, kRestore };

  Kind kind;
  std::vector<VertexId> vertices;
  Points positions;

  void apply(Points& points) const {
    if (vertices.empty()) points = positions;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      points[core::index(vertices[i])] = positions[i];
  }
};

inline core::Box boxAround(const Points& points) {
  core::Box box;
  for (const Eigen::Vector3d& point : points) box.add(point);
  return box;
}

inline double uniform(std::mt19937& generator, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(generator);
}

/// `move` applied to every point, seen from the middle, with an axis and an amount in [-1, 1].
template <class Move>
Points movedWhole(std::mt19937& generator, Points points, const Move& move) {
  const core::Box box = boxAround(points);
  const Eigen::Vector3d middle = 0.5 * (box.low + box.high);
  const int axis = static_cast<int>(generator() % 3);
  const double amount = uniform(generator, -1.0, 1.0);
  for (Eigen::Vector3d& point : points) point = middle + move(point - middle, axis, amount);
  return points;
}

inline Eigen::Vector3d twisted(const Eigen::Vector3d& point, int axis, double amount) {
  const Eigen::AngleAxisd turn(10.0 * amount * point[axis], Eigen::Vector3d::Unit(axis));
  return turn * point;
}

inline Eigen::Vector3d stretched(Eigen::Vector3d point, int axis, double amount) {
  point[axis] *= std::exp(amount);
  return point;
}

inline Eigen::Vector3d scaled(const Eigen::Vector3d& point, int, double amount) {
  return std::exp(amount) * point;
}

inline Eigen::Vector3d collapsed(Eigen::Vector3d point, int axis, double) {
  point[axis] = 0.0;
  return point;
}

/// The vertices around one of them, pushed by a tip that presses into the organ.
inline Deformation poked(std::mt19937& generator, const Points& points) {
  const core::Box box = boxAround(points);
  const double size = (box.high - box.low).maxCoeff();
  const Eigen::Vector3d tip = points[generator() % points.size()];
  const double reach = size * uniform(generator, 0.02, 0.2);
  const Eigen::Vector3d push = randomPoint(generator, 0.5 * reach);
  Deformation result = {Deformation::Kind::kBend, {}, {}};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double depth = 1.0 - (points[i] - tip).norm() / reach;
    if (depth <= 0.0) continue;
    result.vertices.push_back(static_cast<VertexId>(i));
    result.positions.emplace_back(points[i] + depth * push);
  }
  return result;
}

/// Some vertices, each by a way of its own: what was welded parts.
inline Deformation scattered(std::mt19937& generator, const Points& points) {
  const core::Box box = boxAround(points);
  const double reach = 0.05 * (box.high - box.low).maxCoeff();
  Deformation result = {Deformation::Kind::kFold, {}, {}};
  for (std::size_t i = generator() % points.size(); i < points.size();
       i += 1 + generator() % points.size()) {
    result.vertices.push_back(static_cast<VertexId>(i));
    result.positions.emplace_back(points[i] + randomPoint(generator, reach));
  }
  return result;
}

/// Any of these, or back to the `original`, as always from a single point.
inline Deformation randomDeformation(std::mt19937& generator, const Points& original,
                                     const Points& points) {
  using Kind = Deformation::Kind;
  const core::Box box = boxAround(points);
  switch (box.low == box.high ? 0 : generator() % 10) {
    case 0:
    case 1:
      return {Kind::kRestore, {}, original};
    case 2:
      return {Kind::kBend, {}, movedWhole(generator, points, twisted)};
    case 3:
      return {Kind::kBend, {}, movedWhole(generator, points, stretched)};
    case 4:
      return {Kind::kBend, {}, movedWhole(generator, points, scaled)};
    case 5:
      return {Kind::kFold, {}, movedWhole(generator, points, collapsed)};
    case 6:
      return scattered(generator, points);
    default:
      return poked(generator, points);
  }
}

/// Four times pi times how often the surface winds around `point`. Source: A. van Oosterom and J.
/// Strackee, "The solid angle of a plane triangle" (1983).
inline double solidAngle(const TriangleMesh& mesh, const Eigen::Vector3d& point) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const core::Triangle triangle = mesh.triangle(static_cast<core::TriangleId>(i));
    const Eigen::Vector3d a = triangle.a - point;
    const Eigen::Vector3d b = triangle.b - point;
    const Eigen::Vector3d c = triangle.c - point;
    const double u = a.norm();
    const double v = b.norm();
    const double w = c.norm();
    sum +=
        2.0 * std::atan2(a.dot(b.cross(c)), u * v * w + a.dot(b) * w + b.dot(c) * u + c.dot(a) * v);
  }
  return sum;
}

/// Nearer to the surface than this part of the organ's size, rounding turns the solid angle.
constexpr double kOnTheSurface = 1e-9;

/// The distance is that of brute force bit for bit, and the sign is claimed for solids.
inline void expectBruteForce(const core::CollisionMesh& organ, const Eigen::Vector3d& tip) {
  const core::NearestTriangle nearest = core::nearestTriangle(organ, tip);
  ASSERT_EQ(std::abs(nearest.distance), std::sqrt(squaredDistanceByBruteForce(organ.mesh(), tip)));
  ASSERT_EQ(nearest.distance_signed, organ.health().isSolid());
}

/// The sign says whether the surface winds around the tip. REQUIRES: the surface does not cut
/// itself.
inline void expectTrueSign(const core::CollisionMesh& organ, const Eigen::Vector3d& tip) {
  const core::NearestTriangle nearest = core::nearestTriangle(organ, tip);
  const core::Box& box = organ.health().box;
  const double size = (box.high - box.low).maxCoeff();
  if (!nearest.distance_signed || std::abs(nearest.distance) < kOnTheSurface * size) return;
  const bool inside = std::lround(solidAngle(organ.mesh(), tip) / (4.0 * M_PI)) != 0;
  ASSERT_EQ(std::signbit(nearest.distance), inside)
      << "at " << tip.transpose() << ", " << nearest.distance << " m from the surface";
}

/// What the organ says of itself is what an inspection of its triangles says.
inline void expectTrueHealth(const core::CollisionMesh& organ) {
  const core::MeshHealth truth = inspect(organ.mesh(), organ.topology());
  ASSERT_EQ(organ.health().box.low, truth.box.low);
  ASSERT_EQ(organ.health().box.high, truth.box.high);
  ASSERT_EQ(organ.health().closed, truth.closed);
  ASSERT_EQ(organ.health().degenerate_triangles, truth.degenerate_triangles);
}

/// A tip near the surface, around the organ or farther away.
inline Eigen::Vector3d tipAround(std::mt19937& generator, const core::CollisionMesh& organ) {
  const core::Box& box = organ.health().box;
  const double reach = std::pow(10.0, uniform(generator, -3.0, 0.0));
  const Points& points = organ.mesh().positions();
  return points[generator() % points.size()] +
         randomPoint(generator, reach * (box.high - box.low).maxCoeff());
}

}  // namespace organ_collision::test
