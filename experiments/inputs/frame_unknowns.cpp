#include "experiments/inputs/frame_unknowns.h"

#include <cmath>
#include <numeric>
#include <string>

#include "solvers/io/input_error.h"

namespace springstab {

std::vector<Eigen::Index> unknowns_in_frame(Model& model, const Subject* scene, Eigen::Index numbers,
                                            const std::string& source) {
  const Eigen::Index size = model.system().size();
  std::vector<Eigen::Index> places(static_cast<std::size_t>(size));
  std::iota(places.begin(), places.end(), Eigen::Index{0});
  if (numbers == size) return places;
  const auto refuse = [&](const std::string& expected) -> void {
    throw InputError(source, 0,
                     "has frames of " + std::to_string(numbers) + " numbers, expected " + expected);
  };
  if (!scene) refuse(std::to_string(size) + ", one for each unknown of the matrices");
  // Vertices move as their unknowns do: those from 1 to n, and from none.
  const auto at_zero = scene->vertices(Vector::Zero(size));
  const auto moved = scene->vertices(Vector::LinSpaced(size, 1, static_cast<double>(size)));
  if (numbers != 3 * static_cast<Eigen::Index>(moved.size()))
    refuse(std::to_string(3 * moved.size()) + " of the scene's " + std::to_string(moved.size()) +
           " vertices or " + std::to_string(size) + " of its unknowns");
  for (std::size_t v = 0; v < moved.size(); ++v)
    for (int c = 0; c < 3; ++c)
      if (const long unknown = std::lround(moved[v][c] - at_zero[v][c]); unknown > 0)
        places[static_cast<std::size_t>(unknown - 1)] = 3 * static_cast<Eigen::Index>(v) + c;
  return places;
}

}  // namespace springstab
