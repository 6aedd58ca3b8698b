// A mesh against a copy of itself that was moved. Usage: contact MESH X Y Z
#include "organ_collision/core/contact.h"

#include <exception>
#include <iostream>
#include <memory>
#include <string>

#include "organ_collision/io/mesh_io.h"

int main(int argc, char** argv) try {
  namespace core = organ_collision::core;
  if (argc != 5) return 2;
  const auto organ =
      std::make_shared<const core::CollisionMesh>(organ_collision::io::loadMesh(argv[1]));
  core::RigidMesh moved{organ, core::Pose::Identity()};
  moved.pose.translation() =
      Eigen::Vector3d(std::stod(argv[2]), std::stod(argv[3]), std::stod(argv[4]));
  const core::Contact found = core::contact(*organ, core::Shape(moved));
  std::cout << "triangle " << core::index(found.nearest.triangle) << " at "
            << found.nearest.distance << " m\n";
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
