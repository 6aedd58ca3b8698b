#include "organ_collision/core/mesh_health.h"

#include <Eigen/Geometry>
#include <sstream>

#include "core/kernels/kernels.h"

namespace organ_collision::core {
namespace {

// Largest side of the box of an organ [m]; outside it a mesh is probably not in metres.
constexpr double kSmallestOrgan = 0.01;
constexpr double kLargestOrgan = 1.0;

std::size_t partedCorners(TriangleId triangle, const TriangleMesh& mesh,
                          const MeshTopology& topology) {
  std::size_t count = 0;
  for (const VertexId corner : mesh.corners(triangle))
    if (!topology.isAtWeld(corner, mesh)) ++count;
  return count;
}

}  // namespace

void HealthTally::add(const HealthTally& other) {
  degenerate_triangles += other.degenerate_triangles;
  volume += other.volume;
  rounding += other.rounding;
}

void HealthTally::subtract(const HealthTally& other) {
  degenerate_triangles -= other.degenerate_triangles;
  volume -= other.volume;
  rounding -= other.rounding;
}

double volumeOf(const TriangleMesh& mesh, const UnitFrame& frame) {
  double volume = 0.0;
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const Triangle triangle = mesh.triangle(static_cast<TriangleId>(i));
    // By edges: of a part that is small against its distance from the centre, products of places
    // would leave nothing.
    const Eigen::Vector3d a = frame(triangle.a);
    volume += a.dot((frame(triangle.b) - a).cross(frame(triangle.c) - a));
  }
  return volume;
}

std::size_t partedCorners(const TriangleMesh& mesh, const MeshTopology& topology) {
  if (!topology.hasWelds()) return 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i)
    count += partedCorners(static_cast<TriangleId>(i), mesh, topology);
  return count;
}

std::size_t partedCorners(const std::vector<TriangleId>& triangles, const TriangleMesh& mesh,
                          const MeshTopology& topology) {
  std::size_t count = 0;
  for (const TriangleId triangle : triangles) count += partedCorners(triangle, mesh, topology);
  return count;
}

Box boxOf(const TriangleMesh& mesh) {
  if (mesh.usesAllVertices()) {
    const Points& points = mesh.positions();
    const PlainBox box = boxOfPoints(points.front().data(), points.size());
    return {Eigen::Vector3d(box.low.data()), Eigen::Vector3d(box.high.data())};
  }
  Box box;
  for (const Corners& corners : mesh.triangles())
    for (const VertexId corner : corners) box.add(mesh.position(corner));
  return box;
}

MeshHealth healthOf(const MeshTopology& topology, const Box& box, const HealthTally& tally,
                    std::size_t parted_corners) {
  MeshHealth health = {topology.closed() && parted_corners == 0,
                       topology.consistentlyWound(),
                       false,
                       tally.degenerate_triangles,
                       topology.duplicateTriangles(),
                       box};
  health.inverted = health.isSolid() && tally.volume < 0.0;
  return health;
}

std::vector<std::string> warnings(const MeshHealth& health) {
  std::vector<std::string> sentences;
  const auto add = [&sentences](auto&&... parts) {
    std::ostringstream sentence;
    (sentence << ... << parts);
    sentences.push_back(sentence.str());
  };
  const double side = (health.box.high - health.box.low).maxCoeff();
  if (side > kLargestOrgan)
    add("the largest side is ", side,
        " m: millimetres? a file's become metres by scale: 0.001, an update's are metres");
  if (side < kSmallestOrgan)
    add("the largest side is ", side, " m: small for an organ; is the scale right?");
  if (!health.closed) add("the surface is not closed: distances carry no sign");
  if (!health.consistently_wound)
    add("neighbouring triangles are wound in different senses: distances carry no sign");
  if (health.inverted) add("the triangles' normals point inwards: the mesh is read inside out");
  if (health.degenerate_triangles > 0) add(health.degenerate_triangles, " triangles have no area");
  if (health.duplicate_triangles > 0)
    add(health.duplicate_triangles, " triangles have the same corners as an earlier one");
  return sentences;
}

}  // namespace organ_collision::core
