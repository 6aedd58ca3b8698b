#include "organ_collision/core/contact.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "test_meshes.h"

namespace {
thread_local std::size_t allocations = 0;
}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  void* const memory = std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }

namespace organ_collision::core {
namespace {

Triangle tipAt(const Eigen::Vector3d& corner) {
  return {corner, corner + Eigen::Vector3d(0.1, 0, 0), corner + Eigen::Vector3d(0, 0.1, 0)};
}

TEST(Contact, OfAPointCollidesInsideAndOnTheSurfaceOfASolid) {
  const CollisionMesh cube(test::cube());
  for (const double z : {0.5, 0.0, 1.0}) {
    const Contact touching = contact(cube, Eigen::Vector3d(0.5, 0.5, z));
    EXPECT_TRUE(touching.colliding);
    EXPECT_TRUE(touching.colliding_certain);
  }
  const Contact apart = contact(cube, Eigen::Vector3d(0.5, 0.5, 1.0 + 1e-9));
  EXPECT_FALSE(apart.colliding);
  EXPECT_TRUE(apart.colliding_certain);
}

TEST(Contact, OfATriangleCollidesWhenItCrossesTouchesOrIsInside) {
  const CollisionMesh cube(test::cube());
  EXPECT_TRUE(contact(cube, tipAt({0.5, 0.5, 0.5})).colliding);  // wholly inside
  EXPECT_LT(contact(cube, tipAt({0.5, 0.5, 0.5})).nearest.distance, 0.0);
  EXPECT_TRUE(contact(cube, tipAt({0.95, 0.5, 0.5})).colliding);  // through a face
  EXPECT_TRUE(contact(cube, tipAt({0.5, 0.5, 1.0})).colliding);   // flat on a face
  EXPECT_TRUE(contact(cube, tipAt({1.0, 1.0, 1.0})).colliding);   // by a vertex
  const Contact apart = contact(cube, tipAt({0.5, 0.5, 1.5}));
  EXPECT_FALSE(apart.colliding);
  EXPECT_EQ(apart.nearest.distance, 0.5);
}

TEST(Contact, WithAnOpenSurfaceIsTouchingIt) {
  const CollisionMesh grid(test::grid(4, 4));
  EXPECT_TRUE(contact(grid, Eigen::Vector3d(1.3, 2.2, 0.0)).colliding);
  const Contact below = contact(grid, Eigen::Vector3d(1.3, 2.2, -0.5));
  EXPECT_FALSE(below.colliding);
  EXPECT_TRUE(below.colliding_certain);
}

TEST(Contact, IsUncertainWhereTheAccuracyDoesNotDecideIt) {
  const CollisionMesh organ(test::blob(4));
  const Contact greedy = contact(organ, Eigen::Vector3d(0, 0, 0), Accuracy::greedy());
  EXPECT_FALSE(greedy.colliding);
  EXPECT_FALSE(greedy.colliding_certain);
  EXPECT_TRUE(contact(organ, Eigen::Vector3d(1, 1, 1), Accuracy::greedy()).colliding_certain);
  EXPECT_TRUE(contact(organ, Eigen::Vector3d(0, 0, 0)).colliding_certain);
}

TEST(Contact, AllocatesNothingOnceTheThreadHasSeenItsWidestSearch) {
  const CollisionMesh organ(test::blob(4));
  std::mt19937 generator(1);
  Points tips(500);
  for (Eigen::Vector3d& tip : tips) tip = test::randomPoint(generator, 0.15);
  const auto askAll = [&] {
    const std::size_t before = allocations;
    for (const Eigen::Vector3d& tip : tips) {
      contact(organ, tip);
      contact(organ, tip, Accuracy::greedy());
      contact(organ, tipAt(tip));
    }
    return allocations - before;
  };
  askAll();
  EXPECT_EQ(askAll(), 0);
}

TEST(Tip, MovesWithItsFrame) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(1, 2, 3))
      .rotate(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));
  EXPECT_LT((std::get<Eigen::Vector3d>(transformed(Eigen::Vector3d(1, 0, 0), pose)) -
             Eigen::Vector3d(1, 3, 3))
                .norm(),
            1e-15);
  EXPECT_LT((std::get<Triangle>(transformed(tipAt({0, 0, 0}), pose)).b - Eigen::Vector3d(1, 2.1, 3))
                .norm(),
            1e-15);
}

}  // namespace
}  // namespace organ_collision::core
