// Embree: a robust scene and the closest point of its own tutorial, in float.
#include <embree3/rtcore.h>

#include <cmath>
#include <limits>
#include <memory>

#include "contenders/float_closest_point.h"
#include "peers.h"

namespace organ_collision::bench {
namespace {

using core::TriangleMesh;
using Eigen::Vector3d;
using in_float::toFloat;
using in_float::Vector;

class Scene {
 public:
  explicit Scene(const TriangleMesh& mesh) {
    static const RTCDevice device = rtcNewDevice(nullptr);
    scene_ = rtcNewScene(device);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    positions_ = static_cast<Vector*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                              RTC_FORMAT_FLOAT3, sizeof(Vector),
                                                              mesh.positions().size()));
    corners_ = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), mesh.triangleCount()));
    for (std::size_t i = 0; i < mesh.positions().size(); ++i)
      positions_[i] = toFloat(mesh.positions()[i]);
    for (std::size_t i = 0; i < 3 * mesh.triangleCount(); ++i)
      corners_[i] = static_cast<unsigned>(mesh.triangles()[i / 3][i % 3]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  ~Scene() { rtcReleaseScene(scene_); }

  double distance(const Vector3d& tip) const {
    const Vector from = toFloat(tip);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    RTCPointQuery query{from.x, from.y, from.z, 0.0F, std::numeric_limits<float>::infinity()};
    Nearest nearest{this, std::numeric_limits<float>::infinity()};
    rtcPointQuery(scene_, &query, &context, measure, &nearest);
    return nearest.distance;
  }

 private:
  struct Nearest {
    const Scene* scene;
    float distance;
  };

  static bool measure(RTCPointQueryFunctionArguments* arguments) {
    Nearest& nearest = *static_cast<Nearest*>(arguments->userPtr);
    RTCPointQuery& query = *arguments->query;
    const Scene& scene = *nearest.scene;
    const unsigned* const corner = scene.corners_ + 3 * static_cast<std::size_t>(arguments->primID);
    const Vector tip{query.x, query.y, query.z};
    const Vector offset = closestPoint(tip, scene.positions_[corner[0]],
                                       scene.positions_[corner[1]], scene.positions_[corner[2]]) -
                          tip;
    const float distance = std::sqrt(dot(offset, offset));
    if (distance >= nearest.distance) return false;
    nearest.distance = distance;
    query.radius = distance;
    return true;
  }

  RTCScene scene_;
  Vector* positions_;
  unsigned* corners_;
};

Organ organ(const TriangleMesh& mesh) {
  const auto scene = std::make_shared<Scene>(mesh);
  return [scene](const Vector3d& tip) { return scene->distance(tip); };
}

}  // namespace

Peer embreePeer() { return {"Embree", organ, {}, {}}; }

}  // namespace organ_collision::bench
