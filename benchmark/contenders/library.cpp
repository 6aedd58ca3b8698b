#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "contender.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/nearest_triangles.h"
#include "organ_collision/core/tracking.h"

namespace organ_collision::bench {
namespace {

using core::Accuracy;
using core::CollisionMesh;
using core::NearestTriangle;
using core::Sign;
using Organ = std::shared_ptr<const CollisionMesh>;

/// Asks tip by tip. `Query`: a NearestTriangle from an organ and a tip.
template <class Query>
class OneByOne : public Contender {
 public:
  OneByOne(Organ organ, Query query) : organ_(std::move(organ)), query_(std::move(query)) {}

  void answer(const core::Points& tips, std::vector<double>& distances) override {
    distances.clear();
    work_ = {};
    for (const Eigen::Vector3d& tip : tips) {
      const NearestTriangle nearest = query_(*organ_, tip);
      distances.push_back(std::abs(nearest.distance));
      work_.bounds += nearest.work.bounds;
      work_.triangles += nearest.work.triangles;
    }
  }
  std::optional<Work> work() const override { return work_; }

 private:
  Organ organ_;
  Query query_;
  Work work_;
};

template <class Query>
std::shared_ptr<Contender> oneByOne(const Organ& organ, Query query) {
  return std::make_shared<OneByOne<Query>>(organ, std::move(query));
}

auto nearestWithin(const Accuracy& accuracy, Sign sign = Sign::kProven) {
  return [accuracy, sign](const CollisionMesh& organ, const Eigen::Vector3d& tip) {
    return core::nearestTriangle(organ, tip, accuracy, sign);
  };
}

auto nearestFollowed(Sign sign) {
  return [tracker = std::make_shared<core::Tracker>(), sign](const CollisionMesh& organ,
                                                             const Eigen::Vector3d& tip) {
    return tracker->nearestTriangle(organ, 0.0, tip, sign);
  };
}

/// Asks for triangles alone, as the paper's search does.
class Unmeasured : public Contender {
 public:
  explicit Unmeasured(Organ organ) : organ_(std::move(organ)) {}

  void answer(const core::Points& tips, std::vector<double>& /*distances*/) override {
    triangles_.clear();
    for (const Eigen::Vector3d& tip : tips)
      triangles_.push_back(core::greedyTriangle(*organ_, tip));
  }
  void measure(const core::Points& tips, std::vector<double>& distances) override {
    measureEach(organ_->mesh(), triangles_, tips, distances);
  }

 private:
  Organ organ_;
  std::vector<core::TriangleId> triangles_;
};

/// Asks all tips in one call.
class AllAtOnce : public Contender {
 public:
  explicit AllAtOnce(Organ organ) : organ_(std::move(organ)) {}

  void answer(const core::Points& tips, std::vector<double>& distances) override {
    distances.clear();
    for (const NearestTriangle& nearest : core::nearestTriangles(*organ_, tips))
      distances.push_back(std::abs(nearest.distance));
  }

 private:
  Organ organ_;
};

/// Measures all triangles.
class BruteForce : public Contender {
 public:
  explicit BruteForce(const core::TriangleMesh& mesh) {
    for (std::size_t i = 0; i < mesh.triangleCount(); ++i)
      triangles_.push_back(mesh.triangle(static_cast<core::TriangleId>(i)));
  }

  void answer(const core::Points& tips, std::vector<double>& distances) override {
    distances.clear();
    for (const Eigen::Vector3d& tip : tips) {
      double least = std::numeric_limits<double>::infinity();
      for (const core::Triangle& triangle : triangles_)
        least = std::min(least, core::closestPointOnTriangle(tip, triangle).squared_distance);
      distances.push_back(std::sqrt(least));
    }
  }

 private:
  std::vector<core::Triangle> triangles_;
};

/// What all ways of following have in common.
class Following : public Follower {
 public:
  explicit Following(const core::TriangleMesh& mesh)
      : organ_(std::make_shared<CollisionMesh>(mesh)),
        contender_(oneByOne(organ_, nearestWithin(Accuracy::exact()))) {}
  Contender& contender() override { return *contender_; }
  std::optional<std::size_t> hierarchyMemory() const override {
    return organ_->tree().memory() + organ_->wideTree().searchMemory();
  }

 protected:
  CollisionMesh& organ() { return *organ_; }

 private:
  std::shared_ptr<CollisionMesh> organ_;
  std::shared_ptr<Contender> contender_;
};

class Refitting : public Following {
 public:
  using Following::Following;
  void prepare(const core::Points& positions) override { positions_ = positions; }
  void follow() override { organ().refit(std::move(positions_)); }

 private:
  core::Points positions_;
};

class RefittingPartly : public Following {
 public:
  RefittingPartly(const core::TriangleMesh& mesh, std::vector<core::VertexId> moved)
      : Following(mesh), moved_(std::move(moved)) {}
  void prepare(const core::Points& positions) override {
    positions_.clear();
    for (const core::VertexId vertex : moved_) positions_.push_back(positions[index(vertex)]);
  }
  void follow() override { organ().refit(moved_, positions_); }

 private:
  std::vector<core::VertexId> moved_;
  core::Points positions_;
};

}  // namespace

std::vector<Entrant> libraryEntrants(const core::TriangleMesh& mesh) {
  constexpr std::size_t kBruteForceTests = 1 << 20;  // triangles measured per answer to all tips
  const auto organ = std::make_shared<const CollisionMesh>(mesh);
  const std::vector<Task> singly = {Task::kPoints, Task::kPath};
  const std::vector<Task> always = {Task::kPoints, Task::kPath, Task::kBatch};
  const auto setting = [&](const char* name, const Accuracy& accuracy, Sign sign = Sign::kProven) {
    return Entrant{name, singly, std::nullopt, kAll,
                   oneByOne(organ, nearestWithin(accuracy, sign))};
  };
  const auto followed = [&](const char* name, Sign sign) {
    return Entrant{
        name, {Task::kPath}, kDoubleTolerance, kAll, oneByOne(organ, nearestFollowed(sign))};
  };
  return {
      {"exact", always, kDoubleTolerance, kAll, oneByOne(organ, nearestWithin({}))},
      {"exact, unsigned", singly, kDoubleTolerance, kAll,
       oneByOne(organ, nearestWithin({}, Sign::kNone))},
      followed("exact, previous known", Sign::kProven),
      followed("exact, unsigned, previous known", Sign::kNone),
      {"exact, all cores",
       {Task::kBatch},
       kDoubleTolerance,
       kAll,
       std::make_shared<AllAtOnce>(organ)},
      setting("greedy", Accuracy::greedy()),
      setting("greedy, unsigned", Accuracy::greedy(), Sign::kNone),
      {"greedy, unmeasured", singly, std::nullopt, kAll, std::make_shared<Unmeasured>(organ)},
      setting("4 leaves", {0.0, 0.0, 4}),
      setting("16 leaves", {0.0, 0.0, 16}),
      setting("1 %", {0.01, 0.0, 0}),
      {"brute force", singly, kDoubleTolerance,
       std::max<std::size_t>(1, kBruteForceTests / mesh.triangleCount()),
       std::make_shared<BruteForce>(mesh)},
  };
}

std::vector<Method> libraryMethods() {
  using Moved = std::vector<core::VertexId>;
  return {{"this library", kDoubleTolerance, Follows::kAllVertices, kAll,
           [](const core::TriangleMesh& mesh, const Moved& /*moved*/) {
             return std::make_unique<Refitting>(mesh);
           }},
          {"this library, partial", kDoubleTolerance, Follows::kSomeVertices, kAll,
           [](const core::TriangleMesh& mesh, const Moved& moved) {
             return std::make_unique<RefittingPartly>(mesh, moved);
           }}};
}

}  // namespace organ_collision::bench
