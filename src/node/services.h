#pragma once

#include <organ_collision/FindNearestTriangle.h>
#include <organ_collision/FindTrianglesWithin.h>
#include <organ_collision/GetMesh.h>
#include <organ_collision/UpdateMesh.h>
#include <ros/ros.h>
#include <tf2/buffer_core.h>

#include <functional>
#include <vector>

#include "node/frame_lookup.h"
#include "node/organ.h"

namespace organ_collision::node {

/// What callers ask of the organs. What is wrong with a request becomes its answer's message. Any
/// number of threads may answer at once.
class Services {
 public:
  /// Both must outlive this. `publish_mesh_info` is called, by a thread that answers, when an organ
  /// has changed.
  Services(const Organs& organs, const tf2::BufferCore& buffer,
           std::function<void()> publish_mesh_info);

  /// Answers from now on what comes to `node`, and what changes a mesh, which may take long, by the
  /// callback queue of `changes`: the same name, other threads.
  void advertise(ros::NodeHandle& node, ros::NodeHandle& changes);

 private:
  bool findNearestTriangle(FindNearestTriangle::Request& request,
                           FindNearestTriangle::Response& response);
  bool findTrianglesWithin(FindTrianglesWithin::Request& request,
                           FindTrianglesWithin::Response& response);
  bool updateMesh(UpdateMesh::Request& request, UpdateMesh::Response& response);
  bool getMesh(GetMesh::Request& request, GetMesh::Response& response);
  FramePose waitForPose(const Organ& organ, const std_msgs::Header& header) const;

  const Organs& organs_;
  const tf2::BufferCore& buffer_;
  const std::function<void()> publish_mesh_info_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace organ_collision::node
