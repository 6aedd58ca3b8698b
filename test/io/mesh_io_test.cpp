#include "organ_collision/io/mesh_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <random>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "organ_collision/core/collision_mesh.h"
#include "organ_collision/core/nearest_triangle.h"
#include "temporary_folder.h"

namespace organ_collision::io {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

using Faces = std::vector<std::vector<int>>;

struct Shape {
  core::Points positions;
  Faces faces;
};

/// A tetrahedron with what makes numbers shift when a reader is clever: vertex 0 is named by no
/// face, vertex 4 repeats vertex 1, the order of first appearance is not that of the numbers, one
/// triangle comes twice, one has no area. All coordinates are exact in float32.
Shape awkwardShape() {
  return {{{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1.5, 0}, {0, 0, 0}, {0, 0, -0.25}},
          {{5, 3, 2}, {1, 3, 2}, {4, 5, 3}, {1, 2, 5}, {4, 5, 3}, {2, 2, 3}}};
}

// ---- writers

std::string obj(const Shape& shape) {
  std::ostringstream text;
  text << "# by hand\nmtllib none.mtl\no organ\n";
  for (const auto& p : shape.positions) text << "v " << p.transpose() << "\n";
  for (const auto& face : shape.faces) {
    text << "f";
    for (const int corner : face) text << " " << corner + 1;
    text << "\n";
  }
  return text.str();
}

std::string off(const Shape& shape) {
  std::ostringstream text;
  text << "OFF\n# by hand\n" << shape.positions.size() << " " << shape.faces.size() << " 0\n";
  for (const auto& p : shape.positions) text << p.transpose() << "\n";
  for (const auto& face : shape.faces) {
    text << face.size();
    for (const int corner : face) text << " " << corner;
    text << "\n";
  }
  return text.str();
}

std::string plyHeader(const Shape& shape, const std::string& format) {
  std::ostringstream text;
  text << "ply\nformat " << format << " 1.0\ncomment by hand\nelement vertex "
       << shape.positions.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement "
          "face "
       << shape.faces.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  return text.str();
}

std::string asciiPly(const Shape& shape) {
  std::ostringstream text;
  text << plyHeader(shape, "ascii");
  for (const auto& p : shape.positions) text << p.transpose() << " 255\n";
  for (const auto& face : shape.faces) {
    text << face.size();
    for (const int corner : face) text << " " << corner;
    text << "\n";
  }
  return text.str();
}

template <typename Number>
void put(std::string& bytes, Number number, bool swapped = false) {
  std::string raw(sizeof number, '\0');
  std::memcpy(raw.data(), &number, sizeof number);
  if (swapped) std::reverse(raw.begin(), raw.end());
  bytes += raw;
}

std::string binaryPly(const Shape& shape, bool big_endian) {
  std::string bytes = plyHeader(shape, big_endian ? "binary_big_endian" : "binary_little_endian");
  for (const auto& p : shape.positions) {
    for (const double coordinate : p) put(bytes, static_cast<float>(coordinate), big_endian);
    put(bytes, std::uint8_t{255});
  }
  for (const auto& face : shape.faces) {
    put(bytes, static_cast<std::uint8_t>(face.size()));
    for (const int corner : face) put(bytes, corner, big_endian);
  }
  return bytes;
}

std::string littlePly(const Shape& shape) { return binaryPly(shape, false); }
std::string bigPly(const Shape& shape) { return binaryPly(shape, true); }

std::string asciiStl(const Shape& shape) {
  std::ostringstream text;
  text << "solid organ\n";
  for (const auto& face : shape.faces) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const int corner : face) text << "vertex " << shape.positions[corner].transpose() << "\n";
    text << "endloop\nendfacet\n";
  }
  text << "endsolid organ\n";
  return text.str();
}

std::string binaryStl(const Shape& shape) {
  std::string bytes(80, ' ');
  put(bytes, static_cast<std::uint32_t>(shape.faces.size()));
  for (const auto& face : shape.faces) {
    for (int i = 0; i < 3; ++i) put(bytes, 0.0f);
    for (const int corner : face) {
      for (const double coordinate : shape.positions[corner]) {
        put(bytes, static_cast<float>(coordinate));
      }
    }
    put(bytes, std::uint16_t{0});
  }
  return bytes;
}

/// `unit` [m]; `transform` is the <node>'s content.
std::string dae(const Shape& shape, const std::string& unit, const std::string& transform) {
  std::ostringstream text;
  text << R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" )"
       << R"(version="1.4.1"><asset><unit name="u" meter=")" << unit
       << R"("/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>)"
       << R"(<source id="p"><float_array id="a" count=")" << 3 * shape.positions.size() << "\">";
  for (const auto& p : shape.positions) text << p.transpose() << " ";
  text << R"(</float_array><technique_common><accessor source="#a" count=")"
       << shape.positions.size()
       << R"(" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>)"
       << R"(<param name="Z" type="float"/></accessor></technique_common></source>)"
       << R"(<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>)"
       << "<triangles count=\"" << shape.faces.size()
       << R"("><input semantic="VERTEX" source="#v" offset="0"/><p>)";
  for (const auto& face : shape.faces) {
    for (const int corner : face) text << corner << " ";
  }
  text << R"(</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>)"
       << R"(<visual_scene id="s"><node id="n">)" << transform
       << R"(<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>)"
       << R"(<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  return text.str();
}

std::string plainDae(const Shape& shape) { return dae(shape, "1", ""); }

struct Format {
  const char* name;
  const char* file;
  std::string (*bytes)(const Shape&);
  bool is_indexed;  ///< the file has vertex numbers, and we read it ourselves
};

const std::vector<Format> kFormats = {{"obj", "m.obj", obj, true},
                                      {"off", "m.off", off, true},
                                      {"ascii_ply", "m.ply", asciiPly, true},
                                      {"little_endian_ply", "m.ply", littlePly, true},
                                      {"big_endian_ply", "m.ply", bigPly, true},
                                      {"ascii_stl", "m.stl", asciiStl, false},
                                      {"binary_stl", "m.stl", binaryStl, false},
                                      {"dae", "m.dae", plainDae, false}};

// ---- what is expected

Faces facesOf(const core::TriangleMesh& mesh) {
  Faces faces;
  for (const core::Corners& corners : mesh.triangles()) {
    faces.push_back({});
    for (const core::VertexId id : corners) faces.back().push_back(static_cast<int>(index(id)));
  }
  return faces;
}

void expectSame(const core::TriangleMesh& mesh, const Shape& shape) {
  EXPECT_EQ(mesh.positions(), shape.positions);
  EXPECT_EQ(facesOf(mesh), shape.faces);
}

/// Vertices of equal position merged, numbered in the order of first appearance.
Shape merged(const Shape& shape) {
  Shape result;
  for (const auto& face : shape.faces) {
    result.faces.push_back({});
    for (const int corner : face) {
      const auto known =
          std::find(result.positions.begin(), result.positions.end(), shape.positions[corner]);
      result.faces.back().push_back(static_cast<int>(known - result.positions.begin()));
      if (known == result.positions.end()) result.positions.push_back(shape.positions[corner]);
    }
  }
  return result;
}

class MeshIo : public testing::Test {
 protected:
  core::TriangleMesh load(const std::string& name, std::string_view bytes) const {
    return loadMesh(folder_.write(name, bytes));
  }
  /// "" if `bytes` are accepted.
  std::string refusal(const std::string& name, std::string_view bytes) const {
    return messageOf([&] { load(name, bytes); });
  }

  TemporaryFolder folder_;
};

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

// ---- obj

TEST_F(MeshIo, ReadsEveryWayToNameACornerInObj) {
  const core::TriangleMesh mesh = load("m.obj",
                                       "f 1 2 3\n"  // names what comes later
                                       "v 0 0 0\r\nv +1 0 0 1.0\n\tv 0 1e0 0 0.5 0.5 0.5\r\n"
                                       "vt 0 0\nvn 0 0 1\ng a\n"
                                       "f 1/1 2/1 3/1\nusemtl m\nf 1/1/1 2/1/1 3/1/1 # round\n"
                                       "g b\nf 1//1 2//1 3//1\ns off\nf -3 -2 -1\n"
                                       "v 5 5 5\nf -4/-1/-1 -3/-1/-1 -2/-1/-1");
  EXPECT_EQ(mesh.positions(), core::Points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}}));
  EXPECT_EQ(facesOf(mesh), Faces(6, {0, 1, 2}));
}

TEST_F(MeshIo, RoundsDecimalsCorrectly) {
  const core::TriangleMesh mesh =
      load("m.obj", "v 0.3 0.1234567890123456789 -1e-5\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(mesh.positions()[0], Eigen::Vector3d(0.3, 0.1234567890123456789, -1e-5));
}

TEST_F(MeshIo, RefusesABadVertexWithItsNumber) {
  const auto with = [&](const std::string& coordinate) {
    return refusal("m.obj", "v 0 0 0\nv 1 0 0\nv 0 " + coordinate + " 0\nf 1 2 3\n");
  };
  EXPECT_EQ(with("1"), "");
  for (const char* const word :
       {"nan", "-nan", "inf", "-inf", "NaN", "Infinity", "1e39", "-1e39"}) {
    EXPECT_THAT(with(word), AllOf(HasSubstr("m.obj'"), HasSubstr("vertex 2 is at (0, "),
                                  HasSubstr("32-bit float")))
        << word;
  }
  for (const char* const word : {"abc", "1.0x", "0x10", "1,5", "1e400", "--1", "+-1", "1e"}) {
    EXPECT_THAT(with(word), HasSubstr("line 3: '" + std::string(word) + "' is not a number"));
  }
  EXPECT_THAT(refusal("m.obj", "v 0 0\n"), HasSubstr("line 1: it has 3 words, but 4 or more"));
}

TEST_F(MeshIo, RefusesABadFaceOfObj) {
  const auto with = [&](const std::string& corners) {
    return refusal("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf " + corners + "\n");
  };
  EXPECT_EQ(with("1 2 3"), "");
  EXPECT_THAT(with("1 2 4"), HasSubstr("triangle 1 names vertex 3 of 3"));
  EXPECT_THAT(with("1 2 0"), HasSubstr("line 5: a face names vertex 0, when there are 3 so far"));
  EXPECT_THAT(with("1 2 -4"), HasSubstr("line 5: a face names vertex -4"));
  EXPECT_THAT(with("1 2 4294967297"), HasSubstr("line 5: a face names vertex 4294967297"));
  EXPECT_THAT(with("1 2 1x"), HasSubstr("line 5: '1x' is not an integer"));
  EXPECT_THAT(with("1 2 99999999999999999999"), HasSubstr("is not an integer"));
  EXPECT_THAT(with("1 2 1.5"), HasSubstr("is not an integer"));
  EXPECT_THAT(with("1 2 /1"), HasSubstr("is not an integer"));
  EXPECT_THAT(with("1 2"), HasSubstr("has 2 corners"));
  EXPECT_THAT(with(""), HasSubstr("has 0 corners"));
}

TEST_F(MeshIo, RefusesAnUnknownKeywordOfObjBecauseItMayBeABrokenVertex) {
  EXPECT_THAT(refusal("m.obj", "v 0 0 0\nvv 1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
              HasSubstr("line 2: it begins with no keyword of obj"));
}

TEST_F(MeshIo, RefusesAMeshWithoutTriangles) {
  EXPECT_THAT(refusal("m.obj", "v 0 0 0\n"), HasSubstr("m.obj': the mesh has no triangle"));
  EXPECT_THAT(refusal("m.off", "OFF 1 0 0\n0 0 0\n"), HasSubstr("the mesh has no triangle"));
}

// ---- polygons

TEST_F(MeshIo, TurnsAPolygonIntoAFanInItsPlace) {
  const Shape polygons = {{{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}, {0, 0, 1}},
                          {{5, 0, 1}, {4, 3, 2, 1, 0}, {0, 1, 2, 3}, {5, 1, 2}}};
  const Faces fans = {{5, 0, 1}, {4, 3, 2}, {4, 2, 1}, {4, 1, 0}, {0, 1, 2}, {0, 2, 3}, {5, 1, 2}};
  for (const Format& format : kFormats) {
    if (!format.is_indexed) continue;
    const core::TriangleMesh mesh = load(format.file, format.bytes(polygons));
    EXPECT_EQ(mesh.positions(), polygons.positions) << format.name;
    EXPECT_EQ(facesOf(mesh), fans) << format.name;
  }
}

// ---- off

TEST_F(MeshIo, ReadsOffWithColours) {
  const core::TriangleMesh mesh =
      load("m.off",
           "COFF 3 1 0 # counts\n\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n0 1 0 9 9 9 9\n"
           "3 0 1 2 0.5 0.5 0.5\n");
  expectSame(mesh, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
}

TEST_F(MeshIo, RefusesABadOff) {
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_EQ(refusal("m.off", "OFF\n3 1 0\n" + vertices + "3 0 1 2\n"), "");
  EXPECT_THAT(refusal("m.off", "OFF\n3 1 0\n" + vertices + "3 0 1 3\n"),
              HasSubstr("face 0 names vertex 3 of 3"));
  EXPECT_THAT(refusal("m.off", "OFF\n3 1 0\n" + vertices + "3 0 1 -1\n"),
              HasSubstr("face 0 names vertex -1 of 3"));
  EXPECT_THAT(refusal("m.off", "OFF\n3 1 0\n" + vertices + "3 0 1 0.5\n"),
              HasSubstr("face 0 names vertex 0.5 of 3"));
  EXPECT_THAT(refusal("m.off", "OFF\n3 1 0\n" + vertices + "4 0 1 2\n"),
              HasSubstr("line 6: it has 4 words, but 5 or more are wanted"));
  EXPECT_THAT(refusal("m.off", "OFF\n3 1 0\n" + vertices + "2 0 1\n"), HasSubstr("2 corners"));
  EXPECT_THAT(refusal("m.off", "OFF\n3 2 0\n" + vertices + "3 0 1 2\n"),
              HasSubstr("the file ends here, but a face is wanted"));
  EXPECT_THAT(refusal("m.off", "OFF\n2 1 0\n" + vertices + "3 0 1 1\n"), HasSubstr("corners"));
  EXPECT_THAT(refusal("m.off", "OFF\n3 1 0\n" + vertices + "3 0 1 2\n3 0 1 2\n"),
              HasSubstr("more follows than the counts say"));
  EXPECT_THAT(refusal("m.off", "OFF\n-3 1 0\n"), HasSubstr("the count -3 is negative"));
  EXPECT_THAT(refusal("m.off", "OFF BINARY\n"), HasSubstr("'BINARY' is not an integer"));
  EXPECT_THAT(refusal("m.off", "FOO\n"), HasSubstr("the keyword OFF is wanted"));
}

// ---- ply

TEST_F(MeshIo, ReadsEveryTypeOfPlyAndPassesOverWhatItDoesNotNeed) {
  std::string bytes =
      "ply\r\nformat binary_little_endian 1.0\r\nobj_info x\r\nelement camera 1\r\nproperty short "
      "id\r\nproperty list ushort int8 bits\r\nelement face 1\r\nproperty uint16 flags\r\nproperty "
      "list uint32 uint vertex_index\r\nelement vertex 3\r\nproperty double z\r\nproperty float64 "
      "y\r\nproperty int x\r\nend_header\r\n";
  put(bytes, std::int16_t{-1});
  put(bytes, std::uint16_t{2});
  put(bytes, std::int8_t{1});
  put(bytes, std::int8_t{2});
  put(bytes, std::uint16_t{7});
  put(bytes, std::uint32_t{3});
  for (const std::uint32_t corner : {2u, 0u, 1u}) put(bytes, corner);
  for (const double i : {0.0, 1.0, 2.0}) {
    put(bytes, 0.1 * i);
    put(bytes, i * i);
    put(bytes, static_cast<std::int32_t>(-i));
  }
  expectSame(load("m.ply", bytes), {{{0, 0, 0}, {-1, 1, 0.1}, {-2, 4, 0.2}}, {{2, 0, 1}}});
}

const std::string kPlyHeader =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kPlyVertices = "0 0 0\n1 0 0\n0 1 0\n";

TEST_F(MeshIo, RefusesAFaceIndexOfPlyThatIsOutOfRange) {
  EXPECT_EQ(refusal("m.ply", kPlyHeader + kPlyVertices + "3 0 1 2\n"), "");
  for (const char* const index : {"-1", "3", "4294967295", "1e300"}) {
    EXPECT_THAT(refusal("m.ply", kPlyHeader + kPlyVertices + "3 0 1 " + index + "\n"),
                AllOf(HasSubstr("m.ply'"), HasSubstr("face 0 names vertex "), HasSubstr(" of 3")))
        << index;
  }
}

TEST_F(MeshIo, RefusesABadPly) {
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  const std::string good = kPlyHeader + kPlyVertices + "3 0 1 2\n";
  const auto with = [&](const std::string& from, const std::string& to) {
    return refusal("m.ply", replaced(good, from, to));
  };
  EXPECT_THAT(with("ply\n", "plx\n"), HasSubstr("line 1: the word ply is wanted"));
  EXPECT_THAT(with("ascii", "asci"), HasSubstr("line 2: word 2 must be one of: ascii binary"));
  EXPECT_THAT(with("vertex 3", "vertex -3"), HasSubstr("line 3: the count is negative"));
  EXPECT_THAT(with("vertex 3", "vertex 4000000000000"), HasSubstr("the file ends here"));
  EXPECT_THAT(with("element vertex", "element vortex"), HasSubstr("must have one element vertex"));
  EXPECT_THAT(with("float x", "flaot x"), HasSubstr("line 4: word 2 must be one of:"));
  EXPECT_THAT(with("float x", "float w"), HasSubstr("element vertex must have one number x"));
  EXPECT_THAT(with("float z", "float y"), HasSubstr("element vertex must have one number y"));
  EXPECT_THAT(with("vertex_indices", "corners"),
              HasSubstr("element face must have one list vertex_indices"));
  EXPECT_THAT(with("end_header\n", ""), HasSubstr("line 9: element, property, comment or"));
  EXPECT_THAT(with("1 0 0", "1 nan 0"), HasSubstr("vertex 1 is at (1, nan, 0)"));
  EXPECT_THAT(with("1 0 0", "1 0 1e39"), HasSubstr("vertex 1 is at (1, 0, 1e+39)"));
  EXPECT_THAT(with("3 0 1 2", "2 0 1"), HasSubstr("has 2 corners"));
  EXPECT_THAT(with("3 0 1 2", "-3 0 1 2"), HasSubstr("list vertex_indices has -3"));
  EXPECT_THAT(with("3 0 1 2", "inf 0 1 2"), HasSubstr("the file ends here, but a number"));
  EXPECT_THAT(with("3 0 1 2", "3 0 1"), HasSubstr("the file ends here, but a number is wanted"));
  EXPECT_THAT(with("3 0 1 2", "3 0 1 2\n3 0 1 2"), HasSubstr("more follows than the header says"));
  const std::string endless = "element void 1000000000000000\nelement face";
  EXPECT_THAT(with("element face", endless), HasSubstr("element void has no property"));
}

TEST_F(MeshIo, RefusesABinaryPlyThatEndsEarlyOrLate) {
  const std::string bytes = binaryPly(awkwardShape(), true);
  for (std::size_t missing = 1; missing < bytes.size(); missing += 7) {
    EXPECT_NE(refusal("m.ply", bytes.substr(0, bytes.size() - missing)), "") << missing;
  }
  EXPECT_THAT(refusal("m.ply", bytes + "x"), HasSubstr("more follows than the header says"));
  EXPECT_EQ(refusal("m.ply", bytes + "\n"), "");
}

// ---- what assimp reads

TEST_F(MeshIo, RefusesNumbersOfStlThatAreNoNumbers) {
  Shape shape = awkwardShape();
  shape.positions[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal("m.stl", binaryStl(shape)), HasSubstr("vertex 2 is at (nan, "));
  shape.positions[2].y() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal("m.stl", binaryStl(shape)), HasSubstr("vertex 2 is at ("));
}

TEST_F(MeshIo, MergesZeroAndMinusZero) {
  Shape shape = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}}, {{0, 1, 2}, {3, 2, 1}}};
  EXPECT_EQ(load("m.stl", binaryStl(shape)).positions().size(), 3u);
}

TEST_F(MeshIo, AppliesTheNodesOfDaeAndItsUnitButNotItsUpAxis) {
  const Shape shape = {{{0, 0, 0}, {1, 0, 0}, {0, 0, 2}}, {{0, 1, 2}}};
  const core::TriangleMesh mesh =
      load("m.dae", dae(shape, "0.5", "<translate>4 6 8</translate><scale>2 2 2</scale>"));
  EXPECT_EQ(mesh.positions(), core::Points({{2, 3, 4}, {3, 3, 4}, {2, 3, 6}}));
}

TEST_F(MeshIo, TurnsTheTrianglesOfAMirroredNodeRound) {
  const Shape shape = {{{0, 0, 0}, {1, 0, 0}, {0, 0, 2}}, {{0, 1, 2}}};
  const core::TriangleMesh mesh = load("m.dae", dae(shape, "1", "<scale>1 -1 1</scale>"));
  const core::Triangle triangle = mesh.triangle(core::TriangleId{0});
  EXPECT_EQ(triangle.a, shape.positions[0]);
  EXPECT_EQ(triangle.b + triangle.c, shape.positions[1] + shape.positions[2]);
  EXPECT_GT((triangle.b - triangle.a).cross(triangle.c - triangle.a).y(), 0.0);
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
  EXPECT_THAT(refusal("mesh.txt", "hello"), HasSubstr("mesh.txt"));
  EXPECT_THAT(refusal("mesh", "hello"), HasSubstr("mesh"));
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

// ---- resolveMesh

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
