// FCL: OBBRSS volumes, which it names for distances; a tip is a sphere of radius 0.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <memory>
#include <vector>

#include "peers.h"

namespace organ_collision::bench {
namespace {

using core::Triangle;
using core::TriangleMesh;
using Eigen::Vector3d;

using Model = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<Model> modelOf(const TriangleMesh& mesh) {
  std::vector<fcl::Triangle> triangles;
  for (const core::Corners& corners : mesh.triangles())
    triangles.emplace_back(index(corners[0]), index(corners[1]), index(corners[2]));
  auto model = std::make_shared<Model>();
  model->beginModel();
  model->addSubModel(mesh.positions(), triangles);
  model->endModel();
  return model;
}

Organ organ(const TriangleMesh& mesh) {
  return [model = modelOf(mesh)](const Vector3d& tip) {
    const fcl::Sphered point(0.0);
    fcl::Transform3d pose = fcl::Transform3d::Identity();
    pose.translation() = tip;
    fcl::DistanceResultd result;
    return notNegative(fcl::distance(model.get(), fcl::Transform3d::Identity(), &point, pose,
                                     fcl::DistanceRequestd(), result));
  };
}

double distance(const Triangle& first, const Triangle& second) {
  const fcl::Transform3d pose = fcl::Transform3d::Identity();
  fcl::DistanceResultd result;
  return notNegative(fcl::distance(modelOf(meshOf(first)).get(), pose,
                                   modelOf(meshOf(second)).get(), pose, fcl::DistanceRequestd(),
                                   result));
}

bool intersect(const Triangle& first, const Triangle& second) {
  const fcl::Transform3d pose = fcl::Transform3d::Identity();
  fcl::CollisionResultd result;
  return fcl::collide(modelOf(meshOf(first)).get(), pose, modelOf(meshOf(second)).get(), pose,
                      fcl::CollisionRequestd(), result) > 0;
}

}  // namespace

Peer fclPeer() { return {"FCL", organ, distance, intersect}; }

}  // namespace organ_collision::bench
