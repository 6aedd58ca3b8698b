#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "organ_collision/core/instrument.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/io/value.h"

namespace organ_collision::io {

/// A file: package://PACKAGE/PATH or a path.
struct MeshFile {
  std::string url;
  double scale = 1.0;  ///< [m] per unit of the file
};

/// The <collision> of a link of the robot description, with scales and origins. An organ's is one
/// mesh, an instrument's any number of meshes, spheres, boxes and cylinders.
struct RobotLink {
  std::string name;
};

struct Organ {
  std::string name;
  std::string frame;  ///< tf frame that the vertices are in
  std::variant<MeshFile, RobotLink> geometry;
};

struct Instrument {
  std::string name;
  std::string frame;  ///< tf frame of the tip, or of the link
  /// [m] in the tip's frame; a point and a sphere are at its origin.
  std::variant<core::Shape, MeshFile, RobotLink> geometry;
  bool convex = false;  ///< against convex or round pieces of other instruments its meshes count as
                        ///< their convex hulls
};

/// Indices into Scene::instruments and Scene::organs.
struct Pair {
  std::size_t instrument;
  std::size_t organ;
};

/// Two instruments or two organs, in the order given.
struct LikePair {
  enum class Of { kInstruments, kOrgans };
  Of of;
  std::size_t first, second;  ///< indices into Scene::instruments or Scene::organs
};

/// Of a scene's accuracy; as far as dynamic_reconfigure goes, too.
constexpr double kLargestRelativeError = 10.0;
constexpr double kLargestAbsoluteError = 1.0;  // [m]

/// What the parameter `scene` says: who is compared with whom, and how.
struct Scene {
  std::string frame;  ///< tf frame of everything published
  std::vector<Organ> organs;
  std::vector<Instrument> instruments;
  std::vector<Pair> pairs;
  std::vector<LikePair> like_pairs;
  double max_distance = std::numeric_limits<double>::infinity();  ///< [m] beyond: out of range
  core::Accuracy accuracy;
  double rate = 1000.0;                            ///< [Hz] most cycles; at least 10
  double stale_after = 0.1;                        ///< [s] an older pose is stale
  std::optional<std::filesystem::path> mesh_root;  ///< where meshes may be read; none: anywhere
};

/// The scene that `value`, a map, describes; config/all_keys.yaml has all keys. What is left out
/// has the defaults above; `frame` is then the first organ's, `pairs` each instrument with each
/// organ and no others. Throws std::invalid_argument naming the key's path, its value and what was
/// wanted, such as "scene.organs[1].scale: -2, but it must be a finite number above 0". Unknown
/// keys are refused too.
Scene parseScene(const Value& value);

/// All that a scene may have.
constexpr std::array<const char*, 9> kSceneKeys = {"frame", "organs",       "instruments",
                                                   "pairs", "max_distance", "accuracy",
                                                   "rate",  "stale_after",  "mesh_root"};

}  // namespace organ_collision::io
