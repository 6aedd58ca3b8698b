#include "node/conversions.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

namespace organ_collision::node {
namespace {

/// x y z of each position in one flat array.
template <class Number>
core::Points pointsFrom(const std::vector<Number>& coordinates) {
  if (coordinates.size() % 3 != 0) {
    throw std::invalid_argument("positions holds " + std::to_string(coordinates.size()) +
                                " numbers: x, y and z are wanted of each vertex");
  }
  constexpr double kLargest = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const double coordinate = coordinates[i];
    if (!std::isfinite(coordinate) || std::abs(coordinate) <= kLargest) continue;
    std::ostringstream message;
    message
        << "positions[" << i << "] is " << coordinate
        << ": coordinates must fit into a 32-bit float, as those of files, and as rviz has them";
    throw std::invalid_argument(message.str());
  }
  core::Points points;
  points.reserve(coordinates.size() / 3);
  for (std::size_t i = 0; i < coordinates.size(); i += 3) {
    points.emplace_back(coordinates[i], coordinates[i + 1], coordinates[i + 2]);
  }
  return points;
}

std::vector<core::VertexId> vertexIds(const std::vector<std::uint32_t>& indices) {
  std::vector<core::VertexId> ids;
  ids.reserve(indices.size());
  for (const std::uint32_t index : indices) ids.push_back(core::VertexId{index});
  return ids;
}

/// The message does not tell the corners apart: they are numbered by the weights.
std::uint8_t featureFrom(core::Feature feature) {
  switch (feature) {
    case core::Feature::kVertexA:
    case core::Feature::kVertexB:
    case core::Feature::kVertexC:
      return NearestTriangle::VERTEX;
    case core::Feature::kEdgeAB:
    case core::Feature::kEdgeBC:
    case core::Feature::kEdgeCA:
      return NearestTriangle::EDGE;
    case core::Feature::kFace:
      break;
  }
  return NearestTriangle::FACE;
}

}  // namespace

geometry_msgs::Point toPoint(const Eigen::Vector3d& position) {
  geometry_msgs::Point point;
  point.x = position.x();
  point.y = position.y();
  point.z = position.z();
  return point;
}

geometry_msgs::Vector3 toVector(const Eigen::Vector3d& vector) {
  geometry_msgs::Vector3 message;
  message.x = vector.x();
  message.y = vector.y();
  message.z = vector.z();
  return message;
}

Eigen::Vector3d fromPoint(const geometry_msgs::Point& point) { return {point.x, point.y, point.z}; }

core::Accuracy fromMessage(const Accuracy& accuracy) {
  const core::Accuracy result = {accuracy.max_relative_error, accuracy.max_absolute_error,
                                 accuracy.max_leaves};
  core::requireUsable(result);
  return result;
}

NearestTriangle toMessage(const core::NearestTriangle& nearest,
                          const Eigen::Isometry3d& target_from_organ) {
  NearestTriangle message;
  message.triangle = static_cast<std::uint32_t>(nearest.triangle);
  message.feature = featureFrom(nearest.closest.feature);
  for (const int i : {0, 1, 2})
    message.barycentric[static_cast<std::size_t>(i)] = nearest.closest.barycentric[i];
  message.point = toPoint(target_from_organ * nearest.closest.point);
  message.normal = toVector(target_from_organ.linear() * nearest.normal);
  message.distance = nearest.distance;
  message.distance_signed = nearest.distance_signed;
  message.lower_bound = nearest.lower_bound;
  message.upper_bound = nearest.upper_bound;
  return message;
}

NearestTriangle noNearestTriangle(double lower_bound) {
  NearestTriangle message;
  message.distance = message.upper_bound = std::numeric_limits<double>::infinity();
  message.lower_bound = lower_bound;
  return message;
}

Proximity noProximity(double lower_bound) {
  Proximity message;
  message.distance = message.upper_bound = std::numeric_limits<double>::infinity();
  message.lower_bound = lower_bound;
  message.triangle_of_first = message.triangle_of_second = -1;
  return message;
}

std::uint8_t statusOf(bool is_late, bool is_far) {
  return is_late ? Contact::STALE : is_far ? Contact::OUT_OF_RANGE : Contact::OK;
}

Proximity toMessage(const core::Proximity& proximity) {
  const auto number = [](const std::optional<core::TriangleId>& triangle) {
    return triangle ? static_cast<std::int64_t>(*triangle) : -1;
  };
  Proximity message;
  message.colliding = proximity.colliding;
  message.colliding_certain = proximity.colliding_certain;
  message.point_on_first = toPoint(proximity.point_on_first);
  message.point_on_second = toPoint(proximity.point_on_second);
  message.normal = toVector(proximity.normal);
  message.distance = proximity.distance;
  message.lower_bound = proximity.lower_bound;
  message.upper_bound = proximity.upper_bound;
  message.triangle_of_first = number(proximity.triangle_of_first);
  message.triangle_of_second = number(proximity.triangle_of_second);
  return message;
}

MeshInfo toMessage(const Organ& organ) {
  const std::shared_ptr<const OrganSnapshot> snapshot = organ.snapshot();
  const core::CollisionMesh& mesh = snapshot->organ;
  const core::MeshHealth& health = mesh.health();
  const Organ::Counters counters = organ.counters();
  MeshInfo message;
  message.header.frame_id = organ.frame();
  message.organ = organ.name();
  message.mesh_version = snapshot->version;
  message.vertices = static_cast<std::uint32_t>(mesh.mesh().positions().size());
  message.triangles = static_cast<std::uint32_t>(mesh.mesh().triangleCount());
  message.degenerate_triangles = static_cast<std::uint32_t>(health.degenerate_triangles);
  message.duplicate_triangles = static_cast<std::uint32_t>(health.duplicate_triangles);
  message.closed = health.closed;
  message.consistently_wound = health.consistently_wound;
  message.inverted = health.inverted;
  message.min = toPoint(health.box.low);
  message.max = toPoint(health.box.high);
  message.depth = static_cast<std::uint32_t>(mesh.tree().depth());
  message.memory = mesh.memory();
  message.last_action = static_cast<std::uint8_t>(snapshot->last_action);
  message.reason = snapshot->reason;
  message.last_duration = snapshot->last_duration;
  message.cost_ratio = organ.costRatio();
  message.updates_merged = counters.updates_merged;
  message.updates_lost = counters.updates_lost;
  return message;
}

VertexMoves movesFrom(const MeshUpdate& update) {
  return {vertexIds(update.indices), pointsFrom(update.positions)};
}

VertexMoves movesFrom(const UpdateMesh::Request& request) {
  if (request.positions.empty() && !request.indices.empty()) {
    throw std::invalid_argument(std::to_string(request.indices.size()) +
                                " indices given without positions");
  }
  return {vertexIds(request.indices), pointsFrom(request.positions)};
}

core::TriangleMesh meshFrom(const UpdateMesh::Request& request) {
  if (!request.indices.empty()) {
    throw std::invalid_argument(
        "a new topology comes with all positions: indices must be empty, not " +
        std::to_string(request.indices.size()));
  }
  if (request.positions.empty())
    throw std::invalid_argument("a new topology comes with all positions: there are none");
  std::vector<core::Corners> triangles;
  triangles.reserve(request.triangles.size());
  for (const shape_msgs::MeshTriangle& triangle : request.triangles) {
    const auto& corners = triangle.vertex_indices;
    triangles.push_back(
        {core::VertexId{corners[0]}, core::VertexId{corners[1]}, core::VertexId{corners[2]}});
  }
  return {pointsFrom(request.positions), std::move(triangles)};
}

shape_msgs::Mesh toMessage(const core::TriangleMesh& mesh) {
  shape_msgs::Mesh message;
  message.vertices.reserve(mesh.positions().size());
  for (const Eigen::Vector3d& position : mesh.positions())
    message.vertices.push_back(toPoint(position));
  message.triangles.reserve(mesh.triangleCount());
  for (const core::Corners& corners : mesh.triangles()) {
    shape_msgs::MeshTriangle triangle;
    for (const std::size_t i : {0, 1, 2}) {
      triangle.vertex_indices[i] = static_cast<std::uint32_t>(corners[i]);
    }
    message.triangles.push_back(triangle);
  }
  return message;
}

io::Value fromParameter(XmlRpc::XmlRpcValue& parameter) {
  switch (parameter.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return static_cast<bool>(parameter);
    case XmlRpc::XmlRpcValue::TypeInt:
      return static_cast<int>(parameter);
    case XmlRpc::XmlRpcValue::TypeDouble:
      return static_cast<double>(parameter);
    case XmlRpc::XmlRpcValue::TypeString:
      return static_cast<std::string>(parameter);
    case XmlRpc::XmlRpcValue::TypeArray: {
      io::List list;
      for (int i = 0; i < parameter.size(); ++i) list.push_back(fromParameter(parameter[i]));
      return list;
    }
    case XmlRpc::XmlRpcValue::TypeStruct: {
      io::Map map;
      for (auto& [key, value] : parameter) map[key] = fromParameter(value);
      return map;
    }
    default:
      return {};
  }
}

}  // namespace organ_collision::node
