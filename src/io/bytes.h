#pragma once

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

namespace organ_collision::io {

// Vectors and texts as bytes, for the way from a child process to its parent.

template <typename Items>
void appendItems(std::string& bytes, const Items& items) {
  const std::uint64_t count = items.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(items.data()),
               count * sizeof(typename Items::value_type));
}

inline void copyOut(std::string_view& bytes, void* target, std::size_t size) {
  if (size > bytes.size()) throw std::runtime_error("the reading process sent half an answer");
  if (size > 0) std::memcpy(target, bytes.data(), size);
  bytes.remove_prefix(size);
}

/// What appendItems() put there, removed from the front of `bytes`.
template <typename Items>
Items takeItems(std::string_view& bytes) {
  std::uint64_t count = 0;
  copyOut(bytes, &count, sizeof count);
  if (count > bytes.size() / sizeof(typename Items::value_type))
    throw std::runtime_error("the reading process sent half an answer");
  Items items;
  items.resize(count);
  copyOut(bytes, items.data(), items.size() * sizeof(typename Items::value_type));
  return items;
}

}  // namespace organ_collision::io
