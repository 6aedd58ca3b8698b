// The triangle of a mesh nearest to a point. Usage: nearest MESH X Y Z
#include <exception>
#include <iostream>
#include <string>

#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/io/mesh_io.h"

int main(int argc, char** argv) try {
  if (argc != 5) return 2;
  const organ_collision::core::CollisionMesh organ(organ_collision::io::loadMesh(argv[1]));
  const Eigen::Vector3d tip(std::stod(argv[2]), std::stod(argv[3]), std::stod(argv[4]));
  const organ_collision::core::NearestTriangle nearest =
      organ_collision::core::nearestTriangle(organ, tip);
  std::cout << "triangle " << organ_collision::core::index(nearest.triangle) << " at "
            << nearest.distance << " m\n";
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
