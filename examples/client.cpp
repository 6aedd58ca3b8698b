// A client: asks where the organ is nearest to a point, moves one vertex there up by 2 mm, and asks
// again.
//   rosrun organ_collision example_client ORGAN FRAME X Y Z
#include <geometry_msgs/Point.h>
#include <organ_collision/FindNearestTriangle.h>
#include <organ_collision/GetMesh.h>
#include <organ_collision/UpdateMesh.h>
#include <ros/ros.h>

#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace {

double number(const char* text) {
  char* end = nullptr;
  const double value = std::strtod(text, &end);
  if (end == text || *end != '\0')
    throw std::runtime_error("'" + std::string(text) + "' is no number");
  return value;
}

/// Calls a service of the node; a refusal becomes an exception.
template <class Service>
void call(const std::string& name, Service& service) {
  if (!ros::service::waitForService("organ_collision/" + name, 10000) ||
      !ros::service::call("organ_collision/" + name, service))
    throw std::runtime_error(name + " does not answer");
  if (!service.response.success) throw std::runtime_error(name + ": " + service.response.message);
}

organ_collision::FindNearestTriangleResponse nearest(
    const organ_collision::FindNearestTriangle& question) {
  organ_collision::FindNearestTriangle service = question;
  call("find_nearest_triangle", service);
  const auto& answer = service.response.nearest.front();
  ROS_INFO("version %u: triangle %u is nearest, %.4f m away", service.response.mesh_version,
           answer.triangle, answer.distance);
  return service.response;
}

bool isSame(const geometry_msgs::Point& left, const geometry_msgs::Point& right) {
  return left.x == right.x && left.y == right.y && left.z == right.z;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "example_client");
  if (argc != 6) {
    ROS_FATAL("usage: example_client ORGAN FRAME X Y Z");
    return 1;
  }
  const ros::NodeHandle node;
  try {
    organ_collision::FindNearestTriangle question;
    question.request.organ = argv[1];
    question.request.header.frame_id = argv[2];
    question.request.points.resize(1);
    question.request.points[0].x = number(argv[3]);
    question.request.points[0].y = number(argv[4]);
    question.request.points[0].z = number(argv[5]);
    const auto before = nearest(question);

    organ_collision::GetMesh mesh;
    mesh.request.organ = argv[1];
    call("get_mesh", mesh);
    if (mesh.response.mesh_version != before.mesh_version)
      throw std::runtime_error("the organ has moved meanwhile");
    const auto& triangle = mesh.response.mesh.triangles[before.nearest.front().triangle];
    const auto& vertices = mesh.response.mesh.vertices;
    const geometry_msgs::Point& position = vertices[triangle.vertex_indices[0]];

    organ_collision::UpdateMesh update;
    update.request.organ = argv[1];
    update.request.header.frame_id = mesh.response.frame_id;
    update.request.expected_version = mesh.response.mesh_version;
    for (std::uint32_t i = 0; i < vertices.size(); ++i) {  // and those that coincide, if any
      if (!isSame(vertices[i], position)) continue;
      update.request.indices.push_back(i);
      for (const double coordinate : {position.x, position.y, position.z + 0.002})  // 2 mm up
        update.request.positions.push_back(coordinate);
    }
    call("update_mesh", update);
    nearest(question);
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
