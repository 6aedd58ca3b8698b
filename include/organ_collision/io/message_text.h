#pragma once

#include <string>
#include <string_view>
#include <vector>

// What messages are made of.
namespace organ_collision::io {

/// What came from elsewhere, as a message may show it: at most 1000 bytes of it, and control
/// characters, which a terminal would obey, as question marks; line breaks as blanks.
std::string printable(std::string_view text);

/// "one, two, three"
std::string joined(const std::vector<std::string_view>& names);

}  // namespace organ_collision::io
