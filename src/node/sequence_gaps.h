#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace organ_collision::node {

/// Tells from messages' sequence numbers what queues dropped on the way, those of publishers too.
class SequenceGaps {
 public:
  /// How many messages of this publisher were lost just before the one with this number.
  std::uint32_t before(const std::string& publisher, std::uint32_t sequence);

 private:
  struct Stream {
    std::optional<std::uint32_t> last;
    bool counts_up = true;
  };
  std::map<std::string, Stream> streams_;
};

}  // namespace organ_collision::node
