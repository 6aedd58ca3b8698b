// Bullet: GJK with the margins that its manual advises to keep, taken off the distance again.
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <cmath>
#include <limits>

#include "peers.h"

namespace organ_collision::bench {
namespace {

using core::Triangle;
using core::TriangleId;
using core::TriangleMesh;
using Eigen::Vector3d;

btVector3 toBullet(const Vector3d& point) {
  return {static_cast<btScalar>(point.x()), static_cast<btScalar>(point.y()),
          static_cast<btScalar>(point.z())};
}

btTriangleShape toBullet(const Triangle& t) {
  return {toBullet(t.a), toBullet(t.b), toBullet(t.c)};
}

double distance(const btConvexShape& first, const btVector3& place, const btConvexShape& second) {
  btVoronoiSimplexSolver simplex;
  btGjkEpaPenetrationDepthSolver depth;
  btGjkPairDetector detector(&first, &second, &simplex, &depth);
  btGjkPairDetector::ClosestPointInput input;
  input.m_transformA = btTransform(btQuaternion::getIdentity(), place);
  input.m_transformB.setIdentity();
  btPointCollector result;
  detector.getClosestPoints(input, result, nullptr);
  if (!result.m_hasResult) return std::numeric_limits<double>::quiet_NaN();
  return notNegative(result.m_distance + double{first.getMargin()} + second.getMargin());
}

Organ organ(const TriangleMesh& mesh) {
  return [mesh](const Vector3d& tip) {
    const btSphereShape point(CONVEX_DISTANCE_MARGIN);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
      const btTriangleShape triangle = toBullet(mesh.triangle(static_cast<TriangleId>(i)));
      const double found = distance(point, toBullet(tip), triangle);
      if (!(found >= least)) least = found;
      if (std::isnan(found)) break;
    }
    return least;
  };
}

}  // namespace

Peer bulletPeer() {
  return {"Bullet",
          organ,
          [](const Triangle& first, const Triangle& second) {
            return distance(toBullet(first), btVector3(0, 0, 0), toBullet(second));
          },
          {}};
}

}  // namespace organ_collision::bench
