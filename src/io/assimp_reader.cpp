#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh_readers.h"
#include "shown.h"
#include "welded_mesh.h"

namespace organ_collision::io {
namespace {

/// Gathers the meshes of a scene into one.
class Gatherer {
 public:
  void add(const aiScene& scene, const aiNode& node, const Eigen::Matrix4d& root_from_parent) {
    const Eigen::Matrix4d root_from_node = root_from_parent * matrix(node);
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      if (root_from_node.topLeftCorner<3, 3>().determinant() == 0.0)
        refuse(node, "its scale, or the file's unit, is 0");
      const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
      if (mesh.HasBones()) refuse(node, "bones move its mesh");
      for (unsigned k = 0; k < mesh.mNumAnimMeshes; ++k)
        if (mesh.mAnimMeshes[k]->mWeight != 0.0F) refuse(node, "morph targets move its mesh");
      add(mesh, root_from_node);
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) {
      add(scene, *node.mChildren[i], root_from_node);
    }
  }

  core::TriangleMesh mesh() && { return std::move(welded_).mesh(); }

 private:
  [[noreturn]] static void refuse(const aiNode& node, const std::string& why) {
    throw std::invalid_argument(std::string("node '") + node.mName.C_Str() + "': " + why);
  }

  static Eigen::Matrix4d matrix(const aiNode& node) {
    constexpr double kAffine = 1e-5;  // importers invert some in single precision
    const aiMatrix4x4& m = node.mTransformation;
    Eigen::Matrix4d result;
    result << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2,
        m.d3, m.d4;
    if ((result.row(3) - Eigen::RowVector4d::UnitW()).cwiseAbs().maxCoeff() <= kAffine)
      return result;
    std::string row;
    for (const double number : result.row(3)) row += " " + shown(number);
    refuse(node, "the last row of its matrix is" + row + ", but 0 0 0 1 is wanted");
  }

  void add(const aiMesh& mesh, const Eigen::Matrix4d& root_from_node) {
    const bool mirrored = root_from_node.topLeftCorner<3, 3>().determinant() < 0.0;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines
      std::vector<core::VertexId> corners;
      for (unsigned k = 0; k < 3; ++k) {
        corners.push_back(vertex(mesh, face.mIndices[k], root_from_node));
      }
      if (mirrored) std::swap(corners[1], corners[2]);
      welded_.addTriangle(corners);
    }
  }

  core::VertexId vertex(const aiMesh& mesh, unsigned i, const Eigen::Matrix4d& root_from_node) {
    if (i >= mesh.mNumVertices) {
      throw std::invalid_argument("triangle " + std::to_string(welded_.triangleCount()) +
                                  " names a vertex that does not exist");
    }
    const aiVector3D& in_node = mesh.mVertices[i];
    const Eigen::Vector3d position =
        (root_from_node * Eigen::Vector4d(in_node.x, in_node.y, in_node.z, 1.0)).head<3>();
    return welded_.vertex(position);
  }

  WeldedMesh welded_;
};

/// Opens one file and no other that it may name: meshes may be read from one folder only. The first
/// other one is told.
class OneFile : public Assimp::DefaultIOSystem {
 public:
  OneFile(std::string name, std::string& other) : name_(std::move(name)), other_(other) {}

  bool Exists(const char* file) const override {
    return file == name_ && DefaultIOSystem::Exists(file);
  }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    if (file == name_) return DefaultIOSystem::Open(file, mode);
    if (other_.empty()) other_ = file;
    return nullptr;
  }

 private:
  std::string name_;
  std::string& other_;
};

/// Remembers the first that it is told of what was left out of a surface, or read as it is not.
class Losses : public Assimp::LogStream {
 public:
  explicit Losses(std::string& first) : first_(first) {}

  void write(const char* message) override {
    std::string_view line(message);
    line = line.substr(0, line.find_last_not_of('\n') + 1);
    if (!first_.empty() || !isLoss(line)) return;
    first_ = line.substr(line.find(": ") + 2);  // after the level and the thread
    std::replace(first_.begin(), first_.end(), '\n', ' ');
  }

 private:
  /// Errors are, though assimp went on; most warnings are of what has no shape, as materials.
  static bool isLoss(std::string_view line) {
    constexpr std::array<std::string_view, 4> kWarnings = {
        "dropped", "Failed to parse meter", "Unable to find geometry",
        "Unable to resolve reference to instanced node"};
    return line.substr(0, 5) == "Error" ||
           std::any_of(kWarnings.begin(), kWarnings.end(),
                       [&](std::string_view words) { return line.find(words) != line.npos; });
  }

  std::string& first_;
};

/// While it lives, assimp's log goes nowhere but here: what it says, `first_loss` keeps.
class LogOfLosses {
 public:
  explicit LogOfLosses(std::string& first_loss) {
    using Assimp::Logger;
    Assimp::DefaultLogger::create("", Logger::NORMAL, 0)
        ->attachStream(new Losses(first_loss), Logger::Warn | Logger::Err);  // NOLINT: it owns it
  }
  ~LogOfLosses() { Assimp::DefaultLogger::kill(); }
  LogOfLosses(const LogOfLosses&) = delete;
  LogOfLosses& operator=(const LogOfLosses&) = delete;
};

/// What is not of the format that the extension names, assimp reads by what is in it: also OBJ, PLY
/// and OFF, whose numbers it does not keep.
void requireRead(const Assimp::Importer& importer, const std::string& extension) {
  const int index = importer.GetPropertyInteger("importerIndex", -1);
  const aiImporterDesc* const format =
      index < 0 ? nullptr : importer.GetImporterInfo(static_cast<std::size_t>(index));
  if (format == nullptr) throw std::runtime_error("assimp does not say as what it read it");
  std::istringstream extensions(format->mFileExtensions);
  for (std::string each; extensions >> each;)
    if (extension == "." + each) return;
  throw std::invalid_argument("is no " + extension + ", but what the " + format->mName + " reads");
}

}  // namespace

core::TriangleMesh readWithAssimp(const std::filesystem::path& file, const std::string& extension) {
  std::string first_loss;
  const LogOfLosses log(first_loss);
  Assimp::Importer importer;
  if (!importer.IsExtensionSupported(extension))
    throw std::invalid_argument("the extension '" + extension + "' names no format of meshes");
  std::string other_file;
  importer.SetIOHandler(new OneFile(file.string(), other_file));  // NOLINT: the importer owns it
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);  // invented, to show bones
  const aiScene* const scene = importer.ReadFile(file.string(), aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    const std::string error = importer.GetErrorString();
    if (error == "std::bad_alloc") throw std::bad_alloc();
    if (!other_file.empty())
      throw std::invalid_argument("it needs another file, '" + other_file +
                                  "', but only itself is opened: save it as one file");
    if (error.find("No suitable reader found") == 0)
      throw std::invalid_argument("it does not begin as files of its extension do, or is broken");
    throw std::runtime_error(error.empty() ? "assimp cannot read it, and does not say why" : error);
  }
  requireRead(importer, extension);
  if (!first_loss.empty()) throw std::runtime_error("assimp says: " + first_loss);
  Gatherer gatherer;
  gatherer.add(*scene, *scene->mRootNode, Eigen::Matrix4d::Identity());
  return std::move(gatherer).mesh();
}

}  // namespace organ_collision::io
