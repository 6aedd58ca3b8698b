#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "organ_collision/core/collision_mesh.h"

namespace organ_collision::tools {

/// Where tips are: how far from the surface, and on which side.
struct Band {
  std::string name;
  double low, high;  ///< [m] outside: low <= distance < high; inside: how deep tips are tried
  bool inside;

  /// `distance` [m] is negative inside.
  bool contains(double distance) const {
    return inside ? distance < 0.0 : low <= distance && distance < high;
  }
};

/// 0-1, 1-5, 5-50 and 50-200 mm from the surface, and inside.
std::vector<Band> bands();

/// Tips [m] of a band, in the mesh's frame: points of the surface, equally dense, moved along the
/// normal by an equally distributed length, to either side; kept if their exact distance is in the
/// band. Fewer than `count` where the organ has no room for them: none inside of one that is no
/// solid. The same seed gives the same tips. Throws std::runtime_error if the organ has no area.
core::Points sampleTips(const core::CollisionMesh& organ, const Band& band, std::size_t count,
                        std::uint64_t seed);

/// The tips [m] of a CSV file with x,y,z in each line; the first line may be a header, empty lines
/// are skipped. Throws std::runtime_error naming file and line for anything else, or if there are
/// none.
core::Points readTips(const std::filesystem::path& file);

}  // namespace organ_collision::tools
