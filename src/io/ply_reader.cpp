#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mesh_draft.h"
#include "mesh_readers.h"
#include "organ_collision/io/message_text.h"
#include "shown.h"
#include "text_lines.h"

namespace organ_collision::io {
namespace {

// ---- the header

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
enum class Encoding { kAscii, kLittleEndian, kBigEndian };

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count_type;  ///< of a list
};

struct Element {
  std::string name;
  std::int64_t count;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding;
  std::vector<Element> elements;
};

template <typename Value>
Value named(const TextLines& lines, std::size_t word,
            const std::map<std::string_view, Value>& values) {
  const auto found = word < lines.words().size() ? values.find(lines.words()[word]) : values.end();
  if (found != values.end()) return found->second;
  std::vector<std::string_view> known;
  known.reserve(values.size());
  for (const auto& entry : values) known.push_back(entry.first);
  lines.refuse("word " + std::to_string(word + 1) + " must be one of " + joined(known), word);
}

Type typeNamed(const TextLines& lines, std::size_t word) {
  static const std::map<std::string_view, Type> kTypes = {
      {"char", Type::kInt8},      {"int8", Type::kInt8},       {"uchar", Type::kUint8},
      {"uint8", Type::kUint8},    {"short", Type::kInt16},     {"int16", Type::kInt16},
      {"ushort", Type::kUint16},  {"uint16", Type::kUint16},   {"int", Type::kInt32},
      {"int32", Type::kInt32},    {"uint", Type::kUint32},     {"uint32", Type::kUint32},
      {"float", Type::kFloat32},  {"float32", Type::kFloat32}, {"double", Type::kFloat64},
      {"float64", Type::kFloat64}};
  return named(lines, word, kTypes);
}

Encoding readEncoding(TextLines& lines) {
  static const std::map<std::string_view, Encoding> kEncodings = {
      {"ascii", Encoding::kAscii},
      {"binary_little_endian", Encoding::kLittleEndian},
      {"binary_big_endian", Encoding::kBigEndian}};
  lines.require("the word ply");
  if (lines.words() != std::vector<std::string_view>{"ply"})
    lines.refuse("the word ply is wanted", 0);
  lines.require("the format");
  while (lines.words().front() == "comment") lines.require("the format");
  if (lines.words().front() != "format") lines.refuse("the format is wanted", 0);
  return named(lines, 1, kEncodings);
}

std::string name(const TextLines& lines, std::size_t word) {
  if (word >= lines.words().size()) lines.refuse("a name is missing");
  return std::string(lines.words()[word]);
}

Element readElement(const TextLines& lines) {
  Element element{name(lines, 1), lines.integer(2), {}};
  if (element.count < 0) lines.refuse("the count is negative");
  return element;
}

Property readProperty(const TextLines& lines) {
  if (name(lines, 1) != "list") return {name(lines, 2), typeNamed(lines, 1), std::nullopt};
  return {name(lines, 4), typeNamed(lines, 3), typeNamed(lines, 2)};
}

/// Leaves `lines` at end_header.
Header readHeader(TextLines& lines) {
  Header header{readEncoding(lines), {}};
  for (lines.require("end_header"); lines.words().front() != "end_header";
       lines.require("end_header")) {
    const std::string_view keyword = lines.words().front();
    if (keyword == "element") {
      header.elements.push_back(readElement(lines));
    } else if (keyword == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(readProperty(lines));
    } else if (keyword != "comment" && keyword != "obj_info") {
      lines.refuse("element, property, comment or end_header is wanted", 0);
    }
  }
  return header;
}

const Element& elementNamed(const Header& header, const std::string& name) {
  const auto is_it = [&](const Element& element) { return element.name == name; };
  if (std::count_if(header.elements.begin(), header.elements.end(), is_it) != 1) {
    std::vector<std::string_view> known;
    for (const Element& element : header.elements) known.emplace_back(element.name);
    throw std::invalid_argument("the header must have one element " + name +
                                "; it has: " + joined(known));
  }
  return *std::find_if(header.elements.begin(), header.elements.end(), is_it);
}

/// The place of a property among its element's.
std::size_t place(const Element& element, const std::vector<std::string>& names, bool list) {
  const auto is_it = [&](const Property& property) {
    return property.count_type.has_value() == list &&
           std::find(names.begin(), names.end(), property.name) != names.end();
  };
  const auto& all = element.properties;
  if (std::count_if(all.begin(), all.end(), is_it) != 1) {
    throw std::invalid_argument("element " + element.name + " must have one " +
                                (list ? "list " : "number ") + names.front());
  }
  return static_cast<std::size_t>(std::find_if(all.begin(), all.end(), is_it) - all.begin());
}

// ---- the body

template <typename Number>
double take(std::string_view& bytes, bool swapped) {
  std::array<char, sizeof(Number)> raw{};
  if (bytes.size() < raw.size()) throw std::invalid_argument("the file ends there");
  std::copy_n(bytes.begin(), raw.size(), raw.begin());
  if (swapped) std::reverse(raw.begin(), raw.end());
  bytes.remove_prefix(raw.size());
  Number number{};
  std::memcpy(&number, raw.data(), raw.size());
  return static_cast<double>(number);
}

double take(Type type, std::string_view& bytes, bool swapped) {
  switch (type) {
    case Type::kInt8:
      return take<std::int8_t>(bytes, swapped);
    case Type::kUint8:
      return take<std::uint8_t>(bytes, swapped);
    case Type::kInt16:
      return take<std::int16_t>(bytes, swapped);
    case Type::kUint16:
      return take<std::uint16_t>(bytes, swapped);
    case Type::kInt32:
      return take<std::int32_t>(bytes, swapped);
    case Type::kUint32:
      return take<std::uint32_t>(bytes, swapped);
    case Type::kFloat32:
      return take<float>(bytes, swapped);
    case Type::kFloat64:
      return take<double>(bytes, swapped);
  }
  throw std::logic_error("a type that is not in the list");
}

/// The numbers of the body, row by row, of which text has one in a line. All types fit into a
/// double. Errors name the line or, of a binary body, the row.
class Body {
 public:
  Body(Encoding encoding, const TextLines& header)
      : ascii_(encoding == Encoding::kAscii),
        swapped_((encoding == Encoding::kLittleEndian) !=
                 (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)),
        bytes_(header.rest()),
        lines_(header) {}

  /// Calls `use`, which reads the next row, that of this number of an element.
  template <class Use>
  void readRow(const std::string& element, std::int64_t number, const Use& use) {
    if (ascii_) {
      word_ = 0;
      if (!lines_.next())
        lines_.refuse("the file ends here, but a row of element " + element + " is wanted");
      use();
      if (word_ < lines_.words().size())
        lines_.refuse("it has " + std::to_string(lines_.words().size()) + " words, but " +
                      std::to_string(word_) + " are wanted in row " + std::to_string(number) +
                      " of element " + element);
      return;
    }
    try {
      use();
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("row " + std::to_string(number) + " of element " + element +
                                  ": " + error.what());
    }
  }

  double next(Type type) { return ascii_ ? lines_.real(word_++) : take(type, bytes_, swapped_); }
  /// What `action`, which reads nothing, throws is said of the line, if there are some.
  template <class Action>
  void ofThisRow(const Action& action) const {
    if (!ascii_) return action();
    lines_.ofThisLine(action);
  }

  /// REQUIRES: all rows are read.
  void requireEnd() {
    const bool ends =
        ascii_ ? !lines_.next() : bytes_.find_first_not_of(" \r\n") == std::string_view::npos;
    if (!ends) ofThisRow([] { throw std::invalid_argument("more follows than the header says"); });
  }

 private:
  bool ascii_;
  bool swapped_;
  std::string_view bytes_;
  TextLines lines_;
  std::size_t word_ = 0;
};

using Values = std::vector<double>;

/// The values of one property: one, or those of a list.
void readValues(const Property& property, Body& body, Values& values) {
  const double count = property.count_type ? body.next(*property.count_type) : 1.0;
  if (count < 0.0 || std::floor(count) != count) {
    body.ofThisRow([&] {
      throw std::invalid_argument("list " + property.name + " has " + shown(count) + " values");
    });
  }
  values.clear();
  while (static_cast<double>(values.size()) < count) values.push_back(body.next(property.type));
}

/// Calls `use(row number, values of each property)` for each row.
template <typename Use>
void readRows(const Element& element, Body& body, const Use& use) {
  if (element.count > 0 &&
      element.properties.empty()) {  // would take no bytes, and time without end
    throw std::invalid_argument("element " + element.name + " has no property");
  }
  std::vector<Values> row(element.properties.size());
  for (std::int64_t i = 0; i < element.count; ++i) {
    body.readRow(element.name, i, [&] {
      for (std::size_t k = 0; k < row.size(); ++k) readValues(element.properties[k], body, row[k]);
      body.ofThisRow([&] { use(i, row); });
    });
  }
}

}  // namespace

core::TriangleMesh readPly(std::string_view bytes) {
  TextLines lines(bytes);
  const Header header = readHeader(lines);
  const Element& vertex = elementNamed(header, "vertex");
  const Element& face = elementNamed(header, "face");
  const std::size_t x = place(vertex, {"x"}, false);
  const std::size_t y = place(vertex, {"y"}, false);
  const std::size_t z = place(vertex, {"z"}, false);
  const std::size_t indices = place(face, {"vertex_indices", "vertex_index"}, true);

  MeshDraft draft;
  std::vector<core::VertexId> corners;
  const auto use_vertex = [&](std::int64_t, const std::vector<Values>& row) {
    addVertex(draft, {row[x][0], row[y][0], row[z][0]});
  };
  const auto use_face = [&](std::int64_t i, const std::vector<Values>& row) {
    corners.clear();
    for (const double number : row[indices]) {
      corners.push_back(vertexOf(i, number, vertex.count));
    }
    addPolygon(draft, corners);
  };
  const auto pass_over = [](std::int64_t, const std::vector<Values>&) {};

  Body body(header.encoding, lines);
  for (const Element& element : header.elements) {
    if (&element == &vertex) {
      readRows(element, body, use_vertex);
    } else if (&element == &face) {
      readRows(element, body, use_face);
    } else {
      readRows(element, body, pass_over);
    }
  }
  body.requireEnd();
  return meshOf(std::move(draft));
}

}  // namespace organ_collision::io
