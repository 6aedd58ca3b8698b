#include <algorithm>
#include <stdexcept>
#include <string>
#include <system_error>

#include "organ_collision/io/mesh_io.h"

namespace organ_collision::io {
namespace {

[[noreturn]] void refuseMesh(const std::string& url, const std::string& why) {
  throw std::invalid_argument("mesh '" + url + "': " + why);
}

std::filesystem::path inPackage(const std::string& url, std::string_view rest,
                                const PackageFinder& find_package) {
  const std::size_t slash = rest.find('/');
  const std::string package(rest.substr(0, slash));
  const std::string path(slash == std::string_view::npos ? "" : rest.substr(slash + 1));
  if (package.empty() || path.empty()) refuseMesh(url, "package://PACKAGE/PATH is wanted");
  const std::optional<std::filesystem::path> folder = find_package(package);
  if (!folder) refuseMesh(url, "there is no package '" + package + "'");
  return *folder / std::filesystem::path(path).relative_path();  // PATH may begin with a slash
}

std::filesystem::path canonical(const std::string& url, const std::filesystem::path& path,
                                const std::string& role) {
  std::error_code error;
  std::filesystem::path result = std::filesystem::canonical(path, error);
  if (error) {
    const std::string where = std::filesystem::absolute(path).lexically_normal().string();
    refuseMesh(url, role + " '" + where + "': " + error.message());
  }
  return result;
}

bool isBelow(const std::filesystem::path& file, const std::filesystem::path& root) {
  return std::mismatch(root.begin(), root.end(), file.begin(), file.end()).first == root.end();
}

}  // namespace

std::filesystem::path resolveMesh(const std::string& url, const PackageFinder& find_package,
                                  const std::optional<std::filesystem::path>& mesh_root) {
  constexpr std::string_view kPackage = "package://";
  if (url.empty()) refuseMesh(url, "it is empty");
  const bool in_package = url.compare(0, kPackage.size(), kPackage) == 0;
  if (const std::size_t colon = url.substr(0, url.find('/')).find(':');
      !in_package && colon != std::string::npos) {
    refuseMesh(url, "the scheme '" + url.substr(0, colon) +
                        "' is not supported: package://PACKAGE/PATH or a plain path is wanted");
  }
  const std::filesystem::path path =
      in_package ? inPackage(url, std::string_view(url).substr(kPackage.size()), find_package)
                 : std::filesystem::path(url);
  std::filesystem::path file = canonical(url, path, "the file");
  if (!mesh_root) return file;
  const std::filesystem::path root = canonical(url, *mesh_root, "the mesh_root");
  if (!isBelow(file, root)) {
    refuseMesh(
        url, "the file '" + file.string() + "' is not below the mesh_root '" + root.string() + "'");
  }
  return file;
}

}  // namespace organ_collision::io
