#include "node/snapshots.h"

#include <gtest/gtest.h>

#include <set>

#include "allocated_memory.h"
#include "test_meshes.h"

namespace organ_collision::node {
namespace {

OrganSnapshot loaded() {
  return {core::CollisionMesh(test::cube()), 1, Action::kLoad, "loaded", 0.0};
}

/// The next version, written as an update writes it; told by where it is in memory.
const OrganSnapshot* publishNext(Snapshots& snapshots) {
  std::unique_ptr<OrganSnapshot> next = snapshots.writable();
  next->version = snapshots.current()->version + 1;
  return snapshots.publish(std::move(next)).get();
}

TEST(Snapshots, AReaderKeepsWhatItTookWhileLaterOnesSeeTheNext) {
  Snapshots snapshots(loaded());
  const auto taken = snapshots.current();
  publishNext(snapshots);
  EXPECT_EQ(taken->version, 1U);
  EXPECT_EQ(snapshots.current()->version, 2U);
}

TEST(Snapshots, TwoStatesTakeTurnsWhereNobodyLingers) {
  Snapshots snapshots(loaded());
  std::set<const OrganSnapshot*> used = {snapshots.current().get()};
  for (int i = 0; i < 10; ++i) used.insert(publishNext(snapshots));
  EXPECT_EQ(used.size(), 2U);
}

TEST(Snapshots, NothingIsWrittenThatIsStillRead) {
  Snapshots snapshots(loaded());
  std::vector<std::shared_ptr<const OrganSnapshot>> readers;
  for (int i = 0; i < 10; ++i) {
    readers.push_back(snapshots.current());
    publishNext(snapshots);
  }
  for (std::size_t i = 0; i < readers.size(); ++i) EXPECT_EQ(readers[i]->version, i + 1);
  readers.clear();
  std::set<const OrganSnapshot*> used;
  for (int i = 0; i < 10; ++i) used.insert(publishNext(snapshots));
  EXPECT_LE(used.size(), 3U) << "the rest is freed";
}

TEST(Snapshots, WhatIsWrittenNextHasTheCurrentSplits) {
  Snapshots snapshots(loaded());
  publishNext(snapshots);
  snapshots.publish(std::make_unique<OrganSnapshot>(
      OrganSnapshot{core::CollisionMesh(test::blob(1)), 3, Action::kRebuild, "", 0.0, 2}));
  const auto next = snapshots.writable();
  EXPECT_EQ(next->hierarchy, 2U);
  EXPECT_EQ(next->version, 3U);
  EXPECT_EQ(next->organ.mesh().triangleCount(), 32U);
}

TEST(Snapshots, WhatIsWrittenAfterARebuildHasItsSplits) {
  Snapshots snapshots(loaded());
  publishNext(snapshots);
  auto rebuilt = std::make_unique<OrganSnapshot>(*snapshots.current());
  rebuilt->organ.rebuild();
  rebuilt->hierarchy = 2;
  snapshots.publish(std::move(rebuilt));
  EXPECT_EQ(snapshots.writable()->hierarchy, 2U) << "though former ones of the same mesh lie there";
}

TEST(Snapshots, KeepNoMoreThanTwoThatNobodyReads) {
  Snapshots snapshots({core::CollisionMesh(test::blob(6)), 1, Action::kLoad, "loaded", 0.0});
  const std::size_t of_one = snapshots.current()->organ.memory();
  const std::size_t before = test::allocatedMemory();
  std::vector<std::shared_ptr<const OrganSnapshot>> readers;
  for (int i = 0; i < 8; ++i) {
    readers.push_back(snapshots.current());
    publishNext(snapshots);
  }
  readers.clear();
  publishNext(snapshots);
  EXPECT_LE(test::allocatedMemory(), before + 2 * of_one + of_one / 2);
}

TEST(Snapshots, KeepNoMemoryOfAFormerMesh) {
  const std::size_t before = test::allocatedMemory();
  Snapshots snapshots({core::CollisionMesh(test::blob(6)), 1, Action::kLoad, "loaded", 0.0});
  const std::size_t of_one = snapshots.current()->organ.memory();
  std::vector<std::shared_ptr<const OrganSnapshot>> readers;
  for (int i = 0; i < 3; ++i) {
    readers.push_back(snapshots.current());
    publishNext(snapshots);
  }
  snapshots.publish(std::make_unique<OrganSnapshot>(
      OrganSnapshot{core::CollisionMesh(test::cube()), 3, Action::kLoad, "", 0.0, 2}));
  readers.pop_back();
  const auto next = snapshots.writable();
  EXPECT_LE(next->organ.memory(), 2 * core::CollisionMesh(test::cube()).memory());
  readers.clear();
  snapshots.trim();
  EXPECT_LT(test::allocatedMemory(), before + of_one / 2);
}

TEST(Snapshots, OutliveTheirOwnerWithTheirReaders) {
  std::shared_ptr<const OrganSnapshot> taken;
  {
    Snapshots snapshots(loaded());
    taken = snapshots.current();
    publishNext(snapshots);
  }
  EXPECT_EQ(taken->version, 1U);
}

}  // namespace
}  // namespace organ_collision::node
