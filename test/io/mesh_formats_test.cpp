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

/// What is particular to each.
class MeshFormats : public MeshIo {};

// ---- obj

TEST_F(MeshFormats, ReadsEveryWayToNameACornerInObj) {
  const core::TriangleMesh mesh = load("m.obj",
                                       "f 1 2 3\n"  // names what comes later
                                       "v 0 0 0\r\nv +1 0 0 1.0\n\tv 0 1e0 0 0.5 0.5 0.5\r\n"
                                       "vt 0 0\nvn 0 0 1\ng a\n"
                                       "f 1/1 2/1 3/1\nusemtl m\nf 1/1/1 2/1/1 3/1/1 # round\n"
                                       "g b\nf 1//1 2//1 3//1\ns off\nl 1 2\nf -3 -2 -1\n"
                                       "v 5 5 5\nf -4/-1/-1 -3/-1/-1 -2/-1/-1");
  EXPECT_EQ(mesh.positions(), core::Points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}}));
  EXPECT_EQ(facesOf(mesh), Faces(6, {0, 1, 2}));
}

TEST_F(MeshFormats, RoundsDecimalsCorrectly) {
  const core::TriangleMesh mesh =
      load("m.obj", "v 0.3 0.1234567890123456789 -1e-5\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(mesh.positions()[0], Eigen::Vector3d(0.3, 0.1234567890123456789, -1e-5));
}

TEST_F(MeshFormats, RefusesABadVertexWithItsNumber) {
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

TEST_F(MeshFormats, RefusesABadFaceOfObj) {
  const auto with = [&](const std::string& corners) {
    return refusal("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf " + corners + "\n");
  };
  EXPECT_EQ(with("1 2 3"), "");
  EXPECT_THAT(with("1 2 4"), HasSubstr("line 5: a face names vertex 4 of 3, counted from 1"));
  EXPECT_THAT(with("1 2 0"), HasSubstr("line 5: a face names vertex 0, when there are 3 so far"));
  EXPECT_THAT(with("1 2 -4"), HasSubstr("line 5: a face names vertex -4"));
  EXPECT_THAT(with("1 2 4294967297"), HasSubstr("line 5: a face names vertex 4294967297"));
  EXPECT_THAT(with("1 2 1x"), HasSubstr("line 5: '1x' is not an integer"));
  EXPECT_THAT(with("1 2 99999999999999999999"), HasSubstr("is not an integer"));
  EXPECT_THAT(with("1 2 1.5"), HasSubstr("is not an integer"));
  EXPECT_THAT(with("1 2 /1"), HasSubstr("is not an integer"));
  EXPECT_THAT(with("1 2"), HasSubstr("line 5: a face has 2 corners"));
  EXPECT_THAT(with(""), HasSubstr("line 5: a face has 0 corners"));
}

TEST_F(MeshFormats, PassesOverAByteOrderMark) {
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(refusal("m.obj", mark + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "");
  EXPECT_EQ(refusal("m.off", mark + "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "");
}

TEST_F(MeshFormats, RefusesAnUnknownKeywordOfObjBecauseItMayBeABrokenVertex) {
  EXPECT_THAT(refusal("m.obj", "v 0 0 0\nvv 1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
              HasSubstr("line 2: it begins with no keyword of obj"));
}

TEST_F(MeshFormats, RefusesAMeshWithoutTriangles) {
  EXPECT_THAT(refusal("m.obj", "v 0 0 0\n"), HasSubstr("m.obj': the mesh has no triangle"));
  EXPECT_THAT(refusal("m.off", "OFF 1 0 0\n0 0 0\n"), HasSubstr("the mesh has no triangle"));
}

// ---- polygons

TEST_F(MeshFormats, TurnsAPolygonIntoAFanInItsPlace) {
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

TEST_F(MeshFormats, ReadsOffWithNormalsColoursAndTextures) {
  for (const char* const keyword :
       {"COFF", "NOFF", "CNOFF", "STOFF", "STCOFF", "STNOFF", "STCNOFF"}) {
    const core::TriangleMesh mesh =
        load("m.off", std::string(keyword) +
                          " 3 1 0 # counts\n\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n"
                          "0 1 0 9 9 9 9\n3 0 1 2 0.5 0.5 0.5\n");
    expectSame(mesh, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  }
}

TEST_F(MeshFormats, RefusesABadOff) {
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

TEST_F(MeshFormats, ReadsEveryTypeOfPlyAndPassesOverWhatItDoesNotNeed) {
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

TEST_F(MeshFormats, ReadsEveryIntegerOfPlyInItsWholeRange) {
  const auto as = [this](const std::string& type, auto number) {
    std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex 1\n";
    for (const char* const axis : {"x", "y", "z"}) bytes += "property " + type + " " + axis + "\n";
    bytes += "element face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
    for (int i = 0; i < 3; ++i) put(bytes, number);
    for (const std::uint8_t byte : {3, 0, 0, 0}) put(bytes, byte);
    return load("m.ply", bytes).positions()[0].x() == static_cast<double>(number);
  };
  const auto range = [&as](const std::string& type, const std::string& other, auto number) {
    using Range = std::numeric_limits<decltype(number)>;
    for (const std::string& name : {type, other})
      EXPECT_TRUE(as(name, Range::min()) && as(name, Range::max())) << name;
  };
  range("char", "int8", std::int8_t{});
  range("uchar", "uint8", std::uint8_t{});
  range("short", "int16", std::int16_t{});
  range("ushort", "uint16", std::uint16_t{});
  range("int", "int32", std::int32_t{});
  range("uint", "uint32", std::uint32_t{});
}

const std::string kPlyHeader =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kPlyVertices = "0 0 0\n1 0 0\n0 1 0\n";

TEST_F(MeshFormats, RefusesAFaceIndexOfPlyThatIsOutOfRange) {
  EXPECT_EQ(refusal("m.ply", kPlyHeader + kPlyVertices + "3 0 1 2\n"), "");
  for (const char* const index : {"-1", "3", "4294967295", "1e300"}) {
    EXPECT_THAT(refusal("m.ply", kPlyHeader + kPlyVertices + "3 0 1 " + index + "\n"),
                AllOf(HasSubstr("m.ply'"), HasSubstr("face 0 names vertex "), HasSubstr(" of 3")))
        << index;
  }
}

TEST_F(MeshFormats, RefusesABadPly) {
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
  EXPECT_THAT(with("3 0 1 2", "3 0 1 2 2"), HasSubstr("more follows than the header says"));
  EXPECT_THAT(with("3 0 1 2", "3.5 0 1 2 0"), HasSubstr("list vertex_indices has 3.5"));
  EXPECT_THAT(with("element face", "element vertex 0\nelement face"),
              HasSubstr("must have one element vertex"));
  EXPECT_THAT(with("float x", "list uchar float x"), HasSubstr("must have one number x"));
  EXPECT_EQ(with("ply\n", "ply\ncomment before the format\n"), "");
  EXPECT_THAT(with("ply\n", "ply\n\nformat\n"), HasSubstr("line 3: word 2 must be one of"));
  const std::string endless = "element void 1000000000000000\nelement face";
  EXPECT_THAT(with("element face", endless), HasSubstr("element void has no property"));
}

TEST_F(MeshFormats, RefusesABinaryPlyThatEndsEarlyOrLate) {
  const std::string bytes = binaryPly(awkwardShape(), true);
  for (std::size_t missing = 1; missing < bytes.size(); missing += 7) {
    EXPECT_NE(refusal("m.ply", bytes.substr(0, bytes.size() - missing)), "") << missing;
  }
  EXPECT_THAT(refusal("m.ply", bytes + "x"), HasSubstr("more follows than the header says"));
  EXPECT_EQ(refusal("m.ply", bytes + "\n"), "");
}

// ---- what assimp reads

TEST_F(MeshFormats, RefusesNumbersOfStlThatAreNoNumbers) {
  Shape shape = awkwardShape();
  shape.positions[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal("m.stl", binaryStl(shape)), HasSubstr("vertex 2 is at (nan, "));
  shape.positions[2].y() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal("m.stl", binaryStl(shape)), HasSubstr("vertex 2 is at ("));
}

const Shape kTwoTriangles = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 3, 1}}};

/// `text` with the first `from` in it replaced.
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST_F(MeshFormats, RefusesAsciiStlThatIsNotWordForWordAsTheFormatWantsIt) {
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

TEST_F(MeshFormats, ReadsBinaryStlThatBeginsAsAsciiDoes) {
  EXPECT_EQ(load("m.stl", binaryStl(kTwoTriangles).replace(0, 5, "solid")).triangleCount(), 2U);
}

TEST_F(MeshFormats, MergesZeroAndMinusZero) {
  Shape shape = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}}, {{0, 1, 2}, {3, 2, 1}}};
  EXPECT_EQ(load("m.stl", binaryStl(shape)).positions().size(), 3u);
}

TEST_F(MeshFormats, AppliesTheNodesOfDaeAndItsUnitButNotItsUpAxis) {
  const Shape shape = {{{0, 0, 0}, {1, 0, 0}, {0, 0, 2}}, {{0, 1, 2}}};
  const core::TriangleMesh mesh =
      load("m.dae", dae(shape, "0.5", "<translate>4 6 8</translate><scale>2 2 2</scale>"));
  EXPECT_EQ(mesh.positions(), core::Points({{2, 3, 4}, {3, 3, 4}, {2, 3, 6}}));
}

TEST_F(MeshFormats, RefusesNegativeNumbersOfDaeThatCountSomething) {
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

TEST_F(MeshFormats, RefusesAUnitOfDaeThatIsNotAboveZero) {
  const auto with_unit = [&](const std::string& unit) {
    return refusal("m.dae", dae(kTwoTriangles, unit, ""));
  };
  EXPECT_EQ(with_unit("1e-3"), "");
  EXPECT_THAT(with_unit("abc"), HasSubstr("assimp says: Collada: Failed to parse meter"));
  EXPECT_THAT(with_unit("0"), HasSubstr("its scale, or the file's unit, is 0"));
  EXPECT_THAT(with_unit("-1"), HasSubstr("is below 0"));
  EXPECT_NE(with_unit("nan"), "");
}

TEST_F(MeshFormats, RefusesANodeOfDaeThatNamesWhatIsNotThere) {
  for (const char* const content :
       {R"(<instance_geometry url="#other"/>)", R"(<instance_node url="#other"/>)"}) {
    EXPECT_THAT(refusal("m.dae", dae(kTwoTriangles, "1", content)),
                HasSubstr("assimp says: Collada: Unable to "))
        << content;
  }
}

TEST_F(MeshFormats, RefusesAScaleOfZero) {
  EXPECT_THAT(refusal("m.dae", dae(kTwoTriangles, "1", "<scale>1 0 1</scale>")),
              HasSubstr("m.dae': node 'n': its scale, or the file's unit, is 0"));
}

TEST_F(MeshFormats, TurnsTheTrianglesOfAMirroredNodeRound) {
  const Shape shape = {{{0, 0, 0}, {1, 0, 0}, {0, 0, 2}}, {{0, 1, 2}}};
  const core::TriangleMesh mesh = load("m.dae", dae(shape, "1", "<scale>1 -1 1</scale>"));
  const core::Triangle triangle = mesh.triangle(core::TriangleId{0});
  EXPECT_EQ(triangle.a, shape.positions[0]);
  EXPECT_EQ(triangle.b + triangle.c, shape.positions[1] + shape.positions[2]);
  EXPECT_GT((triangle.b - triangle.a).cross(triangle.c - triangle.a).y(), 0.0);
}

TEST_F(MeshFormats, PassesOverTheLinesOfAMesh) {
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

TEST_F(MeshFormats, ReadsEveryNodeOfGltfWithTheMeshThatItNames) {
  const core::TriangleMesh mesh = load(
      "m.gltf",
      gltf(kEmbedded, R"([{"children": [1, 2]}, {"mesh": 1}, {"mesh": 0, "scale": [2, 2, 2]}])"));
  expectSame(mesh,
             {{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}, {0, 3, 4}}});
}

TEST_F(MeshFormats, RefusesGltfOfWhichTrianglesAreLost) {
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

TEST_F(MeshFormats, RefusesANodeThatIsNotAffine) {
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
TEST_F(MeshFormats, OpensNoOtherFilesThatAFileNames) {
  EXPECT_EQ(load("m.gltf", gltf(kEmbedded)).triangleCount(), 1U);
  std::ofstream(folder_.path() / "other.bin", std::ios::binary)
      .write(reinterpret_cast<const char*>(std::array<float, 9>{0, 0, 0, 1, 0, 0, 0, 1, 0}.data()),
             36);
  EXPECT_NE(refusal("m.gltf", gltf("other.bin")), "");
}

}  // namespace
}  // namespace organ_collision::io
