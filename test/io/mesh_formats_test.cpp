#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "mesh_writers.h"

namespace organ_collision::io {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// What is particular to those that are read here: obj, off, ply.
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
    EXPECT_THAT(with(word), AllOf(HasSubstr("m.obj'"), HasSubstr("line 3: vertex 2 is at (0, "),
                                  HasSubstr("32-bit float")))
        << word;
  }
  for (const char* const word : {"abc", "1.0x", "0x10", "1,5", "1e400", "--1", "+-1", "1e"}) {
    EXPECT_THAT(with(word), HasSubstr("line 3: '" + std::string(word) + "' is not a number"));
  }
  EXPECT_THAT(refusal("m.obj", "v 0 0\n"), HasSubstr("line 1: it has 3 words, but 4 or more"));
  EXPECT_THAT(refusal("m.obj", "v 0 0 0 v 1 0 0\n"), HasSubstr("line 1: 'v' is not a number"));
}

TEST_F(MeshFormats, RefusesABadFaceOfObj) {
  const auto with = [&](const std::string& corners) {
    return refusal("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf " + corners + "\n");
  };
  EXPECT_EQ(with("1 2 3"), "");
  EXPECT_THAT(with("1 2 4"), HasSubstr("line 5: a face names vertex 4 of 3, counted from 1"));
  EXPECT_THAT(with("4 1 2"), HasSubstr("line 5: a face names vertex 4 of 3, counted from 1"));
  EXPECT_THAT(with("1 2 4\nf 1 2 3"), HasSubstr("line 5: a face names vertex 4 of 3"));
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
              HasSubstr("line 2: it begins with 'vv', which is no keyword of obj"));
}

TEST_F(MeshFormats, RefusesALineOfObjThatGoesOnInTheNext) {
  EXPECT_THAT(refusal("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \\\n3\n"),
              HasSubstr("line 4: it goes on in the next line"));
}

TEST_F(MeshFormats, ReadsLinesThatEndAsOnAnySystem) {
  const std::string text = "v 0 0 0\nv 1 0 0 # nothing\nv 0 1 0\n# 7\n\nf 1 2 3\nf 1 2 x\n";
  for (const char* const end : {"\n", "\r\n", "\r"}) {
    std::string other;
    for (const char letter : text)
      other += letter == '\n' ? std::string(end) : std::string(1, letter);
    EXPECT_THAT(refusal("m.obj", other), HasSubstr("line 7: 'x' is not an integer"));
    EXPECT_EQ(refusal("m.obj", other.substr(0, other.find("f 1 2 x"))), "");
  }
  EXPECT_EQ(load("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 # one\rf 2 1 3\n").triangleCount(),
            2U);
}

TEST_F(MeshFormats, FillsAPolygonThatIsNotConvexFromACornerThatSeesAllOfIt) {
  const Shape arrow = {{{0, 0, 0}, {2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}, {1, 0, 0}, {0, 0, 1}},
                       {{1, 2, 3, 0}, {0, 4, 1, 2, 3}, {3, 2, 1, 0}, {0, 1, 5}}};
  const Faces fans = {{2, 3, 0}, {2, 0, 1}, {0, 4, 1}, {0, 1, 2},
                      {0, 2, 3}, {2, 1, 0}, {2, 0, 3}, {0, 1, 5}};
  for (const Format& format : kFormats) {
    if (!format.is_indexed) continue;
    EXPECT_EQ(facesOf(load(format.file, format.bytes(arrow))), fans) << format.name;
  }
}

TEST_F(MeshFormats, FillsAPolygonFromALateCornerOrBesideOneThatIsHardlyReflex) {
  // Radii of 1 and 2 in turn around the last corner, which alone sees all.
  Shape zigzag = {{}, {{0, 1, 2, 3, 4, 5, 6, 7}}};
  for (int i = 0; i < 7; ++i) {
    const double angle = 0.4 * i;
    const Eigen::Vector3d around(std::cos(angle), std::sin(angle), 0);
    zigzag.positions.push_back((1 + i % 2) * around);
  }
  zigzag.positions.push_back({0, 0, 0});
  const Shape notched = {{{0, 0, 0}, {1, 0, 0}, {2, -0.005, 0}, {2, 2, 0}, {0, 2, 0}},
                         {{0, 1, 2, 3, 4}}};
  for (const Format& format : kFormats) {
    if (!format.is_indexed) continue;
    EXPECT_EQ(facesOf(load(format.file, format.bytes(zigzag))),
              (Faces{{7, 0, 1}, {7, 1, 2}, {7, 2, 3}, {7, 3, 4}, {7, 4, 5}, {7, 5, 6}}))
        << format.name;
    EXPECT_EQ(facesOf(load(format.file, format.bytes(notched))),
              (Faces{{1, 2, 3}, {1, 3, 4}, {1, 4, 0}}))
        << format.name;
  }
}

TEST_F(MeshFormats, RefusesAPolygonThatNoFanFills) {
  const Shape horseshoe = {
      {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}},
      {{0, 1, 2}, {0, 1, 2, 3, 4, 5, 6, 7}}};
  const Shape bow_tie = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2, 3}}};
  for (const Format& format : kFormats) {
    if (!format.is_indexed) continue;
    EXPECT_THAT(refusal(format.file, format.bytes(horseshoe)),
                HasSubstr("face of 8 corners that becomes triangles 1 to 6"))
        << format.name;
    EXPECT_THAT(refusal(format.file, format.bytes(bow_tie)), HasSubstr("of 4 corners"))
        << format.name;
  }
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
              HasSubstr("line 6: face 0 names vertex 3 of 3, counted from 0"));
  EXPECT_THAT(refusal("m.off", "OFF\n3 1 0\n" + vertices + "3 0 1 -1\n"),
              HasSubstr("face 0 names vertex -1 of 3"));
  EXPECT_THAT(refusal("m.off", "OFF\n3 1 0\n" + vertices + "3 0 1 0.5\n"),
              HasSubstr("face 0 names vertex 0.5 of 3"));
  EXPECT_THAT(refusal("m.off", "OFF\n3 1 0\n" + vertices + "4 0 1 2\n"),
              HasSubstr("line 6: it has 4 words, but 5 or more are wanted"));
  EXPECT_THAT(refusal("m.off", "OFF\n3 1 0\n" + vertices + "2 0 1\n"),
              HasSubstr("line 6: the face that begins with triangle 0 has 2 corners"));
  EXPECT_THAT(refusal("m.off", "OFF\n3 1 0\n0 0 0\n1 inf 0\n"),
              HasSubstr("line 4: vertex 1 is at (1, inf, 0)"));
  EXPECT_THAT(refusal("m.off", "OFF\n3 2 0\n" + vertices + "3 0 1 2\n"),
              HasSubstr("the file ends here, but a face is wanted"));
  EXPECT_THAT(refusal("m.off", "OFF\n2 1 0\n" + vertices + "3 0 1 1\n"), HasSubstr("corners"));
  EXPECT_THAT(refusal("m.off", "OFF\n3 1 0\n" + vertices + "3 0 1 2\n3 0 1 2\n"),
              HasSubstr("more follows than the counts say"));
  EXPECT_THAT(refusal("m.off", "OFF\n-3 1 0\n"), HasSubstr("the count -3 is negative"));
  EXPECT_THAT(refusal("m.off", "OFF BINARY\n"), HasSubstr("line 1: a binary OFF is not read"));
  EXPECT_THAT(refusal("m.off", "FOO\n"), HasSubstr("line 1: the keyword OFF is wanted, not 'FOO'"));
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
  const std::string good = kPlyHeader + kPlyVertices + "3 0 1 2\n";
  const auto with = [&](const std::string& from, const std::string& to) {
    return refusal("m.ply", replaced(good, from, to));
  };
  EXPECT_THAT(with("ply\n", "plx\n"), HasSubstr("line 1: the word ply is wanted, not 'plx'"));
  EXPECT_THAT(with("ascii", "asci"), HasSubstr("line 2: word 2 must be one of ascii, binary"));
  EXPECT_THAT(with("vertex 3", "vertex -3"), HasSubstr("line 3: the count is negative"));
  EXPECT_THAT(with("vertex 3", "vertex 4000000000000"),
              HasSubstr("line 13: it has 4 words, but 3 are wanted in row 3 of element vertex"));
  EXPECT_THAT(with("element vertex", "element vortex"),
              HasSubstr("must have one element vertex; it has: vortex, face"));
  EXPECT_THAT(with("float x", "flaot x"),
              AllOf(HasSubstr("line 4: word 2 must be one of char, "), HasSubstr(", not 'flaot'")));
  EXPECT_THAT(with("float x", "float w"), HasSubstr("element vertex must have one number x"));
  EXPECT_THAT(with("float z", "float y"), HasSubstr("element vertex must have one number y"));
  EXPECT_THAT(with("vertex_indices", "corners"),
              HasSubstr("element face must have one list vertex_indices"));
  EXPECT_THAT(with("end_header\n", ""),
              HasSubstr("line 9: element, property, comment or end_header is wanted, not '0'"));
  EXPECT_THAT(with("1 0 0", "1 nan 0"), HasSubstr("line 11: vertex 1 is at (1, nan, 0)"));
  EXPECT_THAT(with("1 0 0", "1 0 1e39"), HasSubstr("vertex 1 is at (1, 0, 1e+39)"));
  EXPECT_THAT(with("3 0 1 2", "2 0 1"),
              HasSubstr("line 13: the face that begins with triangle 0 has 2"));
  EXPECT_THAT(with("3 0 1 2", "-3 0 1 2"), HasSubstr("line 13: list vertex_indices has -3 values"));
  EXPECT_THAT(with("3 0 1 2", "inf 0 1 2"), HasSubstr("line 13: it has 4 words, but 5 or more"));
  EXPECT_THAT(with("3 0 1 2", "3 0 1"), HasSubstr("line 13: it has 3 words, but 4 or more"));
  EXPECT_THAT(with("1 0 0\n0 1 0", "1 0\n0 0 1 0"),
              HasSubstr("line 11: it has 2 words, but 3 or more"));
  EXPECT_THAT(with("3 0 1 2\n", ""), HasSubstr("ends here, but a row of element face is wanted"));
  EXPECT_THAT(with("3 0 1 2", "3 0 1 2\n3 0 1 2"),
              HasSubstr("line 14: more follows than the header says"));
  EXPECT_THAT(with("3 0 1 2", "3 0 1 2 2"),
              HasSubstr("line 13: it has 5 words, but 4 are wanted in row 0 of element face"));
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
  EXPECT_THAT(refusal("m.ply", bytes.substr(0, bytes.size() - 1)),
              AllOf(HasSubstr("row "), HasSubstr(" of element face: the file ends there")));
  EXPECT_THAT(refusal("m.ply", bytes + "x"), HasSubstr("more follows than the header says"));
  EXPECT_EQ(refusal("m.ply", bytes + "\n"), "");
}

}  // namespace
}  // namespace organ_collision::io
