#include "node/sequence_gaps.h"

#include <utility>

namespace organ_collision::node {
namespace {

constexpr std::uint32_t kFirst = 1;            // of whoever starts
constexpr std::uint32_t kLargestGap = 10'000;  // a larger one is no loss
constexpr std::size_t kMostStreams = 256;      // who comes under ever new names fills no memory

}  // namespace

std::uint32_t SequenceGaps::before(const std::string& publisher, std::uint32_t sequence) {
  if (streams_.size() == kMostStreams && streams_.count(publisher) == 0) streams_.clear();
  Stream& stream = streams_[publisher];
  const std::optional<std::uint32_t> last = std::exchange(stream.last, sequence);
  if (!last) return 0;
  // A bag that is played has the numbers of all who were recorded, one among the other.
  if (sequence <= *last && sequence > kFirst) stream.counts_up = false;
  if (sequence <= *last || !stream.counts_up) return 0;
  const std::uint32_t missed = sequence - *last - 1;
  return missed > kLargestGap ? 0 : missed;
}

}  // namespace organ_collision::node
