// `springstab region`: the stable region of one method in the X-Y plane.
#include "experiments/region.h"

#include <charconv>
#include <cmath>
#include <iostream>
#include <set>

#include "analysis/regions/amplification.h"
#include "experiments/command/enum_name.h"
#include "experiments/command/output.h"
#include "experiments/command/shared_options.h"
#include "experiments/studies/parallel.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

constexpr double neutral_band = 1e-9;  // |ρ - 1| at most this counts as neutral
constexpr long largest_grid = 100'000'000;
constexpr int largest_side = 10'000;

struct RegionOptions {
  std::string method;
  std::string x, y;  // "A:B", empty for the region's own extent
  int nx = 400, ny = 400;
  std::string raster, boundary, pieces, cells;  // files to write, empty for none
  int simulated_cells = 0;                      // per side; 0 for none
  long cell_steps = 2000;
};

struct CellCentres {
  std::vector<double> x, y;

  explicit CellCentres(const CellGrid& grid) {
    const auto cells = static_cast<std::size_t>(grid.nx) * grid.ny;
    x.reserve(cells);
    y.reserve(cells);
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) {
        x.push_back(grid.x(i));
        y.push_back(grid.y(j));
      }
  }
};

// "A:B" as a range of an axis; keeps what is there when nothing was given.
void parse_range(const std::string& range, const std::string& option, double& low, double& high) {
  if (range.empty()) return;
  const char* end = range.data() + range.size();
  const auto first = std::from_chars(range.data(), end, low);
  const bool colon = first.ec == std::errc() && first.ptr != end && *first.ptr == ':';
  const auto second = colon ? std::from_chars(first.ptr + 1, end, high) : first;
  if (!colon || second.ec != std::errc() || second.ptr != end || !(low < high) || !std::isfinite(high - low))
    throw InputError(option, 0, "'" + range + "' is not a range, expected A:B with A < B like -0.5:5");
}

// Beyond these the powers of X and Y that a region's equations have leave double precision.
void check(const Window& window) {
  constexpr double farthest = 1e30, narrowest = 1e-9;
  const auto expect = [](const char* option, double low, double high) {
    if (std::max(std::abs(low), std::abs(high)) > farthest || high - low < narrowest)
      throw InputError(
          option, 0,
          text("is %g:%g, expected a range of at least %g within ±%g", low, high, narrowest, farthest));
  };
  expect("--x", window.x_min, window.x_max);
  expect("--y", window.y_min, window.y_max);
}

void check(const RegionOptions& options) {
  if (options.nx < 1 || options.ny < 1 || static_cast<long>(options.nx) * options.ny > largest_grid)
    throw InputError("--nx, --ny", 0,
                     text("a grid of %d x %d cells is not possible, expected 1 to %ld cells", options.nx,
                          options.ny, largest_grid));
  if (options.simulated_cells < 0 || options.simulated_cells > largest_side)
    throw InputError("--simulate", 0,
                     text("is %d, expected 0 to %d cells a side", options.simulated_cells, largest_side));
  if (options.cell_steps < 1)
    throw InputError("--steps", 0, text("is %ld, expected at least 1", options.cell_steps));
  if (!options.cells.empty() && options.simulated_cells == 0)
    throw InputError("--cells", 0, "is for the cells of --simulate, which was not given");
  std::set<std::string> outputs;
  for (const std::string* file : {&options.raster, &options.boundary, &options.pieces, &options.cells})
    if (!file->empty() && !outputs.insert(*file).second)
      throw InputError(*file, 0, "is to be written twice, expected a file for each output");
}

}  // namespace

const char* name(Bound bound) {
  static constexpr std::pair<Bound, const char*> names[] = {{Bound::complex_pair, "complex_pair"},
                                                            {Bound::plus_one, "lambda=1"},
                                                            {Bound::minus_one, "lambda=-1"},
                                                            {Bound::window, "window"}};
  return name_in(names, bound);
}

std::vector<double> spectral_radii(std::string_view method, const CellGrid& grid, int threads) {
  const CellCentres cells(grid);
  std::vector<double> radii(cells.x.size());
  parallel_ranges(static_cast<long>(radii.size()), 8, threads, [&](long first, long last) {
    const auto part = [&](auto& v) { return std::span(v).subspan(first, last - first); };
    spectral_radius(method, part(cells.x), part(cells.y), part(radii));
  });
  return radii;
}

void write_raster(const std::string& path, const CellGrid& grid, const std::vector<double>& radii) {
  OutputFile file(path);
  file.stream() << "x,y,spectral_radius\n";
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i)
      file.stream() << grid.x(i) << ',' << grid.y(j) << ','
                    << radii[static_cast<std::size_t>(j) * grid.nx + i] << '\n';
  file.commit();
}

void write_boundary(const std::string& path, const StabilityRegion& region, const Window& window) {
  OutputFile file(path);
  file.stream() << "condition,x,y\n";
  for (const BoundaryArc& arc : region.boundary(window)) {
    for (std::size_t i = 0; i < arc.x.size(); ++i)
      file.stream() << name(arc.bound) << ',' << arc.x[i] << ',' << arc.y[i] << '\n';
    file.stream() << '\n';
  }
  file.commit();
}

void write_pieces(const std::string& path, const StabilityRegion& region, const Window& window) {
  OutputFile file(path);
  file.stream() << "x,y_lower,y_upper\n";
  for (const RegionPiece& piece : region.pieces(window)) {
    for (std::size_t i = 0; i < piece.x.size(); ++i)
      file.stream() << piece.x[i] << ',' << piece.y_lower[i] << ',' << piece.y_upper[i] << '\n';
    file.stream() << '\n';
  }
  file.commit();
}

CellComparison compare_cells(std::string_view method, const CellGrid& grid, long steps, int threads,
                             const std::string& path, CellsWritten written) {
  const CellCentres cells(grid);
  const std::vector<double> radii = spectral_radii(method, grid, threads);
  CellComparison result{.cells = static_cast<long>(radii.size()), .steps = steps};
  result.band = 2 * std::log(result.threshold) / static_cast<double>(steps);

  std::vector<CellFate> fates(radii.size());
  parallel_ranges(result.cells, 8, threads, [&](long first, long last) {
    const auto part = [&](auto& v) { return std::span(v).subspan(first, last - first); };
    simulate_cells(method, part(cells.x), part(cells.y), steps, result.threshold, part(fates));
  });
  const auto disagrees = [&](std::size_t i) {
    return (fates[i] == CellFate::diverged) != (radii[i] > 1 + neutral_band);
  };
  for (std::size_t i = 0; i < fates.size(); ++i) {
    result.diverged += fates[i] == CellFate::diverged;
    result.disagreements += disagrees(i);
    result.outside_band += disagrees(i) && !(std::abs(radii[i] - 1) < result.band);
  }
  if (!path.empty()) {
    OutputFile file(path);
    file.stream() << "x,y,spectral_radius,diverged\n";
    for (std::size_t i = 0; i < fates.size(); ++i)
      if (written == CellsWritten::all || disagrees(i))
        file.stream() << cells.x[i] << ',' << cells.y[i] << ',' << radii[i] << ','
                      << (fates[i] == CellFate::diverged) << '\n';
    file.commit();
  }
  return result;
}

namespace {

CellGrid grid_of(const StabilityRegion& region, const RegionOptions& options) {
  CellGrid grid{region.natural_window(0.1), options.nx, options.ny};
  parse_range(options.x, "--x", grid.window.x_min, grid.window.x_max);
  parse_range(options.y, "--y", grid.window.y_min, grid.window.y_max);
  check(grid.window);
  return grid;
}

Json report_of(const RegionOptions& options, const StabilityRegion& region, const Window& window,
               const std::vector<double>& radii) {
  long stable = 0, neutral = 0;
  for (double rho : radii) {
    stable += rho < 1 - neutral_band;
    neutral += std::abs(rho - 1) <= neutral_band;
  }
  const RegionConstants& c = region.constants();
  return {{"method", options.method},
          {"window", {{"x", {window.x_min, window.x_max}}, {"y", {window.y_min, window.y_max}}}},
          {"y_max", number(c.y_max)},
          {"x_at_y_max", std::isfinite(c.x_at_y_max) ? number(c.x_at_y_max) : Json()},
          {"y_max_attained", c.y_max_attained},
          {"cells", radii.size()},
          {"stable_cells", stable},
          {"neutral_cells", neutral},
          {"area", number(region.area(window))}};
}

Json report_of(const CellComparison& cells) {
  return {{"cells", cells.cells},
          {"steps", cells.steps},
          {"threshold", cells.threshold},
          {"diverged", cells.diverged},
          {"disagreements", cells.disagreements},
          {"band", cells.band},
          {"outside_band", cells.outside_band}};
}

void print_largest_y(const std::string& method, const RegionConstants& c) {
  if (!(c.y_max > 0)) {
    std::cout << "  no X, Y is stable: the method amplifies\n";
    return;
  }
  if (std::isfinite(c.y_max))
    std::cout << text("  largest Y   %.12g at X = %.12g%s\n", c.y_max, c.x_at_y_max,
                      c.y_max_attained ? "" : " (not attained: powers grow there)");
  else
    std::cout << "  largest Y   unbounded\n";
  if (amplifies_without_need(method))
    std::cout << "  undamped    motion grows at every step: the method amplifies\n";
}

void print_region(const Json& report, const RegionConstants& constants, const Window& window) {
  const auto method = report["method"].get<std::string>();
  std::cout << text("%s, X in [%g, %g], Y in [%g, %g]\n", method.c_str(), window.x_min, window.x_max,
                    window.y_min, window.y_max);
  print_largest_y(method, constants);
  std::cout << text("  area        %.12g inside the window\n", report["area"].get<double>())
            << text("  cells       %ld stable, %ld neutral of %ld\n", report["stable_cells"].get<long>(),
                    report["neutral_cells"].get<long>(), report["cells"].get<long>());
  if (!report.contains("simulated")) return;
  const Json& s = report["simulated"];
  std::cout << text(
      "  simulated   %ld cells of %ld steps: %ld diverged, %ld differ from theory, %ld of them where "
      "|rho - 1| >= %.3g\n",
      s["cells"].get<long>(), s["steps"].get<long>(), s["diverged"].get<long>(),
      s["disagreements"].get<long>(), s["outside_band"].get<long>(), s["band"].get<double>());
}

int run_region(const CommonOptions& common, const RegionOptions& options) {
  const StabilityRegion& region = stability_region(options.method);
  const CellGrid grid = grid_of(region, options);
  check(options);
  const std::vector<double> radii = spectral_radii(options.method, grid, common.threads);
  if (!options.raster.empty()) write_raster(options.raster, grid, radii);
  if (!options.boundary.empty()) write_boundary(options.boundary, region, grid.window);
  if (!options.pieces.empty()) write_pieces(options.pieces, region, grid.window);

  Json report = report_of(options, region, grid.window, radii);
  if (options.simulated_cells > 0) {
    const CellGrid coarse{grid.window, options.simulated_cells, options.simulated_cells};
    report["simulated"] =
        report_of(compare_cells(options.method, coarse, options.cell_steps, common.threads, options.cells));
  }
  if (common.json)
    print_json(report);
  else
    print_region(report, region.constants(), grid.window);
  return done;
}

}  // namespace

Subcommand region_command() {
  const auto o = std::make_shared<RegionOptions>();
  return {
      .name = "region",
      .title = "The stable region of a method in the X-Y plane (X = hd, Y = h^2 k)",
      .footer =
          "All quantities are dimensionless. Cells count as neutral where |rho - 1| <= 1e-9.\n\n"
          "example: springstab region rk4 --x -0.6:6 --y 0:9 --boundary rk4.csv",
      .options =
          {Option("METHOD", &o->method, "one of " + method_names() + "; needed without --method-file")
               .shown_as(""),
           Option("--x", &o->x, "range of X (default: the region's own extent)").shown_as("A:B"),
           Option("--y", &o->y, "range of Y").shown_as("A:B"),
           Option("--nx", &o->nx, "cells along X").with_default(),
           Option("--ny", &o->ny, "cells along Y").with_default(),
           Option("--raster", &o->raster, "write x,y,spectral_radius at cell centres").shown_as("F.csv"),
           Option("--boundary", &o->boundary,
                  "write the exact boundary: condition,x,y, a blank line ends an arc")
               .shown_as("F.csv"),
           Option("--pieces", &o->pieces, "write the region to fill: x,y_lower,y_upper").shown_as("F.csv"),
           Option("--simulate", &o->simulated_cells, "simulate N x N cells and compare with theory")
               .shown_as("N"),
           Option("--cells", &o->cells, "write the simulated cells: x,y,spectral_radius,diverged")
               .shown_as("F.csv"),
           Option("--steps", &o->cell_steps, "steps of each simulated cell").with_default()},
      .run = [o](const CommonOptions& common) {
        o->method = method_asked_for(o->method, "METHOD");
        return run_region(common, *o);
      }};
}

}  // namespace springstab
