#include <set>
#include <string>
#include <utility>

#include "mesh_draft.h"
#include "mesh_readers.h"
#include "text_lines.h"

namespace organ_collision::io {
namespace {

/// Leaves `lines` at the line with the counts; returns the word that they begin at.
std::size_t readKeyword(TextLines& lines) {
  static const std::set<std::string_view> kKeywords = {"OFF",   "COFF",   "NOFF",   "CNOFF",
                                                       "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
  lines.require("the keyword OFF");
  if (kKeywords.count(lines.words().front()) == 0) lines.refuse("the keyword OFF is wanted", 0);
  if (lines.words().size() == 1) {
    lines.require("the number of vertices and faces");
    return 0;
  }
  if (lines.words()[1] == "BINARY") lines.refuse("a binary OFF is not read: save it as text");
  return 1;
}

std::int64_t count(const TextLines& lines, std::size_t word) {
  const std::int64_t count = lines.integer(word);
  if (count < 0) lines.refuse("the count " + std::to_string(count) + " is negative");
  return count;
}

}  // namespace

core::TriangleMesh readOff(std::string_view text) {
  TextLines lines(text);
  const std::size_t first = readKeyword(lines);
  const std::int64_t vertices = count(lines, first);
  const std::int64_t faces = count(lines, first + 1);

  MeshDraft draft;
  for (std::int64_t i = 0; i < vertices; ++i) {
    lines.require("a vertex");
    const Eigen::Vector3d position(lines.real(0), lines.real(1), lines.real(2));
    lines.ofThisLine([&] { addVertex(draft, position); });
  }
  std::vector<core::VertexId> corners;
  for (std::int64_t i = 0; i < faces; ++i) {
    lines.require("a face");
    corners.clear();
    const std::int64_t corner_count = count(lines, 0);
    for (std::int64_t k = 1; k <= corner_count; ++k) {
      const double number = lines.real(static_cast<std::size_t>(k));
      corners.push_back(lines.ofThisLine([&] { return vertexOf(i, number, vertices); }));
    }
    lines.ofThisLine([&] { addPolygon(draft, corners); });
  }
  if (lines.next()) lines.refuse("more follows than the counts say");
  return meshOf(std::move(draft));
}

}  // namespace organ_collision::io
