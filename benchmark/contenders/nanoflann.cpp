// nanoflann's k-d tree over the triangles' centroids: approximate, for the triangle with the
// nearest centroid need not be the nearest one.
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <utility>

#include "contender.h"
#include "organ_collision/core/closest_point.h"

namespace organ_collision::bench {
namespace {

/// The form in which nanoflann reads points.
struct Centroids {
  explicit Centroids(const core::TriangleMesh& mesh) {
    for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
      triangles.push_back(mesh.triangle(static_cast<core::TriangleId>(i)));
      points.push_back(core::centroid(triangles.back()));
    }
  }
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }

  std::vector<core::Triangle> triangles;
  core::Points points;
};

class Nanoflann : public Contender {
 public:
  explicit Nanoflann(const core::TriangleMesh& mesh)
      : centroids_(mesh), tree_(3, centroids_, nanoflann::KDTreeSingleIndexAdaptorParams()) {
    tree_.buildIndex();
  }

  void answer(const core::Points& tips, std::vector<double>& distances) override {
    distances.clear();
    for (const Eigen::Vector3d& tip : tips) {
      std::uint32_t nearest = 0;
      double squared_distance = 0.0;
      tree_.knnSearch(tip.data(), 1, &nearest, &squared_distance);
      const core::Triangle& triangle = centroids_.triangles[nearest];
      distances.push_back(std::sqrt(core::closestPointOnTriangle(tip, triangle).squared_distance));
    }
  }

 private:
  using Metric = nanoflann::L2_Simple_Adaptor<double, Centroids>;

  Centroids centroids_;
  nanoflann::KDTreeSingleIndexAdaptor<Metric, Centroids, 3, std::uint32_t> tree_;
};

}  // namespace

std::vector<Entrant> nanoflannEntrants(const core::TriangleMesh& mesh) {
  return {{"nanoflann on centroids",
           {Task::kPoints, Task::kPath},
           std::nullopt,
           kAll,
           std::make_shared<Nanoflann>(mesh)}};
}

}  // namespace organ_collision::bench
