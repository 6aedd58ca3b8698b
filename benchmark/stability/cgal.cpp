// CGAL: the kernel that its manual recommends where predicates must be right.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <cmath>
#include <memory>
#include <vector>

#include "peers.h"

namespace organ_collision::bench {
namespace {

using core::Triangle;
using core::TriangleId;
using core::TriangleMesh;
using Eigen::Vector3d;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 toCgal(const Vector3d& point) { return {point.x(), point.y(), point.z()}; }
Kernel::Triangle_3 toCgal(const Triangle& t) { return {toCgal(t.a), toCgal(t.b), toCgal(t.c)}; }

/// The tree, with the triangles that it points into.
struct Structure {
  explicit Structure(const TriangleMesh& mesh) {
    for (std::size_t i = 0; i < mesh.triangleCount(); ++i)
      triangles.push_back(toCgal(mesh.triangle(static_cast<TriangleId>(i))));
    tree.insert(triangles.begin(), triangles.end());
    tree.build();
  }
  Triangles triangles;
  Tree tree;
};

Organ organ(const TriangleMesh& mesh) {
  const auto structure = std::make_shared<Structure>(mesh);
  return [structure](const Vector3d& tip) {
    return std::sqrt(structure->tree.squared_distance(toCgal(tip)));
  };
}

}  // namespace

Peer cgalPeer() {
  CGAL::set_error_behaviour(CGAL::THROW_EXCEPTION);
  return {"CGAL", organ,
          [](const Triangle& first, const Triangle& second) {
            return std::sqrt(CGAL::squared_distance(toCgal(first), toCgal(second)));
          },
          [](const Triangle& first, const Triangle& second) {
            return CGAL::do_intersect(toCgal(first), toCgal(second));
          }};
}

}  // namespace organ_collision::bench
