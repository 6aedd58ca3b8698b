// Embree 3, as its documentation advises for speed: a static scene of high quality, denormals
// flushed to zero, all queries from one context.
#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "contender.h"
#include "float_closest_point.h"

namespace organ_collision::bench {
namespace {

using in_float::toFloat;
using in_float::Vector;

constexpr float kAnywhere = std::numeric_limits<float>::infinity();

std::atomic<std::ptrdiff_t> bytes_taken{0};

bool countMemory(void* /*user*/, ssize_t bytes, bool /*already_done*/) {
  bytes_taken += bytes;
  return true;
}

/// One for all: to make it takes as long as to build a small organ.
RTCDevice device() {
  static RTCDevice device = nullptr;
  if (device == nullptr) {
    device = rtcNewDevice(nullptr);
    if (device == nullptr) throw std::runtime_error("Embree has no device");
    rtcSetDeviceMemoryMonitorFunction(device, countMemory, nullptr);
  }
  return device;
}

/// A scene of one organ.
class Scene {
 public:
  Scene(const core::TriangleMesh& mesh, RTCSceneFlags flags, RTCBuildQuality scene_quality,
        RTCBuildQuality geometry_quality)
      : scene_(rtcNewScene(device())),
        geometry_(rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE)) {
    rtcSetSceneFlags(scene_, flags);
    rtcSetSceneBuildQuality(scene_, scene_quality);
    rtcSetGeometryBuildQuality(geometry_, geometry_quality);
    positions_ = static_cast<Vector*>(rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0,
                                                              RTC_FORMAT_FLOAT3, sizeof(Vector),
                                                              mesh.positions().size()));
    corners_ = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), mesh.triangleCount()));
    setPositions(mesh.positions());
    for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        corners_[3 * i + j] = static_cast<unsigned>(mesh.triangles()[i][j]);
    }
    rtcCommitGeometry(geometry_);
    rtcAttachGeometry(scene_, geometry_);
    rtcCommitScene(scene_);
    if (rtcGetDeviceError(device()) != RTC_ERROR_NONE)
      throw std::runtime_error("Embree cannot build its scene");
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  ~Scene() {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
  }

  void setPositions(const core::Points& positions) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      positions_[i] = {static_cast<float>(positions[i].x()), static_cast<float>(positions[i].y()),
                       static_cast<float>(positions[i].z())};
    }
  }

  void commitPositions() {
    rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene_);
  }

  struct Nearest {
    const Scene* scene;
    float squared_distance;
    unsigned triangle;
  };

  Nearest nearest(const Vector& tip, float within) const {
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    RTCPointQuery query;
    query.x = tip.x;
    query.y = tip.y;
    query.z = tip.z;
    query.time = 0.0F;
    query.radius = within;
    Nearest nearest = {this, kAnywhere, RTC_INVALID_GEOMETRY_ID};
    rtcPointQuery(scene_, &query, &context, measure, &nearest);
    return nearest;
  }

  float squaredDistance(const Vector& tip, unsigned triangle) const {
    const unsigned* const corner = corners_ + 3 * static_cast<std::size_t>(triangle);
    const Vector offset =
        closestPoint(tip, positions_[corner[0]], positions_[corner[1]], positions_[corner[2]]) -
        tip;
    return dot(offset, offset);
  }

 private:
  static bool measure(RTCPointQueryFunctionArguments* arguments) {
    Nearest& nearest = *static_cast<Nearest*>(arguments->userPtr);
    RTCPointQuery& query = *arguments->query;
    const float squared_distance =
        nearest.scene->squaredDistance({query.x, query.y, query.z}, arguments->primID);
    if (squared_distance >= nearest.squared_distance) return false;
    nearest.squared_distance = squared_distance;
    nearest.triangle = arguments->primID;
    query.radius = std::sqrt(squared_distance);
    return true;
  }

  RTCScene scene_;
  RTCGeometry geometry_;
  Vector* positions_;
  unsigned* corners_;
};

/// Flushes denormals to zero in this thread while it lives, as Embree advises.
class FlushDenormals {
 public:
  FlushDenormals() : former_(_mm_getcsr()) {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;
  ~FlushDenormals() { _mm_setcsr(former_); }

 private:
  unsigned former_;
};

class OneByOne : public Contender {
 public:
  explicit OneByOne(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)) {}
  void answer(const core::Points& tips, std::vector<double>& distances) override {
    const FlushDenormals flush;
    distances.clear();
    for (const Eigen::Vector3d& tip : tips)
      distances.push_back(std::sqrt(scene_->nearest(toFloat(tip), kAnywhere).squared_distance));
  }

 private:
  std::shared_ptr<const Scene> scene_;
};

/// Searches no farther than the previous tip's triangle is from the tip.
class FromPrevious : public Contender {
 public:
  explicit FromPrevious(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)) {}
  void answer(const core::Points& tips, std::vector<double>& distances) override {
    // So that rounding inside Embree does not lose the previous triangle itself.
    constexpr float kRoundingUp = 1.0F + 1e-5F;
    const FlushDenormals flush;
    distances.clear();
    for (const Eigen::Vector3d& point : tips) {
      const Vector tip = toFloat(point);
      const bool is_first = distances.empty();
      const float known = is_first ? kAnywhere : std::sqrt(scene_->squaredDistance(tip, previous_));
      const Scene::Nearest nearest = scene_->nearest(tip, kRoundingUp * known);
      if (nearest.triangle != RTC_INVALID_GEOMETRY_ID) previous_ = nearest.triangle;
      distances.push_back(std::min(known, std::sqrt(nearest.squared_distance)));
    }
  }

 private:
  std::shared_ptr<const Scene> scene_;
  unsigned previous_ = 0;
};

class OnAllCores : public Contender {
 public:
  explicit OnAllCores(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)) {}
  void answer(const core::Points& tips, std::vector<double>& distances) override {
    distances.resize(tips.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tips.size()), [&](const auto& range) {
      const FlushDenormals flush;
      for (std::size_t i = range.begin(); i < range.end(); ++i)
        distances[i] = std::sqrt(scene_->nearest(toFloat(tips[i]), kAnywhere).squared_distance);
    });
  }

 private:
  std::shared_ptr<const Scene> scene_;
};

class Committing : public Follower {
 public:
  Committing(const core::TriangleMesh& mesh, RTCSceneFlags flags, RTCBuildQuality scene_quality,
             RTCBuildQuality geometry_quality)
      : scene_(std::make_shared<Scene>(mesh, flags, scene_quality, geometry_quality)),
        contender_(scene_) {}
  void prepare(const core::Points& positions) override { scene_->setPositions(positions); }
  void follow() override { scene_->commitPositions(); }
  Contender& contender() override { return contender_; }

 private:
  std::shared_ptr<Scene> scene_;
  OneByOne contender_;
};

Method method(const char* name, Follows follows, RTCSceneFlags flags, RTCBuildQuality scene_quality,
              RTCBuildQuality geometry_quality) {
  return {name, kFloatTolerance, follows, kAll,
          [=](const core::TriangleMesh& mesh, const std::vector<core::VertexId>& /*moved*/) {
            return std::make_unique<Committing>(mesh, flags, scene_quality, geometry_quality);
          }};
}

}  // namespace

std::vector<Entrant> embreeEntrants(const core::TriangleMesh& mesh) {
  const auto scene = [&](RTCSceneFlags flags) {
    return std::make_shared<const Scene>(mesh, flags, RTC_BUILD_QUALITY_HIGH,
                                         RTC_BUILD_QUALITY_HIGH);
  };
  const auto fast = scene(RTC_SCENE_FLAG_NONE);
  const auto robust = scene(RTC_SCENE_FLAG_ROBUST);
  const std::vector<Task> singly = {Task::kPoints, Task::kPath};
  return {{"Embree",
           {Task::kPoints, Task::kPath, Task::kBatch},
           kFloatTolerance,
           kAll,
           std::make_shared<OneByOne>(fast)},
          {"Embree, robust", singly, kFloatTolerance, kAll, std::make_shared<OneByOne>(robust)},
          {"Embree, previous known",
           {Task::kPath},
           kFloatTolerance,
           kAll,
           std::make_shared<FromPrevious>(fast)},
          {"Embree, all cores",
           {Task::kBatch},
           kFloatTolerance,
           kAll,
           std::make_shared<OnAllCores>(fast)}};
}

std::vector<Method> embreeMethods() {
  device();  // before anything is timed
  return {method("Embree, refit", Follows::kAllVertices, RTC_SCENE_FLAG_DYNAMIC,
                 RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_REFIT),
          method("Embree, static", Follows::kNothing, RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_HIGH,
                 RTC_BUILD_QUALITY_HIGH)};
}

std::size_t embreeMemory() { return static_cast<std::size_t>(bytes_taken.load()); }

}  // namespace organ_collision::bench
