#include "node/services.h"

#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "node/conversions.h"
#include "organ_collision/core/nearest_triangles.h"
#include "organ_collision/core/triangles_within.h"
#include "organ_collision/io/message_text.h"

namespace organ_collision::node {
namespace {

constexpr double kTransformPatience = 0.1;          // [s] that a service waits for a transform
constexpr double kTransformPeriod = 0.005;          // [s] between two looks while it waits
constexpr std::size_t kMostPoints = 100'000;        // in one call: answered within a second or so
constexpr std::size_t kMostTriangles = 10'000'000;  // of a new topology: some GB

/// Runs a service's body; what it throws becomes the message of a refusal.
template <class Response, class Body>
bool answer(Response& response, Body body) {
  try {
    body();
    response.success = true;
  } catch (const std::exception& error) {
    response = Response();
    response.message = io::printable(error.what());
  }
  return true;
}

void requireAtMost(std::size_t most, std::size_t count, const char* what) {
  if (count <= most) return;
  throw std::invalid_argument(std::to_string(count) + " " + what + " in one call: at most " +
                              std::to_string(most) + " are allowed");
}

}  // namespace

Services::Services(const Organs& organs, const tf2::BufferCore& buffer,
                   std::function<void()> publish_mesh_info)
    : organs_(organs), buffer_(buffer), publish_mesh_info_(std::move(publish_mesh_info)) {}

void Services::advertise(ros::NodeHandle& node, ros::NodeHandle& changes) {
  servers_ = {node.advertiseService("find_nearest_triangle", &Services::findNearestTriangle, this),
              node.advertiseService("find_triangles_within", &Services::findTrianglesWithin, this),
              changes.advertiseService("update_mesh", &Services::updateMesh, this),
              node.advertiseService("get_mesh", &Services::getMesh, this)};
}

FramePose Services::waitForPose(const Organ& organ, const std_msgs::Header& header) const {
  if (header.frame_id.empty())
    throw std::invalid_argument("header.frame_id is empty: in which frame are the points?");
  if (header.frame_id.front() == '/') {
    throw std::invalid_argument("header.frame_id is '" + header.frame_id +
                                "', but a tf frame does not begin with '/'");
  }
  // A transform of just now may still be on its way. The simulator's clock may stand still.
  const ros::SteadyTime deadline = ros::SteadyTime::now() + ros::WallDuration(kTransformPatience);
  while (true) {
    const FrameLookup lookup = lookUpFrame(buffer_, organ.frame(), header.frame_id, header.stamp);
    if (lookup.pose) return *lookup.pose;
    if (ros::SteadyTime::now() > deadline) {
      throw std::invalid_argument("no transform from frame_id '" + header.frame_id + "' to '" +
                                  organ.frame() + "': " + lookup.reason);
    }
    ros::WallDuration(kTransformPeriod).sleep();
  }
}

bool Services::findNearestTriangle(FindNearestTriangle::Request& request,
                                   FindNearestTriangle::Response& response) {
  return answer(response, [&] {
    requireAtMost(kMostPoints, request.points.size(), "points");
    Organ& organ = organNamed(organs_, request.organ);
    const core::Accuracy accuracy = fromMessage(request.accuracy);
    const FramePose pose = waitForPose(organ, request.header);
    const Eigen::Isometry3d& organ_from_points = pose.target_from_source;
    const Eigen::Isometry3d points_from_organ = organ_from_points.inverse();
    const std::shared_ptr<const OrganSnapshot> snapshot = organ.snapshot();
    response.mesh_version = snapshot->version;
    response.header.frame_id = request.header.frame_id;
    response.header.stamp = pose.stamp;
    core::Points points;
    points.reserve(request.points.size());
    for (const geometry_msgs::Point& point : request.points) {
      const Eigen::Vector3d as_sent = fromPoint(point);
      core::requireUsable(as_sent, "point", points.size());
      points.push_back(organ_from_points * as_sent);
    }
    response.nearest.reserve(points.size());
    for (const core::NearestTriangle& nearest :
         core::nearestTriangles(snapshot->organ, points, accuracy)) {
      organ.account(nearest.tip_point, accuracy);
      response.nearest.push_back(toMessage(nearest, points_from_organ));
    }
  });
}

bool Services::findTrianglesWithin(FindTrianglesWithin::Request& request,
                                   FindTrianglesWithin::Response& response) {
  return answer(response, [&] {
    const Organ& organ = organNamed(organs_, request.organ);
    const FramePose pose = waitForPose(organ, request.header);
    const Eigen::Vector3d point = fromPoint(request.point);
    core::requireUsable(point, "point", 0);
    const std::shared_ptr<const OrganSnapshot> snapshot = organ.snapshot();
    const core::TrianglesWithin within = core::trianglesWithin(
        snapshot->organ, pose.target_from_source * point, request.radius, request.max_results);
    response.mesh_version = snapshot->version;
    response.complete = within.complete;
    for (const auto& [triangle, distance] : within.triangles) {
      response.triangles.push_back(static_cast<std::uint32_t>(triangle));
      response.distances.push_back(distance);
    }
  });
}

bool Services::updateMesh(UpdateMesh::Request& request, UpdateMesh::Response& response) {
  const Organ* asked = nullptr;
  answer(response, [&] {
    Organ& organ = organNamed(organs_, request.organ);
    asked = &organ;
    requireAtMost(kMostTriangles, request.triangles.size(), "triangles");
    organ.requireFrame(request.header.frame_id);
    if (request.mode > UpdateMesh::Request::REBUILD) {
      throw std::invalid_argument("mode is " + std::to_string(request.mode) +
                                  ": AUTO is 0, REFIT 1, REBUILD 2");
    }
    const Organ::Applied applied =
        request.triangles.empty()
            ? organ.update(movesFrom(request), static_cast<UpdateMode>(request.mode),
                           request.expected_version)
            : organ.replace(meshFrom(request), request.expected_version);
    response.message = applied.reason;
    response.mesh_version = applied.version;
    response.action = static_cast<std::uint8_t>(applied.action);
    response.duration = applied.duration;
  });
  if (!response.success) {
    response.action = UpdateMesh::Response::NONE;
    if (asked != nullptr) response.mesh_version = asked->snapshot()->version;
  }
  // Where this was refused, what waited may have been applied before.
  if (asked != nullptr) publish_mesh_info_();
  return true;
}

bool Services::getMesh(GetMesh::Request& request, GetMesh::Response& response) {
  return answer(response, [&] {
    const Organ& organ = organNamed(organs_, request.organ);
    const std::shared_ptr<const OrganSnapshot> snapshot = organ.snapshot();
    response.frame_id = organ.frame();
    response.mesh_version = snapshot->version;
    response.mesh = toMessage(snapshot->organ.mesh());
  });
}

}  // namespace organ_collision::node
