#pragma once

#include <XmlRpcValue.h>
#include <geometry_msgs/Point.h>
#include <geometry_msgs/Vector3.h>
#include <organ_collision/Accuracy.h>
#include <organ_collision/Contact.h>
#include <organ_collision/GetMesh.h>
#include <organ_collision/MeshInfo.h>
#include <organ_collision/MeshUpdate.h>
#include <organ_collision/NearestTriangle.h>
#include <organ_collision/Proximity.h>
#include <organ_collision/UpdateMesh.h>

#include <Eigen/Geometry>
#include <cstdint>

#include "node/organ.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/proximity.h"
#include "organ_collision/io/value.h"

// Between ROS messages and the library. Here a bare Accuracy or NearestTriangle is the message,
// core:: is ours.
namespace organ_collision::node {

geometry_msgs::Point toPoint(const Eigen::Vector3d& position);
geometry_msgs::Vector3 toVector(const Eigen::Vector3d& vector);
Eigen::Vector3d fromPoint(const geometry_msgs::Point& point);

/// Throws std::invalid_argument naming the field unless it is usable.
core::Accuracy fromMessage(const Accuracy& accuracy);

/// The answer in another frame.
NearestTriangle toMessage(const core::NearestTriangle& nearest,
                          const Eigen::Isometry3d& target_from_organ);

/// An answer that says nothing but that the distance is at least `lower_bound` [m].
NearestTriangle noNearestTriangle(double lower_bound);
Proximity noProximity(double lower_bound);

/// Of an answer, in contacts and proximities alike.
std::uint8_t statusOf(bool is_late, bool is_far);

/// Without names, status and times.
Proximity toMessage(const core::Proximity& proximity);

MeshInfo toMessage(const Organ& organ);

/// Throw std::invalid_argument if the numbers of coordinates and indices do not fit each other.
VertexMoves movesFrom(const MeshUpdate& update);
VertexMoves movesFrom(const UpdateMesh::Request& request);

/// The mesh of a request with triangles. Throws std::invalid_argument as core::TriangleMesh does,
/// or if there are indices.
core::TriangleMesh meshFrom(const UpdateMesh::Request& request);

shape_msgs::Mesh toMessage(const core::TriangleMesh& mesh);

/// A parameter as the scene parser takes it.
io::Value fromParameter(XmlRpc::XmlRpcValue& parameter);

}  // namespace organ_collision::node
