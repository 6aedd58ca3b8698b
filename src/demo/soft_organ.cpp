#include "soft_organ.h"

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cassert>
#include <stdexcept>
#include <string>
#include <utility>

namespace organ_collision::demo {
namespace {

constexpr double kUnit = 0.01;         // [m] of Bullet here: it is made for things of some units
constexpr double kShaft = 0.1;         // [m] length of what presses; longer than any dent is deep
constexpr double kMargin = 0.0005;     // [m] that the organ keeps from what presses
constexpr double kVoxel = 0.001;       // [m] of the field of distances from what presses
constexpr double kTowardsRest = 0.01;  // of the way, in each step: back within 2 s
constexpr double kDamping = 0.2;       // of the velocity, in each step: it does not wobble
constexpr double kStiffness = 1.0;     // of edges: a dent takes its surroundings along
constexpr int kIterations = 4;         // over the edges, in each step; more: wider dents

constexpr btScalar inUnits(double metres) { return static_cast<btScalar>(metres / kUnit); }

btVector3 toBullet(const Eigen::Vector3d& point) {
  return {inUnits(point.x()), inUnits(point.y()), inUnits(point.z())};
}

Eigen::Vector3d fromBullet(const btVector3& point) {
  return kUnit * Eigen::Vector3d(point.x(), point.y(), point.z());
}

/// Of a capsule along z whose front end is kBite behind the tip.
btTransform capsulePose(const Eigen::Isometry3d& organ_from_tip) {
  constexpr double kTipToMiddle = SoftOrgan::kBite + SoftOrgan::kRadius + 0.5 * kShaft;
  const Eigen::Matrix<btScalar, 3, 3> turn = organ_from_tip.linear().cast<btScalar>();
  return btTransform(btMatrix3x3(turn(0, 0), turn(0, 1), turn(0, 2),  //
                                 turn(1, 0), turn(1, 1), turn(1, 2),  //
                                 turn(2, 0), turn(2, 1), turn(2, 2)),
                     toBullet(organ_from_tip * Eigen::Vector3d(0.0, 0.0, -kTipToMiddle)));
}

void requireAFew(const core::TriangleMesh& mesh) {
  const std::size_t count = mesh.positions().size();
  if (count <= SoftOrgan::kMostVertices) return;
  throw std::invalid_argument("the mesh has " + std::to_string(count) + " vertices, but at most " +
                              std::to_string(SoftOrgan::kMostVertices) + " can be simulated");
}

/// Bullet makes vertices up to the last one that is in a triangle, and moves every one.
void requireUse(const core::TriangleMesh& mesh) {
  std::vector<bool> is_used(mesh.positions().size(), false);
  for (const core::Corners& triangle : mesh.triangles()) {
    for (const core::VertexId corner : triangle) is_used[core::index(corner)] = true;
  }
  for (std::size_t i = 0; i < is_used.size(); ++i) {
    if (!is_used[i])
      throw std::invalid_argument("vertex " + std::to_string(i) + " is in no triangle");
  }
}

}  // namespace

class SoftOrgan::Simulation {
 public:
  Simulation(core::TriangleMesh mesh, std::size_t instruments)
      : mesh_(std::move(mesh)), capsule_(inUnits(kRadius), inUnits(kShaft)) {
    requireAFew(mesh_);
    requireUse(mesh_);
    world_.setGravity(btVector3(0, 0, 0));
    world_.getWorldInfo().m_gravity.setZero();
    world_.getWorldInfo().m_sparsesdf.setDefaultVoxelsz(inUnits(kVoxel));
    for (std::size_t i = 0; i < instruments; ++i) addInstrument();
    layToRest();
    requireRest();
  }

  bool step(const std::vector<TipPose>& organ_from_tips) {
    assert(organ_from_tips.size() == instruments_.size());
    for (std::size_t i = 0; i < instruments_.size(); ++i)
      move(*instruments_[i], organ_from_tips[i]);
    world_.stepSimulation(static_cast<btScalar>(kStep), 0);  // 0: this step, not as many as fit in
    if (holds()) return true;
    layToRest();
    return false;
  }

  core::Points positions() const {
    core::Points positions;
    positions.reserve(mesh_.positions().size());
    for (int i = 0; i < body_->m_nodes.size(); ++i)
      positions.push_back(fromBullet(body_->m_nodes[i].m_x));
    return positions;
  }

 private:
  void addInstrument() {
    const btRigidBody::btRigidBodyConstructionInfo immovable(0, nullptr, &capsule_);
    auto instrument = std::make_unique<btRigidBody>(immovable);
    instrument->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    instrument->setActivationState(DISABLE_DEACTIVATION);
    instruments_.push_back(std::move(instrument));
  }

  void move(btRigidBody& instrument, const TipPose& organ_from_tip) {
    if (!organ_from_tip) {
      if (instrument.isInWorld()) world_.removeRigidBody(&instrument);
      return;
    }
    instrument.setWorldTransform(capsulePose(*organ_from_tip));
    if (instrument.isInWorld()) return;
    instrument.setInterpolationWorldTransform(instrument.getWorldTransform());  // it stood still
    world_.addRigidBody(&instrument);
  }

  /// A new body in the shape of the mesh: nothing is left of the former one.
  void layToRest() {
    if (body_) world_.removeSoftBody(body_.get());
    body_ = makeBody();
    world_.addSoftBody(body_.get());
  }

  /// Bullet tears a flat mesh, or one of numbers beyond its own, though nobody touches it.
  void requireRest() {
    if (!step(std::vector<TipPose>(instruments_.size())))
      throw std::invalid_argument(
          "the mesh cannot be simulated: untouched it does not stay at rest, as it is flat, or far "
          "from the origin");
  }

  std::unique_ptr<btSoftBody> makeBody() {
    std::vector<btScalar> coordinates;
    for (const Eigen::Vector3d& position : mesh_.positions()) {
      for (const double coordinate : position) coordinates.push_back(inUnits(coordinate));
    }
    std::vector<int> corners;
    for (const core::Corners& triangle : mesh_.triangles()) {
      for (const core::VertexId corner : triangle)
        corners.push_back(static_cast<int>(core::index(corner)));
    }
    std::unique_ptr<btSoftBody> body(btSoftBodyHelpers::CreateFromTriMesh(
        world_.getWorldInfo(), coordinates.data(), corners.data(),
        static_cast<int>(mesh_.triangleCount())));
    body->getCollisionShape()->setMargin(inUnits(kMargin));
    body->m_materials[0]->m_kLST = static_cast<btScalar>(kStiffness);
    body->m_cfg.kMT = static_cast<btScalar>(kTowardsRest);
    body->m_cfg.kDP = static_cast<btScalar>(kDamping);
    body->m_cfg.kDF = 0;   // wet tissue slides
    body->m_cfg.kKHR = 1;  // no instrument sinks in
    body->m_cfg.piterations = kIterations;
    body->generateBendingConstraints(2);  // else it wrinkles like a cloth
    holdBack(*body);
    body->setPose(false, true);  // the rest is a shape, not a volume
    return body;
  }

  static void holdBack(btSoftBody& body) {
    body.updateNormals();
    for (int i = 0; i < body.m_nodes.size(); ++i) {
      if (body.m_nodes[i].m_n.z() < 0) body.setMass(i, 0);  // no mass: Bullet does not move it
    }
  }

  bool holds() const {
    for (std::size_t i = 0; i < mesh_.positions().size(); ++i) {
      const Eigen::Vector3d position = fromBullet(body_->m_nodes[static_cast<int>(i)].m_x);
      const double moved = (position - mesh_.positions()[i]).norm();
      if (!(moved <= kFarthest)) return false;  // nor is a NaN
    }
    return true;
  }

  const core::TriangleMesh mesh_;  // at rest

  // In this order: the world, while it ends, still looks at what is in it.
  btCapsuleShapeZ capsule_;
  std::vector<std::unique_ptr<btRigidBody>> instruments_;
  std::unique_ptr<btSoftBody> body_;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btSoftRigidDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
};

SoftOrgan::SoftOrgan(core::TriangleMesh mesh, std::size_t instruments)
    : simulation_(std::make_unique<Simulation>(std::move(mesh), instruments)) {}

SoftOrgan::~SoftOrgan() = default;

bool SoftOrgan::step(const std::vector<TipPose>& organ_from_tips) {
  return simulation_->step(organ_from_tips);
}

core::Points SoftOrgan::positions() const { return simulation_->positions(); }

}  // namespace organ_collision::demo
