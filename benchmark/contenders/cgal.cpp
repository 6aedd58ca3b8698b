// CGAL's AABB tree, as its manual advises for speed: Cartesian doubles, and a reference search
// tree for distance queries.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <limits>
#include <utility>

#include "contender.h"

namespace organ_collision::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 toCgal(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }

/// The tree, with the triangles that it points into.
struct Structure {
  explicit Structure(const core::TriangleMesh& mesh) {
    for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
      const core::Triangle triangle = mesh.triangle(static_cast<core::TriangleId>(i));
      triangles.emplace_back(toCgal(triangle.a), toCgal(triangle.b), toCgal(triangle.c));
    }
    tree.insert(triangles.begin(), triangles.end());
    tree.build();
    tree.accelerate_distance_queries();
  }
  Triangles triangles;
  Tree tree;
};

class OneByOne : public Contender {
 public:
  explicit OneByOne(std::shared_ptr<const Structure> structure)
      : structure_(std::move(structure)) {}
  void answer(const core::Points& tips, std::vector<double>& distances) override {
    distances.clear();
    for (const Eigen::Vector3d& tip : tips)
      distances.push_back(std::sqrt(structure_->tree.squared_distance(toCgal(tip))));
  }

 private:
  std::shared_ptr<const Structure> structure_;
};

/// Gives the previous answer as a hint.
class FromPrevious : public Contender {
 public:
  explicit FromPrevious(std::shared_ptr<const Structure> structure)
      : structure_(std::move(structure)) {}
  void answer(const core::Points& tips, std::vector<double>& distances) override {
    const Tree& tree = structure_->tree;
    distances.clear();
    Tree::Point_and_primitive_id previous(structure_->triangles.front().vertex(0),
                                          structure_->triangles.begin());
    for (const Eigen::Vector3d& tip : tips) {
      const Kernel::Point_3 point = toCgal(tip);
      previous = tree.closest_point_and_primitive(point, previous);
      distances.push_back(std::sqrt(CGAL::squared_distance(point, previous.first)));
    }
  }

 private:
  std::shared_ptr<const Structure> structure_;
};

class Static : public Follower {
 public:
  explicit Static(const core::TriangleMesh& mesh)
      : contender_(std::make_shared<const Structure>(mesh)) {}
  Contender& contender() override { return contender_; }

 private:
  OneByOne contender_;
};

}  // namespace

std::vector<Entrant> cgalEntrants(const core::TriangleMesh& mesh) {
  const auto structure = std::make_shared<const Structure>(mesh);
  return {{"CGAL",
           {Task::kPoints, Task::kPath},
           kDoubleTolerance,
           kAll,
           std::make_shared<OneByOne>(structure)},
          {"CGAL, previous known",
           {Task::kPath},
           kDoubleTolerance,
           kAll,
           std::make_shared<FromPrevious>(structure)}};
}

std::vector<Method> cgalMethods() {
  return {{"CGAL", kDoubleTolerance, Follows::kNothing, kAll,
           [](const core::TriangleMesh& mesh, const std::vector<core::VertexId>& /*moved*/) {
             return std::make_unique<Static>(mesh);
           }}};
}

}  // namespace organ_collision::bench
