// FCL with OBBRSS volumes, which its documentation names for distance queries. A tip is a sphere
// of radius 0. Refitted top down: bottom up, its default, FCL 0.7 gives wrong distances.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/distance.h>

#include "contender.h"

namespace organ_collision::bench {
namespace {

// 1.3 kB a triangle, and slower than all others: left out where the organ is larger.
constexpr std::size_t kMostTriangles = 150'000;
constexpr std::size_t kMostTips = 500;

// FCL's narrow phase works with absolute tolerances.
constexpr double kTolerance = 1e-6;

using Model = fcl::BVHModel<fcl::OBBRSSd>;

class Fcl : public Contender, public Follower {
 public:
  explicit Fcl(const core::TriangleMesh& mesh)
      : positions_(mesh.positions()), model_(std::make_shared<Model>()) {
    std::vector<fcl::Triangle> triangles;
    triangles.reserve(mesh.triangleCount());
    for (const core::Corners& corners : mesh.triangles())
      triangles.emplace_back(index(corners[0]), index(corners[1]), index(corners[2]));
    model_->beginModel(static_cast<int>(triangles.size()), static_cast<int>(positions_.size()));
    model_->addSubModel(positions_, triangles);
    model_->endModel();
  }

  void answer(const core::Points& tips, std::vector<double>& distances) override {
    const fcl::Sphered point(0.0);
    const fcl::Transform3d organ_pose = fcl::Transform3d::Identity();
    fcl::Transform3d tip_pose = fcl::Transform3d::Identity();
    const fcl::DistanceRequestd request;
    distances.clear();
    for (const Eigen::Vector3d& tip : tips) {
      tip_pose.translation() = tip;
      fcl::DistanceResultd result;
      distances.push_back(
          fcl::distance(model_.get(), organ_pose, &point, tip_pose, request, result));
    }
  }

  void prepare(const core::Points& positions) override { positions_ = positions; }
  void follow() override {
    constexpr bool kRefit = true;
    constexpr bool kBottomUp = false;
    model_->beginReplaceModel();
    model_->replaceSubModel(positions_);
    model_->endReplaceModel(kRefit, kBottomUp);
  }
  Contender& contender() override { return *this; }

 private:
  core::Points positions_;
  std::shared_ptr<Model> model_;
};

}  // namespace

std::vector<Entrant> fclEntrants(const core::TriangleMesh& mesh) {
  if (mesh.triangleCount() > kMostTriangles) return {};
  return {{"FCL OBBRSS",
           {Task::kPoints, Task::kPath},
           kTolerance,
           kMostTips,
           std::make_shared<Fcl>(mesh)}};
}

std::vector<Method> fclMethods() {
  return {{"FCL OBBRSS, top down", kTolerance, Follows::kAllVertices, kMostTriangles,
           [](const core::TriangleMesh& mesh, const std::vector<core::VertexId>& /*moved*/) {
             return std::make_unique<Fcl>(mesh);
           }}};
}

}  // namespace organ_collision::bench
