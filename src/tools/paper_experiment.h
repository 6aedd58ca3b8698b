#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "organ_collision/core/triangle_mesh.h"

// The experiment of Muñoz, Diaz León, Trefftz, "Development of a hierarchy collision detection
// algorithm in order to implement a laparoscopic surgical simulator", Quid 19 (2012): a triangle is
// translated over open grids, and the time of a query is measured.
namespace organ_collision::tools {

/// One of the paper's test meshes.
struct PaperGrid {
  std::size_t columns, rows;  ///< cells, two triangles each
  /// As printed, not as it is: vertices + triangles - 2, as if the surface were closed, and a
  /// misprint in the last row.
  std::size_t edges_in_table;
};

/// The 23 rows of Table 1, the smallest first.
std::vector<PaperGrid> paperGrids();

/// Side of a cell [m]: some millimetres, as in a liver's mesh, and with centroids free of rounding,
/// so that ties are exact.
constexpr double kCell = 3.0 / 512.0;

/// The grid in the plane z = 0, with a corner in the origin.
core::TriangleMesh meshOf(const PaperGrid& grid);

std::size_t edgeCount(const core::TriangleMesh& mesh);

/// The tip's way from query to query [cells]. So far apart the queries can be counted as
/// independent trials: over 40 seeds the share of right answers scatters no wider than a binomial
/// (at 0.1 up to 1.8 times as wide).
constexpr double kStep = 0.5;

/// The instrument's tip triangle at `steps` places along a straight line that `seed` draws, thrown
/// back by the walls of the space over the grid, up to four cells high. Never turned.
std::vector<core::Triangle> tipPath(const PaperGrid& grid, std::size_t steps, std::uint64_t seed);

/// What Table 1 tells of a mesh, and what it does not.
struct PaperRow {
  PaperGrid grid;
  std::size_t triangles, vertices, edges, depth;
  std::size_t steps;            ///< queries
  std::size_t greedy_is_right;  ///< queries whose greedy answer no triangle is nearer than
  double mean_error, p99_error, worst_error;  ///< greedy distance less exact distance [cells]
  double greedy_nodes;                        ///< on the path, mean per query
  double exact_boxes, exact_triangles;        ///< measured, mean per query
  double greedy_time, exact_time;             ///< per query [s]: the median of the passes
};

/// How often the time is taken, for all grids in turn, so that a machine that is slow for a while
/// is so for all of them.
constexpr std::size_t kPasses = 7;

/// Calls `advance` (kPasses + 1) times for each grid.
std::vector<PaperRow> measure(const std::vector<PaperGrid>& grids, std::size_t steps,
                              std::uint64_t seed, const std::function<void()>& advance);

}  // namespace organ_collision::tools
