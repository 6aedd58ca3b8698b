#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "mesh_draft.h"
#include "mesh_readers.h"
#include "shown.h"
#include "text_lines.h"

namespace organ_collision::io {
namespace {

/// Keywords that say nothing about vertices and faces. A word outside this list may be a broken `v`
/// or `f`, which would shift every later number.
bool isPassedOver(std::string_view keyword) {
  static const std::set<std::string_view> kKeywords = {
      "vn",   "vt",       "vp",       "vw",         "l",         "p",      "t",      "g",
      "s",    "o",        "mg",       "mtllib",     "usemtl",    "maplib", "usemap", "bevel",
      "lod",  "c_interp", "d_interp", "shadow_obj", "trace_obj", "cstype", "deg",    "bmat",
      "step", "curv",     "curv2",    "surf",       "parm",      "trim",   "hole",   "scrv",
      "sp",   "end",      "con",      "ctech",      "stech"};
  return kKeywords.count(keyword) > 0;
}

/// Numbers count from 1, negative ones back from the newest vertex. A number above the count may
/// name a later vertex.
core::VertexId vertexNamed(std::int64_t number, std::size_t count, const TextLines& lines) {
  const std::int64_t id = number > 0 ? number - 1 : static_cast<std::int64_t>(count) + number;
  if (number == 0 || id < 0 || id > std::numeric_limits<std::uint32_t>::max()) {
    lines.refuse("a face names vertex " + std::to_string(number) + ", when there are " +
                 std::to_string(count) + " so far, counted from 1");
  }
  return core::VertexId(static_cast<std::uint32_t>(id));
}

}  // namespace

core::TriangleMesh readObj(std::string_view text) {
  MeshDraft draft;
  std::vector<core::VertexId> corners;
  std::size_t most_named = 0;  // vertices, by a face
  std::size_t line_of_most = 0;
  for (TextLines lines(text); lines.next();) {
    const std::string_view keyword = lines.words().front();
    if (lines.words().back().back() == '\\')
      lines.refuse("it goes on in the next line, which is not read so: join the two");
    if (keyword == "v") {
      const Eigen::Vector3d position(lines.real(1), lines.real(2), lines.real(3));
      lines.ofThisLine([&] { addVertex(draft, position); });
      for (std::size_t i = 4; i < lines.words().size(); ++i) lines.real(i);  // weight, colour
    } else if (keyword == "f") {
      corners.clear();
      for (std::size_t i = 1; i < lines.words().size(); ++i) {
        corners.push_back(vertexNamed(lines.integer(i, '/'), draft.positions.size(), lines));
        if (index(corners.back()) < most_named) continue;
        most_named = index(corners.back()) + 1;
        line_of_most = lines.number();
      }
      if (corners.size() < 3)
        lines.refuse("a face has " + std::to_string(corners.size()) +
                     " corners: 3 or more are wanted");
      addPolygon(draft, corners);
    } else if (!isPassedOver(keyword)) {
      lines.refuse("it begins with " + quoted(keyword) + ", which is no keyword of obj");
    }
  }
  if (most_named > draft.positions.size())
    throw std::invalid_argument("line " + std::to_string(line_of_most) + ": a face names vertex " +
                                std::to_string(most_named) + " of " +
                                std::to_string(draft.positions.size()) + ", counted from 1");
  return meshOf(std::move(draft));
}

}  // namespace organ_collision::io
