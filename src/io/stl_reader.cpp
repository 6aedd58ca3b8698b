#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mesh_readers.h"
#include "text_lines.h"
#include "welded_mesh.h"

namespace organ_collision::io {
namespace {

// ---- text

/// The words of a text, whatever lines they are on. Errors name the line.
class Words {
 public:
  explicit Words(std::string_view text) : lines_(text) {}

  bool atEnd() {
    while (next_ >= lines_.words().size()) {
      next_ = 0;
      if (!lines_.next()) return true;
    }
    return false;
  }
  std::string_view take(const char* wanted) {
    if (atEnd()) lines_.require(wanted);  // which throws
    return lines_.words()[next_++];
  }
  bool nextIs(const char* word) { return !atEnd() && lines_.words()[next_] == word; }
  void expect(const char* word) {
    if (take(word) != word) lines_.refuse(std::string("the word ") + word + " is wanted");
  }
  double number() {
    take("a number");
    return lines_.real(next_ - 1);
  }
  void skipLine() { next_ = lines_.words().size(); }

 private:
  TextLines lines_;
  std::size_t next_ = 0;
};

void readFacet(Words& words, WeldedMesh& mesh) {
  for (const char* const word : {"facet", "normal"}) words.expect(word);
  for (int i = 0; i < 3; ++i) words.take("a normal");  // often nan, and of no use
  for (const char* const word : {"outer", "loop"}) words.expect(word);
  std::vector<core::VertexId> corners;
  for (int i = 0; i < 3; ++i) {
    words.expect("vertex");
    Eigen::Vector3d position;
    for (double& coordinate : position) coordinate = words.number();
    corners.push_back(mesh.vertex(position));
  }
  mesh.addTriangle(corners);
  for (const char* const word : {"endloop", "endfacet"}) words.expect(word);
}

core::TriangleMesh readText(std::string_view text) {
  WeldedMesh mesh;
  for (Words words(text); !words.atEnd();) {
    words.expect("solid");
    words.skipLine();  // its name
    while (words.nextIs("facet")) readFacet(words, mesh);
    words.expect("endsolid");
    words.skipLine();
  }
  return std::move(mesh).mesh();
}

// ---- binary, of little endian

constexpr std::size_t kHeader = 80;
constexpr std::size_t kNormal = 12;
constexpr std::size_t kFacet = 50;

/// The facets, if there are as many as a binary file says: it may begin with "solid", too.
std::optional<std::string_view> binaryFacets(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() < kHeader + sizeof count) return std::nullopt;
  std::memcpy(&count, bytes.data() + kHeader, sizeof count);
  bytes.remove_prefix(kHeader + sizeof count);
  if (bytes.size() != kFacet * count) return std::nullopt;
  return bytes;
}

core::TriangleMesh readBinary(std::string_view facets) {
  WeldedMesh mesh;
  for (; !facets.empty(); facets.remove_prefix(kFacet)) {
    std::array<float, 9> numbers{};
    std::memcpy(numbers.data(), facets.data() + kNormal, sizeof numbers);
    std::vector<core::VertexId> corners;
    for (std::size_t i = 0; i < numbers.size(); i += 3)
      corners.push_back(mesh.vertex({numbers[i], numbers[i + 1], numbers[i + 2]}));
    mesh.addTriangle(corners);
  }
  return std::move(mesh).mesh();
}

}  // namespace

core::TriangleMesh readStl(std::string_view bytes) {
  if (const auto facets = binaryFacets(bytes)) return readBinary(*facets);
  if (Words(bytes).nextIs("solid")) return readText(bytes);
  throw std::invalid_argument(
      "it is neither text, which begins with the word solid, nor as long as a binary file is of "
      "the "
      "triangles that it counts");
}

}  // namespace organ_collision::io
