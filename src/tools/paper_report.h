#pragma once

#include <string>
#include <vector>

#include "paper_experiment.h"
#include "svg_plot.h"

namespace organ_collision::tools {

/// Table 1 for people, and in a few words below what it shows. REQUIRES: at least one row; here and
/// below.
std::string paperTable(const std::vector<PaperRow>& rows);

/// Table 1 for programs; a line of names first.
std::string paperCsv(const std::vector<PaperRow>& rows);

/// Fig. 4, the time of a query against the number of triangles, with the exact search beside the
/// greedy one; then the same as work, which no machine changes, and how often greedy is right.
Figure paperFigure(const std::vector<PaperRow>& rows);

}  // namespace organ_collision::tools
