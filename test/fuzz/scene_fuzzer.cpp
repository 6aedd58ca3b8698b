// The parameter `scene`, of any shape; and the robot description, where it begins with <.
#include <fuzzer/FuzzedDataProvider.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>

#include "io/robot_reader.h"
#include "organ_collision/io/scene.h"

namespace {

using organ_collision::io::List;
using organ_collision::io::Map;
using organ_collision::io::Value;

constexpr std::array kWords = {"organs",       "instruments", "pairs",
                               "name",         "frame",       "mesh",
                               "link",         "scale",       "shape",
                               "corners",      "triangle",    "point",
                               "max_distance", "accuracy",    "max_relative_error",
                               "max_leaves",   "rate",        "stale_after",
                               "mesh_root",    "liver",       "left",
                               "sphere",       "capsule",     "radius",
                               "ends",         "convex",      "max_absolute_error"};

std::string text(FuzzedDataProvider& bytes) {
  return bytes.ConsumeBool() ? bytes.PickValueInArray(kWords) : bytes.ConsumeRandomLengthString(20);
}

Value value(FuzzedDataProvider& bytes, int depth) {
  const int deepest_kind = depth > 0 ? 6 : 4;
  switch (bytes.ConsumeIntegralInRange(0, deepest_kind)) {
    case 0:
      return {};
    case 1:
      return bytes.ConsumeBool();
    case 2:
      return bytes.ConsumeIntegral<int>();
    case 3:
      return bytes.ConsumeFloatingPoint<double>();
    case 4:
      return text(bytes);
    case 5: {
      List list;
      while (bytes.remaining_bytes() > 0 && bytes.ConsumeBool())
        list.push_back(value(bytes, depth - 1));
      return list;
    }
    default: {
      Map map;
      while (bytes.remaining_bytes() > 0 && bytes.ConsumeBool())
        map[text(bytes)] = value(bytes, depth - 1);
      return map;
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto attempt = [](const auto& read) {
    try {
      read();
    } catch (const std::exception&) {  // a refusal
    }
  };
  if (size > 0 && data[0] == '<') {
    const std::string description(reinterpret_cast<const char*>(data), size);
    // Here, not in a child process, where a crash would be a refusal.
    attempt([&] { organ_collision::io::readCollisions(description, "liver"); });
  } else {
    FuzzedDataProvider bytes(data, size);
    attempt([&] { organ_collision::io::parseScene(value(bytes, 5)); });
  }
  return 0;
}
