#include "organ_collision/io/mesh_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mesh_writers.h"
#include "organ_collision/core/collision_mesh.h"
#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::io {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

class EveryFormat : public MeshIo, public testing::WithParamInterface<Format> {};

INSTANTIATE_TEST_SUITE_P(MeshIo, EveryFormat, testing::ValuesIn(kFormats),
                         [](const auto& param) { return std::string(param.param.name); });

TEST_P(EveryFormat, KeepsItsNumbers) {
  const Shape shape = awkwardShape();
  const core::TriangleMesh mesh = load(GetParam().file, GetParam().bytes(shape));
  expectSame(mesh, GetParam().is_indexed ? shape : merged(shape));
}

TEST_P(EveryFormat, IsScaledToMetres) {
  Shape shape = awkwardShape();
  const auto file = folder_.write(GetParam().file, GetParam().bytes(shape));
  for (auto& position : shape.positions) position *= 0.001;
  EXPECT_EQ(loadMesh(file, 0.001).positions(),
            (GetParam().is_indexed ? shape : merged(shape)).positions);
}

TEST_P(EveryFormat, IsKnownByItsExtensionInCapitalsToo) {
  std::string name = GetParam().file;
  std::transform(name.begin(), name.end(), name.begin(), ::toupper);
  EXPECT_EQ(load(name, GetParam().bytes(awkwardShape())).triangleCount(), 6u);
}

TEST_P(EveryFormat, IsRefusedWhenEmptyOrGarbage) {
  EXPECT_THAT(refusal(GetParam().file, ""), HasSubstr("is empty"));
  std::mt19937 random(7);
  std::string garbage(1000, '\0');
  for (char& byte : garbage) byte = static_cast<char>(random());
  EXPECT_THAT(refusal(GetParam().file, garbage), HasSubstr(GetParam().file));
  EXPECT_THAT(refusal(GetParam().file, std::string(1000, '\0')), HasSubstr(GetParam().file));
}

TEST_P(EveryFormat, IsRefusedOrShorterWhenCutShort) {
  const std::string bytes = GetParam().bytes(awkwardShape());
  for (const double part : {0.01, 0.1, 0.3, 0.5, 0.7, 0.9}) {
    const auto length = static_cast<std::size_t>(part * static_cast<double>(bytes.size()));
    try {
      EXPECT_LT(load(GetParam().file, bytes.substr(0, length)).triangleCount(), 6u) << part;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr(GetParam().file));
    }
  }
}

// ---- hostile files

/// Words that readers stumble over.
const std::vector<std::string> kNasty = {
    "-1", "0",  "nan", "inf", "1e39", "4294967295", "-2147483648", "99999999999999999999",
    "#",  "\n", "",    "f"};

std::string mutant(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return random() % std::max<std::size_t>(n, 1); };
  for (std::size_t rounds = 1 + below(4); rounds > 0; --rounds) {
    const std::size_t at = below(bytes.size());
    switch (below(6)) {
      case 0:
        if (!bytes.empty()) bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes.erase(at, 1 + below(20));
        break;
      case 2:
        bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(40)));
        break;
      case 3:
        bytes.resize(at);
        break;
      default: {  // a word becomes a nasty one
        const std::size_t begin = bytes.find_first_not_of(" \n", bytes.find_first_of(" \n", at));
        if (begin == std::string::npos) break;
        const std::size_t end = bytes.find_first_of(" \n", begin);
        bytes.replace(begin, end - begin, kNasty[below(kNasty.size())]);
      }
    }
  }
  return bytes;
}

/// Whatever a reader lets through, the rest must bear.
void askAsTheNodeDoes(core::TriangleMesh mesh) {
  const core::CollisionMesh organ(std::move(mesh));
  for (const Eigen::Vector3d& tip : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1e3, -7, 1e-3)}) {
    const core::NearestTriangle nearest = core::nearestTriangle(organ, tip);
    EXPECT_TRUE(std::isfinite(nearest.distance)) << nearest.distance;
    EXPECT_EQ(nearest.lower_bound, nearest.upper_bound);
  }
}

TEST_P(EveryFormat, AnswersEveryMutantInTime) {
  const std::size_t mutants = roundCount(300);
  constexpr double kSlack = 4.0;  // [s] for a busy machine
  LoadLimits limits;
  if (!GetParam().is_indexed) limits.seconds = 0.3;  // assimp hangs now and then
  const std::string bytes = GetParam().bytes(awkwardShape());
  std::mt19937 random(2012);
  std::size_t accepted = 0;
  double slowest = 0.0;
  for (std::size_t i = 0; i < mutants; ++i) {
    const auto file = folder_.write(GetParam().file, mutant(bytes, random));
    const auto begin = std::chrono::steady_clock::now();
    const std::string message = messageOf([&] { askAsTheNodeDoes(loadMesh(file, 1.0, limits)); });
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    slowest = std::max(slowest, taken.count());
    accepted += message.empty() ? 1U : 0U;
    if (!GetParam().is_indexed) continue;  // assimp crashes now and then
    EXPECT_THAT(message, Not(AnyOf(HasSubstr("crashed"), HasSubstr("exit code"),
                                   HasSubstr("took longer"), HasSubstr("memory"))))
        << "mutant " << i;
  }
  std::cout << mutants << " mutants, " << accepted << " accepted, slowest " << slowest << " s\n";
  EXPECT_LT(slowest, limits.seconds + kSlack);
  EXPECT_GT(accepted, 0);
  EXPECT_LT(accepted, mutants);
}

// ---- files that are none

TEST_F(MeshIo, RefusesAnythingButARegularFileAtOnce) {
  const auto refusalOf = [](const std::filesystem::path& file) {
    return messageOf([&] { loadMesh(file); });
  };
  EXPECT_EQ(refusalOf("/nowhere/liver.obj"),
            "mesh '/nowhere/liver.obj': No such file or directory");
  EXPECT_THAT(refusalOf(folder_.path()), HasSubstr("is not a regular file"));
  EXPECT_EQ(refusalOf("/dev/zero"), "mesh '/dev/zero': is not a regular file");
  const std::filesystem::path fifo = folder_.path() / "fifo.obj";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_THAT(refusalOf(fifo), HasSubstr("fifo.obj': is not a regular file"));
}

TEST_F(MeshIo, RefusesAFormatThatItDoesNotKnow) {
  // Its contents tell a format; what an extension names is not told by them.
  EXPECT_THAT(refusal("mesh.txt", obj(awkwardShape())),
              AllOf(HasSubstr("mesh.txt"), HasSubstr("'.txt' names no format")));
  EXPECT_THAT(refusal("mesh", obj(awkwardShape())), HasSubstr("'' names no format"));
}

TEST_F(MeshIo, RefusesAFileThatIsTooLarge) {
  const auto file = folder_.write("m.obj", obj(awkwardShape()));
  LoadLimits limits;
  limits.file = std::filesystem::file_size(file);
  EXPECT_EQ(loadMesh(file, 1.0, limits).triangleCount(), 6u);
  --limits.file;
  EXPECT_THAT(messageOf([&] { loadMesh(file, 1.0, limits); }), HasSubstr("more than the "));
}

TEST_F(MeshIo, KeepsItsTimeLimit) {
  std::string long_to_read = obj(awkwardShape());
  for (int i = 0; i < 200'000; ++i)
    long_to_read += "# on a busy machine a short file may be read first\n";
  const auto file = folder_.write("m.obj", long_to_read);
  LoadLimits limits;
  limits.seconds = limits.seconds_per_megabyte = 0.0;
  EXPECT_THAT(messageOf([&] { loadMesh(file, 1.0, limits); }), HasSubstr("took longer than 0 s"));
}

TEST_F(MeshIo, AllowsMoreTimeAndMemoryForALargerFile) {
  const auto file = folder_.write("m.obj", obj(awkwardShape()));
  LoadLimits limits;
  limits.seconds = 0.0;
  limits.seconds_per_megabyte = 1e6;
  EXPECT_EQ(loadMesh(file, 1.0, limits).triangleCount(), 6u);
  limits = {};
  limits.memory = 0;
  limits.memory_per_byte = 1'000'000;
  EXPECT_EQ(loadMesh(file, 1.0, limits).triangleCount(), 6u);
}

TEST_F(MeshIo, ReadsPlyItselfInCapitalsToo) {
  EXPECT_THAT(messageOf([&] { loadMesh(folder_.write("m.PLY", "plx\n")); }),
              HasSubstr("the word ply is wanted"));
}

TEST_F(MeshIo, RefusesAScaleThatIsNotAboveZero) {
  const auto file = folder_.write("m.obj", obj(awkwardShape()));
  for (const double scale : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(loadMesh(file, scale), std::invalid_argument);
  }
  EXPECT_THAT(messageOf([&] { loadMesh(file, -2.0); }),
              HasSubstr("m.obj': the scale is -2, but it must be a finite number above 0"));
  EXPECT_THAT(messageOf([&] { loadMesh(file, 1e200); }), HasSubstr("m.obj': vertex 0 is at"));
}

// ---- transformed

core::TriangleMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}},
          {{core::VertexId{0}, core::VertexId{2}, core::VertexId{1}},
           {core::VertexId{0}, core::VertexId{1}, core::VertexId{3}},
           {core::VertexId{0}, core::VertexId{3}, core::VertexId{2}},
           {core::VertexId{1}, core::VertexId{2}, core::VertexId{3}}}};
}

/// Positive if the triangles face outwards.
double volume(const core::TriangleMesh& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const core::Triangle t = mesh.triangle(core::TriangleId{static_cast<std::uint32_t>(i)});
    sum += t.a.dot(t.b.cross(t.c)) / 6.0;
  }
  return sum;
}

TEST(Transformed, ScalesFirstAndMovesThen) {
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  origin.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // a quarter turn: x to y, y to -x
  origin.translation() << 10, 20, 30;
  const core::TriangleMesh moved = transformed(tetrahedron(), {2, 3, 4}, origin);
  EXPECT_EQ(moved.positions(),
            core::Points({{10, 20, 30}, {10, 22, 30}, {4, 20, 30}, {10, 20, 42}}));
  EXPECT_EQ(moved.triangles(), tetrahedron().triangles());
}

TEST(Transformed, KeepsOutsideOutsideUnderAMirror) {
  ASSERT_EQ(volume(tetrahedron()), 1.0);
  const Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  for (const Eigen::Vector3d& scale :
       {Eigen::Vector3d(-1, 1, 1), Eigen::Vector3d(1, -1, -1), Eigen::Vector3d(-1, -1, -1)}) {
    EXPECT_EQ(volume(transformed(tetrahedron(), scale, origin)), 1.0) << scale.transpose();
  }
}

TEST(Transformed, RefusesWhatWouldLoseTheMesh) {
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  for (const double factor : {0.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(transformed(tetrahedron(), {1, factor, 1}, here), std::invalid_argument);
  }
  EXPECT_EQ(messageOf([&] {
              transformed(tetrahedron(), {1, 0, 1}, here);
            }),
            "the scale is (1 0 1), but it must be finite and not 0");
  Eigen::Isometry3d nowhere = here;
  nowhere.translation().x() = std::nan("");
  EXPECT_THROW(transformed(tetrahedron(), {1, 1, 1}, nowhere), std::invalid_argument);
}

// ---- real organs

std::size_t linesBeginningWith(const std::filesystem::path& file, const std::string& beginning) {
  std::ifstream stream(file);
  std::size_t count = 0;
  for (std::string line; std::getline(stream, line);) {
    if (line.compare(0, beginning.size(), beginning) == 0) ++count;
  }
  return count;
}

TEST(RealOrgans, HaveAsManyVerticesAndTrianglesAsLines) {
  const char* const folder = std::getenv("ORGAN_MESHES");
  if (folder == nullptr) GTEST_SKIP() << "ORGAN_MESHES does not name a folder with organs";
  int organs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".obj") continue;
    ++organs;
    const auto begin = std::chrono::steady_clock::now();
    const core::TriangleMesh mesh = loadMesh(entry.path());
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    EXPECT_EQ(mesh.positions().size(), linesBeginningWith(entry.path(), "v ")) << entry.path();
    EXPECT_EQ(mesh.triangleCount(), linesBeginningWith(entry.path(), "f ")) << entry.path();
    std::cout << entry.path().filename() << ": " << mesh.triangleCount() << " triangles in "
              << taken.count() << " s\n";
  }
  EXPECT_GT(organs, 0) << folder;
}

}  // namespace
}  // namespace organ_collision::io
