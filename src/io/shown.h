#pragma once

#include <string>
#include <string_view>

// How messages show what stands in a file.
namespace organ_collision::io {

/// At most so much of a word that a binary file, which is one, does not fill the terminal.
std::string quoted(std::string_view word);

/// As few digits as tell a number from all others.
std::string shown(double number);

}  // namespace organ_collision::io
