#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace organ_collision::tools {

/// `value` with `digits` significant ones and no trailing zeros: 0.00123, 45.6, 1.2e+07.
std::string significant(double value, int digits = 3);

/// `value` with so many decimals.
std::string fixed(double value, int decimals);

/// `cells` in columns of the `widths`, right-aligned, the first left-aligned; a line.
std::string aligned(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths);

/// One line of a CSV file, quoted where needed (RFC 4180, but for the line's end).
std::string csvLine(const std::vector<std::string>& fields);

/// Makes `folder` if it is not there. Throws std::runtime_error naming it unless files can be
/// written there.
void requireWritableFolder(const std::filesystem::path& folder);

/// Throws std::runtime_error naming `file` if it cannot be written.
void writeFile(const std::filesystem::path& file, const std::string& text);

}  // namespace organ_collision::tools
