#include "experiments/inputs/pinned.h"

#include <algorithm>

#include "solvers/io/input_error.h"

namespace springstab {
namespace {

void sort_and_unite(std::vector<int>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

std::vector<int> listed(const Pins& pins, int count) {
  std::vector<int> numbers;
  if (!pins.ranges.empty() && pins.ranges.back().last >= count)
    throw InputError(pins.source, pins.line,
                     "pinned particle " + std::to_string(pins.ranges.back().last) +
                         " does not exist, expected 0 to " + std::to_string(count - 1));
  for (const Range& range : pins.ranges)
    for (int i = range.first; i <= range.last; ++i) numbers.push_back(i);
  return numbers;
}

}  // namespace

std::vector<int> pinned_particles(const Pins& pins, const Grid& grid) {
  const int particles = grid.rows * grid.columns, last = particles - 1;
  std::vector<int> numbers;
  switch (pins.kind) {
    case Pins::Kind::none:
      break;
    case Pins::Kind::indices:
      return listed(pins, particles);
    case Pins::Kind::first_row:
      for (int j = 0; j < grid.columns; ++j) numbers.push_back(j);
      break;
    case Pins::Kind::corners:
      numbers = {0, grid.columns - 1, last - (grid.columns - 1), last};
      sort_and_unite(numbers);
      break;
  }
  return numbers;
}

std::vector<int> pinned_particles(const Pins& pins, const MeshFile& file) {
  if (pins.kind == Pins::Kind::none) return {};
  if (pins.kind != Pins::Kind::indices)
    throw InputError(pins.source, pins.line,
                     "'first-row' and 'corners' are places on a grid, expected particle numbers for a mesh");
  std::vector<int> numbers;
  for (const int vertex : listed(pins, static_cast<int>(file.vertices.size())))
    if (const int particle = file.repair.vertex[vertex]; particle >= 0) numbers.push_back(particle);
  sort_and_unite(numbers);
  return numbers;
}

}  // namespace springstab
