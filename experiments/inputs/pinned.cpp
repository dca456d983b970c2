#include "experiments/inputs/pinned.h"

#include <algorithm>
#include <sstream>
#include <string_view>

#include "experiments/command/words.h"
#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"
#include "solvers/scene/quantities.h"

namespace springstab {
namespace {

[[noreturn]] void fail(const Pins& pins, const std::string& what) {
  throw InputError(pins.source, pins.line, what);
}

void sort_and_unite(std::vector<int>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

std::vector<int> listed(const Pins& pins, int count) {
  std::vector<int> numbers;
  if (!pins.ranges.empty() && pins.ranges.back().last >= count)
    fail(pins, "pinned particle " + std::to_string(pins.ranges.back().last) +
                   " does not exist, expected 0 to " + std::to_string(count - 1));
  for (const Range& range : pins.ranges)
    for (int i = range.first; i <= range.last; ++i) numbers.push_back(i);
  return numbers;
}

std::string bounds(const Eigen::AlignedBox3d& box) {
  std::string words;
  for (int axis = 0; axis < 3; ++axis)
    words += (axis > 0 ? "," : "") + shown(box.min()[axis] + 0.) + ":" + shown(box.max()[axis] + 0.);
  return words;
}

// place(i) of `count` places at rest.
template <class Place>
std::vector<int> boxed(const Pins& pins, int count, const Place& place) {
  std::vector<int> numbers;
  Eigen::AlignedBox3d all;
  for (int i = 0; i < count; ++i) {
    all.extend(place(i));
    if (pins.box.contains(place(i))) numbers.push_back(i);
  }
  if (numbers.empty())
    fail(pins, "no particle rests in the box " + bounds(pins.box) + ", expected one that meets the scene's " +
                   bounds(all) + " m");
  return numbers;
}

// A group may be of several names, and without one it is that of the format's default.
bool names(const FaceAttributes::Statement& statement, const std::string& name) {
  if (statement.words == name) return true;
  if (statement.keyword != "g") return false;
  std::istringstream words(statement.words.empty() ? "default" : statement.words);
  for (std::string word; words >> word;)
    if (word == name) return true;
  return false;
}

std::vector<int> vertices_of(const Pins& pins, const MeshFile& file, const Faces& faces) {
  const std::string keyword = pins.kind == Pins::Kind::group ? "g" : "o";
  std::vector<int> numbers;
  std::vector<std::string_view> known;
  auto statement = file.attributes.statements.begin();
  bool inside = false;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (; statement != file.attributes.statements.end() && statement->face <= static_cast<int>(f);
         ++statement)
      if (statement->keyword == keyword) {
        inside = names(*statement, pins.name);
        known.push_back(statement->words);
      }
    if (inside) numbers.insert(numbers.end(), faces[f].begin(), faces[f].end());
  }
  const std::string kind = pins.kind == Pins::Kind::group ? "group" : "object";
  if (known.empty())
    fail(pins,
         file.path + " has no " + kind + "s, expected an OBJ file with statements '" + keyword + " NAME'");
  if (numbers.empty())
    fail(pins, "no face is of the " + kind + " " + springstab::quoted(pins.name) + ", " +
                   expected_one_of(pins.name, known));
  sort_and_unite(numbers);
  return numbers;
}

std::vector<int> file_numbers(const Pins& pins, const MeshFile& file, const Faces& faces) {
  const int count = static_cast<int>(file.vertices.size());
  switch (pins.kind) {
    case Pins::Kind::none:
      return {};
    case Pins::Kind::indices:
      return listed(pins, count);
    case Pins::Kind::group:
    case Pins::Kind::object:
      return vertices_of(pins, file, faces);
    case Pins::Kind::box:
      return boxed(pins, count, [&](int i) { return file.vertices[i]; });
    case Pins::Kind::first_row:
    case Pins::Kind::corners:
      break;
  }
  fail(pins,
       "'first-row' and 'corners' are places on a grid, expected particle numbers, a group, an object or a "
       "box "
       "for a mesh");
}

}  // namespace

std::vector<int> pinned_particles(const Pins& pins, const Grid& grid) {
  const int particles = grid.particles(), last = particles - 1;
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
    case Pins::Kind::box:
      return boxed(pins, particles, [&](int i) { return grid.place(i); });
    case Pins::Kind::group:
    case Pins::Kind::object:
      fail(pins, "a grid has no groups and objects, expected a place on it, particle numbers or a box");
  }
  return numbers;
}

std::vector<int> pinned_particles(const Pins& pins, const MeshFile& file, const Faces& faces) {
  std::vector<int> numbers;
  for (const int vertex : file_numbers(pins, file, faces))
    if (const int particle = file.repair.vertex[vertex]; particle >= 0) numbers.push_back(particle);
  sort_and_unite(numbers);
  return numbers;
}

}  // namespace springstab
