// Bullet's triangle mesh shape, with the quantised boxes that its manual recommends. It has no
// nearest triangle, but updates: of the whole tree, and of what overlaps a box.
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>

#include <cmath>
#include <limits>

#include "contender.h"
#include "organ_collision/core/closest_point.h"

namespace organ_collision::bench {
namespace {

// Of the diagonal: how far a deformation may leave the box that the quantisation is made for.
constexpr double kRoom = 0.5;

btVector3 toBullet(const Eigen::Vector3d& point) {
  return {static_cast<btScalar>(point.x()), static_cast<btScalar>(point.y()),
          static_cast<btScalar>(point.z())};
}

struct FloatBox {
  btVector3 low = btVector3(1, 1, 1) * std::numeric_limits<btScalar>::max();
  btVector3 high = -low;
  void add(const btVector3& point) {
    low.setMin(point);
    high.setMax(point);
  }
};

class Bullet : public Contender, public Follower {
 public:
  Bullet(const core::TriangleMesh& mesh, const std::vector<core::VertexId>& moved)
      : mesh_(mesh), moved_(mesh.positions().size(), moved.empty()) {
    for (const core::VertexId vertex : moved) moved_[index(vertex)] = true;
    FloatBox box;
    for (const Eigen::Vector3d& position : mesh.positions()) {
      positions_.push_back(toBullet(position));
      box.add(positions_.back());
    }
    for (const core::Corners& corners : mesh.triangles()) {
      for (const core::VertexId corner : corners) corners_.push_back(static_cast<int>(corner));
    }
    arrays_ = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(mesh.triangleCount()), corners_.data(), 3 * sizeof(int),
        static_cast<int>(positions_.size()), &positions_.front()[0], sizeof(btVector3));
    const btVector3 room = btVector3(1, 1, 1) * btScalar(kRoom);
    shape_ = std::make_unique<btBvhTriangleMeshShape>(arrays_.get(), true, box.low - room,
                                                      box.high + room);
    // A partial refit leaves the boxes above its subtrees as they were: ask the subtrees.
    shape_->getOptimizedBvh()->setTraversalMode(btQuantizedBvh::TRAVERSAL_STACKLESS_CACHE_FRIENDLY);
  }

  void prepare(const core::Points& positions) override {
    changed_ = {};
    for (const core::Corners& corners : mesh_.triangles()) addIfMoved(corners);
    for (std::size_t i = 0; i < positions.size(); ++i) positions_[i] = toBullet(positions[i]);
    for (const core::Corners& corners : mesh_.triangles()) addIfMoved(corners);
  }
  Contender& contender() override { return *this; }

  /// Looks in boxes that grow until they are sure to have the nearest triangle.
  void answer(const core::Points& tips, std::vector<double>& distances) override {
    distances.clear();
    for (const Eigen::Vector3d& tip : tips) {
      double reach = 1e-3;
      while (leastWithin(tip, reach) > reach) reach *= 2.0;
      distances.push_back(leastWithin(tip, reach));
    }
  }

 protected:
  btBvhTriangleMeshShape& shape() { return *shape_; }
  const FloatBox& changed() const { return changed_; }

 private:
  struct Nearest : btTriangleCallback {
    void processTriangle(btVector3* corners, int /*part*/, int /*triangle*/) override {
      const auto corner = [&](int i) {
        return Eigen::Vector3d(corners[i].x(), corners[i].y(), corners[i].z());
      };
      const core::ClosestPoint closest =
          core::closestPointOnTriangle(tip, {corner(0), corner(1), corner(2)});
      least = std::min(least, std::sqrt(closest.squared_distance));
    }
    Eigen::Vector3d tip;
    double least = std::numeric_limits<double>::infinity();
  };

  double leastWithin(const Eigen::Vector3d& tip, double reach) const {
    Nearest nearest;
    nearest.tip = tip;
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(reach);
    shape_->processAllTriangles(&nearest, toBullet(tip - half), toBullet(tip + half));
    return nearest.least;
  }

  void addIfMoved(const core::Corners& corners) {
    if (!moved_[index(corners[0])] && !moved_[index(corners[1])] && !moved_[index(corners[2])])
      return;
    for (const core::VertexId corner : corners) changed_.add(positions_[index(corner)]);
  }

  const core::TriangleMesh& mesh_;
  std::vector<bool> moved_;
  std::vector<btVector3> positions_;
  std::vector<int> corners_;
  std::unique_ptr<btTriangleIndexVertexArray> arrays_;
  std::unique_ptr<btBvhTriangleMeshShape> shape_;
  FloatBox changed_;  // around the triangles of the moved vertices, before and after
};

class Refitting : public Bullet {
 public:
  using Bullet::Bullet;
  void follow() override { shape().refitTree(changed().low, changed().high); }
};

class RefittingPartly : public Bullet {
 public:
  using Bullet::Bullet;
  void follow() override { shape().partialRefitTree(changed().low, changed().high); }
};

template <class Way>
std::unique_ptr<Follower> build(const core::TriangleMesh& mesh,
                                const std::vector<core::VertexId>& moved) {
  return std::make_unique<Way>(mesh, moved);
}

}  // namespace

std::vector<Method> bulletMethods() {
  return {
      {"Bullet", kFloatTolerance, Follows::kAllVertices, kAll, build<Refitting>},
      {"Bullet, partial", kFloatTolerance, Follows::kSomeVertices, kAll, build<RefittingPartly>}};
}

}  // namespace organ_collision::bench
