// The words a user may write: materials known by name, and the help for a misspelt word.
#include <algorithm>
#include <numeric>
#include <utility>

#include "experiments/inputs/scene_description.h"
#include "solvers/io/input_error.h"
#include "solvers/io/mesh_file.h"
#include "solvers/io/text_file.h"

namespace springstab {
namespace {

/// The least number of insertions, deletions and substitutions that turn a into b (Levenshtein 1966).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);  // the distances of a's first i letters to all beginnings of b
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string expected_one_of(const std::string& word, const std::vector<std::string_view>& known) {
  std::string text = "expected ";
  std::string_view nearest;
  // Farther than that is no misspelling, and neither is a word of any length.
  std::size_t least = word.size() < 100 ? word.size() / 2 + 1 : 0;
  for (std::size_t k = 0; k < known.size(); ++k) {
    text += (k == 0 ? "" : k + 1 < known.size() ? ", " : " or ") + springstab::quoted(known[k]);
    const std::size_t distance = edit_distance(word, known[k]);
    if (distance < least) {
      least = distance;
      nearest = known[k];
    }
  }
  return nearest.empty() ? text : text + " (did you mean " + springstab::quoted(nearest) + "?)";
}

bool is_solid(const Geometry& geometry) {
  const std::string* file = std::get_if<std::string>(&geometry);
  return file && holds_tetrahedra(*file);
}

Material named_material(const std::string& name, bool solid, const std::string& source, long line) {
  if (solid) {
    if (name == "default") return SolidMaterial{};
    if (name == "soft") return SolidMaterial{.stiffness = {100, 100}};
    if (name == "stiff") return SolidMaterial{.stiffness = {1e5, 1e5}};
    throw InputError(source, line,
                     "the material " + springstab::quoted(name) + " of a mesh of tetrahedra, " +
                         expected_one_of(name, {"default", "soft", "stiff"}));
  }
  if (name == "default") return SpringMaterial{};
  if (name == "soft") return SpringMaterial{.stiffness = {20, 10, 2}};
  if (name == "stiff") return SpringMaterial{.stiffness = {20000, 10000, 200}};
  if (name == "baraff-witkin") return ClothMaterial{};
  throw InputError(source, line,
                   "unknown material " + springstab::quoted(name) + ", " +
                       expected_one_of(name, {"default", "soft", "stiff", "baraff-witkin"}));
}

}  // namespace springstab
