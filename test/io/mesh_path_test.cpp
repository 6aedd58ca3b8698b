#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>

#include "organ_collision/io/mesh_io.h"
#include "temporary_folder.h"

namespace organ_collision::io {
namespace {

using testing::HasSubstr;

class ResolveMesh : public testing::Test {
 protected:
  ResolveMesh() {
    folder_.write("packages/organs/meshes/liver.obj", "v");
    folder_.write("secret.obj", "v");
    std::filesystem::create_symlink(root() / "secret.obj", package() / "meshes/link.obj");
    std::filesystem::create_symlink(package(), root() / "alias");
  }
  const std::filesystem::path& root() const { return folder_.path(); }
  std::filesystem::path package() const { return root() / "packages/organs"; }
  std::filesystem::path resolve(const std::string& url,
                                const std::optional<std::filesystem::path>& mesh_root = {}) const {
    const auto find = [this](const std::string& name) -> std::optional<std::filesystem::path> {
      if (name == "organs") return package();
      return std::nullopt;
    };
    return resolveMesh(url, find, mesh_root);
  }
  std::string refusal(const std::string& url,
                      const std::optional<std::filesystem::path>& mesh_root = {}) const {
    return messageOf([&] { resolve(url, mesh_root); });
  }

  TemporaryFolder folder_;
};

TEST_F(ResolveMesh, FindsAFileInAPackage) {
  EXPECT_EQ(resolve("package://organs/meshes/liver.obj"), package() / "meshes/liver.obj");
  EXPECT_EQ(resolve("package://organs//meshes/liver.obj"), package() / "meshes/liver.obj");
}

TEST_F(ResolveMesh, TakesPlainPaths) {
  EXPECT_EQ(resolve((root() / "secret.obj").string()), root() / "secret.obj");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(package());
  EXPECT_EQ(resolve("meshes/liver.obj"), package() / "meshes/liver.obj");
  EXPECT_EQ(resolve("../../secret.obj"), root() / "secret.obj");
  std::filesystem::current_path(before);
}

TEST_F(ResolveMesh, TakesAColonBehindASlashForPartOfAName) {
  std::filesystem::create_directory(root() / "09:30");
  std::filesystem::copy_file(root() / "secret.obj", root() / "09:30/liver.obj");
  EXPECT_EQ(resolve((root() / "09:30/liver.obj").string()), root() / "09:30/liver.obj");
}

TEST_F(ResolveMesh, FollowsLinks) {
  EXPECT_EQ(resolve((root() / "alias/meshes/link.obj").string()), root() / "secret.obj");
}

TEST_F(ResolveMesh, RefusesOtherSchemesByName) {
  for (const std::string scheme : {"file", "http", "https", "model", "FILE", "Package"}) {
    for (const std::string slashes : {"://", ":/", ":"}) {
      const std::string url = scheme + slashes + (root() / "secret.obj").string();
      EXPECT_EQ(refusal(url),
                "mesh '" + url + "': the scheme '" + scheme +
                    "' is not supported: package://PACKAGE/PATH or a plain path is wanted");
    }
  }
}

TEST_F(ResolveMesh, NamesTheResolvedPathOfAMissingFile) {
  EXPECT_EQ(refusal("package://organs/meshes/spleen.obj"),
            "mesh 'package://organs/meshes/spleen.obj': the file '" +
                (package() / "meshes/spleen.obj").string() + "': No such file or directory");
  const std::string relative = "no/such.obj";
  EXPECT_THAT(refusal(relative), HasSubstr((std::filesystem::current_path() / relative).string()));
}

TEST_F(ResolveMesh, RefusesAPackageThatIsUnknownOrWithoutAPath) {
  EXPECT_THAT(refusal("package://lungs/left.obj"), HasSubstr("there is no package 'lungs'"));
  for (const char* const url :
       {"package://", "package://organs", "package://organs/", "package:///x"}) {
    EXPECT_THAT(refusal(url), HasSubstr("package://PACKAGE/PATH is wanted")) << url;
  }
  EXPECT_EQ(refusal(""), "mesh '': it is empty");
}

TEST_F(ResolveMesh, StaysBelowTheMeshRoot) {
  EXPECT_EQ(resolve("package://organs/meshes/liver.obj", package()),
            package() / "meshes/liver.obj");
  EXPECT_EQ(resolve("package://organs/meshes/liver.obj", root() / "alias"),
            package() / "meshes/liver.obj");
  EXPECT_EQ(resolve((root() / "secret.obj").string(), "/"), root() / "secret.obj");
  const std::string outside = "the file '" + (root() / "secret.obj").string() +
                              "' is not below the mesh_root '" + package().string() + "'";
  for (const std::string& url :
       {std::string("package://organs/../../secret.obj"),
        std::string("package://organs/meshes/link.obj"), (root() / "secret.obj").string(),
        (package() / "../../secret.obj").string()}) {
    EXPECT_EQ(refusal(url, package()), "mesh '" + url + "': " + outside);
  }
}

TEST_F(ResolveMesh, IsNotFooledByASiblingThatBeginsAlike) {
  folder_.write("packages/organs_secret/liver.obj", "v");
  const std::string sibling = (root() / "packages/organs_secret/liver.obj").string();
  EXPECT_THAT(refusal(sibling, package()), HasSubstr("is not below the mesh_root"));
}

TEST_F(ResolveMesh, RefusesAMeshRootThatIsNotThere) {
  EXPECT_THAT(refusal("package://organs/meshes/liver.obj", root() / "nowhere"),
              HasSubstr("the mesh_root '" + (root() / "nowhere").string() + "'"));
}

}  // namespace
}  // namespace organ_collision::io
