#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <limits>
#include <string>
#include <utility>

#include "io/address_sanitizer.h"
#include "mesh_writers.h"

namespace organ_collision::io {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;

/// What is particular to the formats that assimp reads: dae, gltf.
class AssimpFormats : public MeshIo {};

const Shape kTwoTriangles = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 3, 1}}};

TEST_F(AssimpFormats, AppliesTheNodesOfDaeAndItsUnitButNotItsUpAxis) {
  const Shape shape = {{{0, 0, 0}, {1, 0, 0}, {0, 0, 2}}, {{0, 1, 2}}};
  const core::TriangleMesh mesh =
      load("m.dae", dae(shape, "0.5", "<translate>4 6 8</translate><scale>2 2 2</scale>"));
  EXPECT_EQ(mesh.positions(), core::Points({{2, 3, 4}, {3, 3, 4}, {2, 3, 6}}));
}

TEST_F(AssimpFormats, RefusesRotationsOfDaeThatWouldStretch) {
  const auto of_dae = [&](const std::string& rotation) {
    return refusal("m.dae", dae(kTwoTriangles, "1", "<rotate sid=\"a\">" + rotation + "</rotate>"));
  };
  for (const char* const good : {"0 0 1 90", " 0.7071\t0 -.7071 1e1 ", "0 0 0 0", "0 0 0 0.0"})
    EXPECT_EQ(of_dae(good), "") << good;
  for (const char* const bad : {"0 0 2 90", "1 1 0 90", "0 0 0 90", "0.707 0 0.706 1"})
    EXPECT_THAT(of_dae(bad), AllOf(HasSubstr("the axis of a rotation, "), HasSubstr(", not 1")));
  EXPECT_THAT(of_dae("0 0 2 90"),
              HasSubstr("line 1: the axis of a rotation, 0 0 2, is of length 2"));
  EXPECT_THAT(of_dae("0 0 1 90</rotate><rotate>0 0 2 90"),
              HasSubstr("the axis of a rotation, 0 0 2"));
}

TEST_F(AssimpFormats, RefusesNegativeNumbersOfDaeThatCountSomething) {
  const std::string good = plainDae(kTwoTriangles);
  EXPECT_EQ(refusal("m.dae", good), "");
  EXPECT_THAT(refusal("m.dae", replaced(good, "<p>0 1 2 ", "<p>0 1 -1 ")),
              HasSubstr("m.dae': line 1: a number after <p> is below 0"));
  EXPECT_THAT(refusal("m.dae", replaced(good, "<p>0 1 2 ", "<p >0 1 -1 ")),
              HasSubstr("m.dae': line 1: a number after <p> is below 0"));
  const std::string polygons =
      replaced(replaced(replaced(good, "<triangles", "<polylist"), "</triangles", "</polylist"),
               "<p>", "<vcount>3 3</vcount><p>");
  EXPECT_EQ(refusal("m.dae", polygons), "");
  EXPECT_THAT(refusal("m.dae", replaced(polygons, "3 3<", "3 -3<")),
              HasSubstr("line 1: a number after <vcount> is below 0"));
}

TEST_F(AssimpFormats, RefusesIndicesOfDaeThatAreNone) {
  const std::string good = plainDae(kTwoTriangles);
  for (const char* const word : {"x", "3.7", "0x1", "1e0", "+1"}) {
    EXPECT_THAT(refusal("m.dae", replaced(good, "<p>0 1 2 ", std::string("<p>0 1 ") + word + " ")),
                AllOf(HasSubstr("line 1: '"), HasSubstr("' after <p> is no number, 0 or above")))
        << word;
  }
  EXPECT_THAT(refusal("m.dae", replaced(good, "<p>0", "<p a=\"b\">-1")), HasSubstr("is below 0"));
  EXPECT_THAT(refusal("m.dae", replaced(good, "<p>0", "<p><![CDATA[-1]]>")),
              HasSubstr("'<![CDATA[-1]]>' after <p> is no number"));
  EXPECT_EQ(refusal("m.dae", replaced(good, "<triangles", "<extra><p/></extra><triangles")), "");
}

TEST_F(AssimpFormats, RefusesACountOfDaeForWhichTrianglesWouldBeLost) {
  const std::string good = plainDae(kTwoTriangles);
  const auto with_count = [&](const std::string& count) {
    return refusal("m.dae", replaced(good, R"(<triangles count="2")",
                                     R"(<triangles name="count" count=")" + count + R"(")"));
  };
  EXPECT_EQ(with_count("2"), "");
  for (const char* const count : {"abc", "-1", "", " ", "2.0"})
    EXPECT_THAT(with_count(count),
                HasSubstr(std::string("line 1: '") + count + "' is no count of triangles"));
  EXPECT_THAT(with_count("0"),
              HasSubstr("line 1: the count of triangles is 0, but there are some"));
  EXPECT_THAT(refusal("m.dae", replaced(good, R"(<triangles count="2")", "<triangles")),
              HasSubstr("line 1: the count of triangles is missing, but there are some"));
  for (const std::string name : {"polylist", "polygons", "tristrips"}) {
    const std::string none = "<" + name + " count=\"0\"><p>0 1 2</p></" + name + ">";
    EXPECT_THAT(refusal("m.dae", replaced(good, "<triangles", none + "<triangles")),
                HasSubstr("the count of " + name + " is 0, but there are some"));
  }
}

TEST_F(AssimpFormats, RefusesFansOfDaeWhichAssimpFillsOtherwise) {
  const std::string fan = R"(<trifans count="1"><p>0 1 2 3</p></trifans>)";
  EXPECT_THAT(refusal("m.dae", replaced(plainDae(kTwoTriangles), "<triangles", fan + "<triangles")),
              HasSubstr("line 1: trifans are not read: save the mesh as triangles"));
}

TEST_F(AssimpFormats, TellsHowMuchMemoryThereIsForWhatAsksForMore) {
  if (kAddressSanitizer) GTEST_SKIP() << "nothing limits its memory";
  const std::string good = plainDae(kTwoTriangles);
  EXPECT_THAT(refusal("m.dae", replaced(good, R"(count="12")", R"(count="100000000000")")),
              AllOf(HasSubstr("m.dae': needs more than "), EndsWith(" bytes of memory")));
}

TEST_F(AssimpFormats, RefusesAUnitOfDaeThatIsNotAboveZero) {
  const auto with_unit = [&](const std::string& unit) {
    return refusal("m.dae", dae(kTwoTriangles, unit, ""));
  };
  EXPECT_EQ(with_unit("1e-3"), "");
  EXPECT_THAT(with_unit("abc"), HasSubstr("assimp says: Collada: Failed to parse meter"));
  EXPECT_THAT(with_unit("0"), HasSubstr("its scale, or the file's unit, is 0"));
  EXPECT_THAT(with_unit("-1"), HasSubstr("is below 0"));
  const std::string mirrored = dae(kTwoTriangles, "-1", "");
  EXPECT_THAT(refusal("m.dae", replaced(mirrored, R"(meter="-1")", "meter\n=\t' -1'")),
              HasSubstr("line 2: a number after meter= is below 0"));
  EXPECT_EQ(refusal("m.dae", replaced(dae(kTwoTriangles, "1", ""), R"(meter="1")",
                                      R"(parameter="-1" meter="1")")),
            "");
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

TEST_F(AssimpFormats, RefusesRotationsOfGltfThatWouldStretch) {
  const auto of_gltf = [&](const std::string& rotation) {
    return refusal("m.gltf", gltf(kEmbedded, R"([{"mesh": 0, "rotation" : [)" + rotation + "]}]"));
  };
  EXPECT_EQ(of_gltf("0.7071, 0, 0,0.7071"), "");
  EXPECT_THAT(of_gltf("0, 0, 0, 2"), HasSubstr("the rotation of a node, 0 0 0 2, is of length 2"));
}

TEST_F(AssimpFormats, RefusesGltfThatAsksForExtensions) {
  const std::string good = gltf(kEmbedded);
  EXPECT_EQ(refusal("m.gltf", good), "");
  EXPECT_THAT(refusal("m.gltf",
                      replaced(good, R"("scene": 0,)",
                               R"("scene": 0, "extensionsRequired": ["KHR_mesh_quantization"],)")),
              EndsWith("m.gltf': it asks for extensions of glTF, of which none is known here: "
                       "'KHR_mesh_quantization'"));
  EXPECT_THAT(refusal("m.gltf", replaced(good, R"("scene": 0,)",
                                         R"("scene": 0, "extensionsRequired":
                                            ["KHR_materials_unlit", "KHR_mesh_quantization"],)")),
              EndsWith("'KHR_mesh_quantization'"));
  for (const char* const harmless : {"[]", R"(["KHR_materials_unlit", "KHR_texture_transform"])"})
    EXPECT_EQ(refusal("m.gltf", replaced(good, R"("scene": 0,)",
                                         std::string(R"("scene": 0, "extensionsRequired": )") +
                                             harmless + ",")),
              "");
}

TEST_F(AssimpFormats, RefusesAMeshThatMorphTargetsMove) {
  const auto with_weight = [&](const std::string& weight) {
    return refusal("m.gltf",
                   replaced(gltf(kEmbedded), R"([{"attributes": {"POSITION": 0}}])",
                            R"([{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 0}]}],
                               "weights": [)" +
                                weight + "]"));
  };
  EXPECT_EQ(with_weight("0"), "");
  EXPECT_THAT(with_weight("1"), HasSubstr("morph targets move its mesh"));
}

TEST_F(AssimpFormats, RefusesWhatIsOfAnotherFormatThanTheExtensionSays) {
  EXPECT_THAT(refusal("m.glb", obj(kTwoTriangles)), HasSubstr("m.glb': is no .glb, but what the "));
  EXPECT_NE(refusal("m.ase", obj(kTwoTriangles)), "");  // no mesh that was made up
  EXPECT_NE(refusal("m.csm", obj(kTwoTriangles)), "");
}

TEST_F(AssimpFormats, TellsACauseWhereAssimpTellsNone) {
  EXPECT_THAT(refusal("m.gltf", "{"), HasSubstr("does not begin as files of its extension do"));
  EXPECT_THAT(refusal("m.ogex", "garbage garbage garbage garbage\n"),
              HasSubstr("and does not say why"));
}

TEST_F(AssimpFormats, RefusesAMeshThatBonesMove) {
  std::string skinned = dae(kTwoTriangles, "1", R"(<instance_controller url="#c"/>)");
  skinned = replaced(skinned, "<library_visual_scenes>",
                     R"(<library_controllers><controller id="c"><skin source="#g">
      <bind_shape_matrix>2 0 0 5 0 2 0 5 0 0 2 5 0 0 0 1</bind_shape_matrix>
      <source id="j"><Name_array id="ja" count="1">n</Name_array><technique_common>
        <accessor source="#ja" count="1"><param type="name"/></accessor></technique_common></source>
      <source id="b"><float_array id="ba" count="16">1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</float_array>
        <technique_common><accessor source="#ba" count="1" stride="16"><param type="float4x4"/>
        </accessor></technique_common></source>
      <source id="w"><float_array id="wa" count="1">1</float_array><technique_common>
        <accessor source="#wa" count="1"><param type="float"/></accessor></technique_common></source>
      <joints><input semantic="JOINT" source="#j"/><input semantic="INV_BIND_MATRIX" source="#b"/>
      </joints><vertex_weights count="4"><input semantic="JOINT" source="#j" offset="0"/>
      <input semantic="WEIGHT" source="#w" offset="1"/><vcount>1 1 1 1</vcount>
      <v>0 0 0 0 0 0 0 0</v></vertex_weights></skin></controller></library_controllers>
      <library_visual_scenes>)");
  EXPECT_THAT(refusal("m.dae", skinned), HasSubstr("bones move its mesh"));
}

/// They may lie where no mesh may be read.
TEST_F(AssimpFormats, OpensNoOtherFilesThatAFileNames) {
  EXPECT_EQ(load("m.gltf", gltf(kEmbedded)).triangleCount(), 1U);
  std::ofstream(folder_.path() / "other.bin", std::ios::binary)
      .write(reinterpret_cast<const char*>(std::array<float, 9>{0, 0, 0, 1, 0, 0, 0, 1, 0}.data()),
             36);
  EXPECT_THAT(refusal("m.gltf", gltf("other.bin")),
              AllOf(HasSubstr("m.gltf': it needs another file, '"),
                    HasSubstr("other.bin', but only itself is opened")));
}

}  // namespace
}  // namespace organ_collision::io
