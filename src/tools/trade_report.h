#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "svg_plot.h"
#include "trade.h"

namespace organ_collision::tools {

/// All that was measured on one mesh.
struct Trade {
  std::string mesh;  ///< the file's name
  std::size_t triangles;
  std::uint64_t seed;
  Costs costs;
  std::vector<BandTrade> bands;   ///< those of bands(), in their order
  std::optional<BandTrade> path;  ///< the user's own tips, if any
};

/// What is printed, in lines of at most 110 characters: a table for each band, the costs, and the
/// recommendation.
std::string report(const Trade& trade);

/// A table for one band.
std::string table(const BandTrade& band);

/// In words: the fastest setting for each of some errors, from what was measured.
std::string recommendation(const Trade& trade);

/// All numbers: one row for each setting and band, units in the header. Only columns with [us] and
/// [ms] differ between runs with the same seed.
std::string csv(const Trade& trade);

/// Error against time, a plot for each band: settings that no other beats in both are filled and
/// labelled.
Figure figure(const Trade& trade);

}  // namespace organ_collision::tools
