#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "organ_collision/io/mesh_io.h"
#include "temporary_folder.h"

// Mesh files in every format, and what is expected of who reads them.
namespace organ_collision::io {

using Faces = std::vector<std::vector<int>>;

struct Shape {
  core::Points positions;
  Faces faces;
};

/// A tetrahedron with what makes numbers shift when a reader is clever: vertex 0 is named by no
/// face, vertex 4 repeats vertex 1, the order of first appearance is not that of the numbers, one
/// triangle comes twice, one has no area. All coordinates are exact in float32.
inline Shape awkwardShape() {
  return {{{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1.5, 0}, {0, 0, 0}, {0, 0, -0.25}},
          {{5, 3, 2}, {1, 3, 2}, {4, 5, 3}, {1, 2, 5}, {4, 5, 3}, {2, 2, 3}}};
}

inline std::string obj(const Shape& shape) {
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

/// As off and ply have them: how many corners, then which.
inline std::string countedFaces(const Faces& faces) {
  std::ostringstream text;
  for (const auto& face : faces) {
    text << face.size();
    for (const int corner : face) text << " " << corner;
    text << "\n";
  }
  return text.str();
}

inline std::string off(const Shape& shape) {
  std::ostringstream text;
  text << "OFF\n# by hand\n" << shape.positions.size() << " " << shape.faces.size() << " 0\n";
  for (const auto& p : shape.positions) text << p.transpose() << "\n";
  text << countedFaces(shape.faces);
  return text.str();
}

inline std::string plyHeader(const Shape& shape, const std::string& format) {
  std::ostringstream text;
  text << "ply\nformat " << format << " 1.0\ncomment by hand\nelement vertex "
       << shape.positions.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement "
          "face "
       << shape.faces.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  return text.str();
}

inline std::string asciiPly(const Shape& shape) {
  std::ostringstream text;
  text << plyHeader(shape, "ascii");
  for (const auto& p : shape.positions) text << p.transpose() << " 255\n";
  text << countedFaces(shape.faces);
  return text.str();
}

template <typename Number>
void put(std::string& bytes, Number number, bool swapped = false) {
  std::string raw(sizeof number, '\0');
  std::memcpy(raw.data(), &number, sizeof number);
  if (swapped) std::reverse(raw.begin(), raw.end());
  bytes += raw;
}

inline std::string binaryPly(const Shape& shape, bool big_endian) {
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

inline std::string littlePly(const Shape& shape) { return binaryPly(shape, false); }
inline std::string bigPly(const Shape& shape) { return binaryPly(shape, true); }

inline std::string asciiStl(const Shape& shape) {
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

inline std::string binaryStl(const Shape& shape) {
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
inline std::string dae(const Shape& shape, const std::string& unit, const std::string& transform) {
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

inline std::string plainDae(const Shape& shape) { return dae(shape, "1", ""); }

struct Format {
  const char* name;
  const char* file;
  std::string (*bytes)(const Shape&);
  bool is_indexed;  ///< the file has vertex numbers, and we read it ourselves
};

inline const std::vector<Format> kFormats = {{"obj", "m.obj", obj, true},
                                             {"off", "m.off", off, true},
                                             {"ascii_ply", "m.ply", asciiPly, true},
                                             {"little_endian_ply", "m.ply", littlePly, true},
                                             {"big_endian_ply", "m.ply", bigPly, true},
                                             {"ascii_stl", "m.stl", asciiStl, false},
                                             {"binary_stl", "m.stl", binaryStl, false},
                                             {"dae", "m.dae", plainDae, false}};

inline Faces facesOf(const core::TriangleMesh& mesh) {
  Faces faces;
  for (const core::Corners& corners : mesh.triangles()) {
    faces.push_back({});
    for (const core::VertexId id : corners) faces.back().push_back(static_cast<int>(index(id)));
  }
  return faces;
}

inline void expectSame(const core::TriangleMesh& mesh, const Shape& shape) {
  EXPECT_EQ(mesh.positions(), shape.positions);
  EXPECT_EQ(facesOf(mesh), shape.faces);
}

/// Vertices of equal position merged, numbered in the order of first appearance.
inline Shape merged(const Shape& shape) {
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

/// `text` with the first `from` in it replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
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

}  // namespace organ_collision::io
