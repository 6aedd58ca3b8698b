#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
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
  bool nextIs(const char* word) { return !atEnd() && isSame(lines_.words()[next_], word); }
  void expect(const char* word) {
    if (!isSame(take(word), word))
      lines_.refuse(std::string("the word ") + word + " is wanted", next_ - 1);
  }
  double number() {
    take("a number");
    return lines_.real(next_ - 1);
  }
  void skipLine() { next_ = lines_.words().size(); }
  /// What `action` throws is said of the line.
  template <class Action>
  auto ofThisLine(const Action& action) const {
    return lines_.ofThisLine(action);
  }

 private:
  /// Some write keywords in capitals.
  static bool isSame(std::string_view word, std::string_view keyword) {
    return std::equal(
        word.begin(), word.end(), keyword.begin(), keyword.end(),
        [](char one, char other) { return one == other || one == other - 'a' + 'A'; });
  }

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
    corners.push_back(words.ofThisLine([&] { return mesh.vertex(position); }));
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

constexpr std::size_t kCount = sizeof(std::uint32_t);  // behind the header

/// [bytes] How long a binary file is, by how many triangles it counts; of one that is too short for
/// a count, as if that were 0.
std::size_t binarySize(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= kHeader + kCount) std::memcpy(&count, bytes.data() + kHeader, kCount);
  return kHeader + kCount + kFacet * count;
}

/// It begins with the word, as a binary one may, too, and then has no byte that no text has.
bool isText(std::string_view bytes) {
  return Words(bytes).nextIs("solid") && bytes.substr(0, kHeader + kCount).find('\0') == bytes.npos;
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
  const std::size_t size = binarySize(bytes);
  if (bytes.size() == size) return readBinary(bytes.substr(kHeader + kCount));
  if (isText(bytes)) return readText(bytes);
  throw std::invalid_argument(
      "it is neither text, which begins with the word solid, nor as long as a binary file is of "
      "the triangles that it counts: it has " +
      std::to_string(bytes.size()) + " bytes, but " + std::to_string(size) + " are wanted for " +
      std::to_string((size - kHeader - kCount) / kFacet));
}

}  // namespace organ_collision::io
