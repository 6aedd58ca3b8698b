#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <limits>
#include <string>
#include <utility>

#include "mesh_writers.h"

namespace organ_collision::io {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;

/// What is particular to the formats that assimp reads: stl, dae, gltf.
class AssimpFormats : public MeshIo {};

TEST_F(AssimpFormats, RefusesNumbersOfStlThatAreNoNumbers) {
  Shape shape = awkwardShape();
  shape.positions[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal("m.stl", binaryStl(shape)), HasSubstr("vertex 2 is at (nan, "));
  shape.positions[2].y() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal("m.stl", binaryStl(shape)), HasSubstr("vertex 2 is at ("));
}

const Shape kTwoTriangles = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 3, 1}}};

TEST_F(AssimpFormats, RefusesAsciiStlThatIsNotWordForWordAsTheFormatWantsIt) {
  const std::string good = asciiStl(kTwoTriangles);
  const auto with = [&](const std::string& from, const std::string& to) {
    return refusal("m.stl", replaced(good, from, to));
  };
  EXPECT_EQ(with("solid organ", "solid"), "");
  EXPECT_EQ(with("solid organ", "\tsolid facet of an organ"), "");
  EXPECT_EQ(with("normal 0 0 0\nouter", "normal nan 1 0 outer"), "");
  EXPECT_EQ(refusal("m.stl", good + "\n" + good), "");
  EXPECT_THAT(with("vertex 0 1 0\n", "vertex 0 1 0\nvertex 7 7 0\n"),
              AllOf(HasSubstr("m.stl'"), HasSubstr("line 7: the word endloop is wanted")));
  EXPECT_THAT(with("vertex 0 1 0\n", ""), HasSubstr("line 6: the word vertex is wanted"));
  EXPECT_THAT(with("vertex 0 1 0", "vertx 0 1 0"), HasSubstr("line 6: the word vertex is wanted"));
  EXPECT_THAT(with("vertex 0 1 0", "vertex 0 1"), HasSubstr("line 7: 'endloop' is not a number"));
  EXPECT_THAT(with("vertex 0 1 0", "vertex 0 1,5 0"), HasSubstr("line 6: '1,5' is not a number"));
  EXPECT_THAT(with("endfacet\n", "endfacet\nhello world\n"),
              HasSubstr("line 9: the word endsolid is wanted"));
  EXPECT_THAT(with("outer loop\n", ""), HasSubstr("line 3: the word outer is wanted"));
  EXPECT_THAT(with("endsolid organ\n", ""), HasSubstr("ends here, but endsolid is wanted"));
  EXPECT_THAT(with("endfacet\n", "endfacet\nendsolid\n"),
              HasSubstr("line 10: the word solid is wanted"));
}

TEST_F(AssimpFormats, ReadsBinaryStlThatBeginsAsAsciiDoes) {
  EXPECT_EQ(load("m.stl", binaryStl(kTwoTriangles).replace(0, 5, "solid")).triangleCount(), 2U);
}

TEST_F(AssimpFormats, MergesZeroAndMinusZero) {
  Shape shape = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}}, {{0, 1, 2}, {3, 2, 1}}};
  EXPECT_EQ(load("m.stl", binaryStl(shape)).positions().size(), 3u);
}

TEST_F(AssimpFormats, AppliesTheNodesOfDaeAndItsUnitButNotItsUpAxis) {
  const Shape shape = {{{0, 0, 0}, {1, 0, 0}, {0, 0, 2}}, {{0, 1, 2}}};
  const core::TriangleMesh mesh =
      load("m.dae", dae(shape, "0.5", "<translate>4 6 8</translate><scale>2 2 2</scale>"));
  EXPECT_EQ(mesh.positions(), core::Points({{2, 3, 4}, {3, 3, 4}, {2, 3, 6}}));
}

TEST_F(AssimpFormats, RefusesNegativeNumbersOfDaeThatCountSomething) {
  const std::string good = plainDae(kTwoTriangles);
  EXPECT_EQ(refusal("m.dae", good), "");
  EXPECT_THAT(refusal("m.dae", replaced(good, "<p>0 1 2 ", "<p>0 1 -1 ")),
              HasSubstr("m.dae': line 1: a number after <p> is below 0"));
  const std::string polygons =
      replaced(replaced(replaced(good, "<triangles", "<polylist"), "</triangles", "</polylist"),
               "<p>", "<vcount>3 3</vcount><p>");
  EXPECT_EQ(refusal("m.dae", polygons), "");
  EXPECT_THAT(refusal("m.dae", replaced(polygons, "3 3<", "3 -3<")),
              HasSubstr("line 1: a number after <vcount> is below 0"));
}

TEST_F(AssimpFormats, RefusesAUnitOfDaeThatIsNotAboveZero) {
  const auto with_unit = [&](const std::string& unit) {
    return refusal("m.dae", dae(kTwoTriangles, unit, ""));
  };
  EXPECT_EQ(with_unit("1e-3"), "");
  EXPECT_THAT(with_unit("abc"), HasSubstr("assimp says: Collada: Failed to parse meter"));
  EXPECT_THAT(with_unit("0"), HasSubstr("its scale, or the file's unit, is 0"));
  EXPECT_THAT(with_unit("-1"), HasSubstr("is below 0"));
  EXPECT_NE(with_unit("nan"), "");
}

TEST_F(AssimpFormats, RefusesANodeOfDaeThatNamesWhatIsNotThere) {
  for (const char* const content :
       {R"(<instance_geometry url="#other"/>)", R"(<instance_node url="#other"/>)"}) {
    EXPECT_THAT(refusal("m.dae", dae(kTwoTriangles, "1", content)),
                HasSubstr("assimp says: Collada: Unable to "))
        << content;
  }
}

TEST_F(AssimpFormats, RefusesAScaleOfZero) {
  EXPECT_THAT(refusal("m.dae", dae(kTwoTriangles, "1", "<scale>1 0 1</scale>")),
              HasSubstr("m.dae': node 'n': its scale, or the file's unit, is 0"));
}

TEST_F(AssimpFormats, TurnsTheTrianglesOfAMirroredNodeRound) {
  const Shape shape = {{{0, 0, 0}, {1, 0, 0}, {0, 0, 2}}, {{0, 1, 2}}};
  const core::TriangleMesh mesh = load("m.dae", dae(shape, "1", "<scale>1 -1 1</scale>"));
  const core::Triangle triangle = mesh.triangle(core::TriangleId{0});
  EXPECT_EQ(triangle.a, shape.positions[0]);
  EXPECT_EQ(triangle.b + triangle.c, shape.positions[1] + shape.positions[2]);
  EXPECT_GT((triangle.b - triangle.a).cross(triangle.c - triangle.a).y(), 0.0);
}

TEST_F(AssimpFormats, PassesOverTheLinesOfAMesh) {
  const Shape shape = {{{0, 0, 0}, {1, 0, 0}, {0, 0, 2}}, {{0, 1}, {0, 1, 2}}};
  std::string lines = plainDae(shape);
  for (const auto& [from, to] :
       {std::pair("<triangles", "<polylist"), std::pair("<p>", "<vcount>2 3</vcount><p>"),
        std::pair("</triangles", "</polylist")}) {
    lines.replace(lines.find(from), std::string(from).size(), to);
  }
  expectSame(load("m.dae", lines), {shape.positions, {{0, 1, 2}}});
}

/// A scene of two meshes: a triangle whose numbers are in another file or in this one, and the same
/// triangle turned round.
std::string gltf(const std::string& uri, const std::string& nodes = R"([{"mesh": 0}])") {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": )" +
         nodes + R"(,
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]},
               {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 1, "byteLength": 3}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                   "min": [0, 0, 0], "max": [1, 1, 0]},
                  {"bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR"}],
    "buffers": [{"byteLength": 36, "uri": ")" +
         uri + R"("}, {"byteLength": 3, "uri": "data:application/octet-stream;base64,AAIB"}]})";
}

const std::string kEmbedded =
    "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";

TEST_F(AssimpFormats, ReadsEveryNodeOfGltfWithTheMeshThatItNames) {
  const core::TriangleMesh mesh = load(
      "m.gltf",
      gltf(kEmbedded, R"([{"children": [1, 2]}, {"mesh": 1}, {"mesh": 0, "scale": [2, 2, 2]}])"));
  expectSame(mesh,
             {{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}, {0, 3, 4}}});
}

TEST_F(AssimpFormats, RefusesGltfOfWhichTrianglesAreLost) {
  const auto with_indices = [&](const std::string& base64, int count) {
    std::string text = gltf(kEmbedded, R"([{"mesh": 1}])");
    text = replaced(text, "AAIB", base64);
    text = replaced(text, R"("count": 3, "type": "SCALAR")",
                    R"("count": )" + std::to_string(count) + R"(, "type": "SCALAR")");
    for (const char* const end : {"}", ","}) {
      text = replaced(text, std::string(R"("byteLength": 3)") + end,
                      R"("byteLength": )" + std::to_string(count) + end);
    }
    return refusal("m.gltf", text);
  };
  EXPECT_EQ(with_indices("AAIBAAEC", 6), "");
  EXPECT_THAT(with_indices("AAIBAAEJ", 6), HasSubstr("out-of-range indices"));  // 9
  EXPECT_THAT(with_indices("AAIBAAE=", 5), EndsWith("Some vertices were dropped."));
}

TEST_F(AssimpFormats, RefusesANodeThatIsNotAffine) {
  const auto with_matrix = [&](const std::string& last_column) {
    return refusal("m.gltf", gltf(kEmbedded, R"([{"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0,
                                              0, 0, 1, 0, )" +
                                                 last_column + "]}]"));
  };
  EXPECT_EQ(with_matrix("5, 6, 7, 1"), "");
  EXPECT_THAT(with_matrix("5, 6, 7, 2"),
              HasSubstr("the last row of its matrix is 0 0 0 2, but 0 0 0 1 is wanted"));
}

/// They may lie where no mesh may be read.
TEST_F(AssimpFormats, OpensNoOtherFilesThatAFileNames) {
  EXPECT_EQ(load("m.gltf", gltf(kEmbedded)).triangleCount(), 1U);
  std::ofstream(folder_.path() / "other.bin", std::ios::binary)
      .write(reinterpret_cast<const char*>(std::array<float, 9>{0, 0, 0, 1, 0, 0, 0, 1, 0}.data()),
             36);
  EXPECT_NE(refusal("m.gltf", gltf("other.bin")), "");
}

}  // namespace
}  // namespace organ_collision::io
