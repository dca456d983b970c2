// Stable regions as files: the exact boundary, the filled pieces, a raster, and cells that were simulated.
#pragma once

#include <string>
#include <string_view>

#include "analysis/regions/stability_region.h"

namespace springstab {

/// nx × ny cells of a window; values are taken at cell centres.
struct CellGrid {
  Window window;
  int nx, ny;

  double x(int i) const { return window.x_min + (i + 0.5) * (window.x_max - window.x_min) / nx; }
  double y(int j) const { return window.y_min + (j + 0.5) * (window.y_max - window.y_min) / ny; }
};

/// As files have it.
const char* name(Bound bound);

/// ρ at every cell centre, row by row from the smallest y.
std::vector<double> spectral_radii(std::string_view method, const CellGrid& grid, int threads);

/// Columns x, y, spectral_radius.
void write_raster(const std::string& path, const CellGrid& grid, const std::vector<double>& radii);

/// Columns condition, x, y; a blank line ends each arc.
void write_boundary(const std::string& path, const StabilityRegion& region, const Window& window);

/// Columns x, y_lower, y_upper; a blank line ends each piece.
void write_pieces(const std::string& path, const StabilityRegion& region, const Window& window);

/// Theory against simulation, cell by cell. A simulated oscillator that grows by 1 + ε a step passes the
/// threshold within N steps only if ε is at least about ln(threshold)/N, so cells with |ρ - 1| < c/N may
/// disagree; c = 2 ln(threshold) leaves room for a start that hardly contains the growing mode. Others must
/// not.
struct CellComparison {
  long cells = 0, steps = 0;
  double threshold = 1e6;
  double band = 0;  // c/N
  long diverged = 0, disagreements = 0, outside_band = 0;
};

enum class CellsWritten { all, disagreeing };

/// Simulates one oscillator per cell; with a path writes the columns x, y, spectral_radius, diverged (0/1).
CellComparison compare_cells(std::string_view method, const CellGrid& grid, long steps, int threads,
                             const std::string& path, CellsWritten written = CellsWritten::all);

}  // namespace springstab
