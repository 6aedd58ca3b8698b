#include "organ_collision/core/mesh_health.h"

#include <Eigen/Geometry>
#include <sstream>

#include "organ_collision/core/predicates.h"

namespace organ_collision::core {
namespace {

// Largest side of the box of an organ [m]; outside it a mesh is probably not in metres.
constexpr double kSmallestOrgan = 0.01;
constexpr double kLargestOrgan = 1.0;

/// Six times the enclosed volume of a closed mesh, in units of the box's largest side cubed, so
/// that nothing overflows.
double relativeVolume(const TriangleMesh& mesh, const Box& box) {
  const double side = (box.high - box.low).maxCoeff();
  if (side == 0.0) return 0.0;
  double volume = 0.0;
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const Triangle triangle = mesh.triangle(static_cast<TriangleId>(i));
    const Eigen::Vector3d a = (triangle.a - box.low) / side;
    const Eigen::Vector3d b = (triangle.b - box.low) / side;
    const Eigen::Vector3d c = (triangle.c - box.low) / side;
    volume += a.dot(b.cross(c));
  }
  return volume;
}

}  // namespace

MeshHealth inspect(const TriangleMesh& mesh, const MeshTopology& topology) {
  MeshHealth health = {topology.closed() && topology.weldsHold(mesh),
                       topology.consistentlyWound(),
                       false,
                       0,
                       topology.duplicateTriangles(),
                       Box()};
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const Triangle triangle = mesh.triangle(static_cast<TriangleId>(i));
    health.box.add(boxOf(triangle));
    if (collinear(triangle.a, triangle.b, triangle.c)) ++health.degenerate_triangles;
  }
  health.inverted = health.isSolid() && relativeVolume(mesh, health.box) < 0.0;
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
    add("the largest side is ", side, " m: millimetres? then set the organ's scale to 0.001");
  if (side < kSmallestOrgan)
    add("the largest side is ", side, " m: small for an organ; is the scale right?");
  if (!health.closed) add("the surface is not closed: distances carry no sign");
  if (!health.consistently_wound)
    add("neighbouring triangles are wound in different senses: distances carry no sign");
  if (health.inverted) add("the triangles' normals point inwards: the mesh is read inside out");
  if (health.degenerate_triangles > 0) add(health.degenerate_triangles, " triangles have no area");
  if (health.duplicate_triangles > 0)
    add(health.duplicate_triangles, " triangles are there more than once");
  return sentences;
}

}  // namespace organ_collision::core
