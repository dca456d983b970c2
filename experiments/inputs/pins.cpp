// The notation for pinned particles: none, first-row, corners, or indices and ranges such as 0,5-9.
#include <algorithm>
#include <charconv>
#include <utility>

#include "experiments/command/words.h"
#include "experiments/inputs/scene_description.h"
#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"

namespace springstab {
namespace {

/// Takes an index off the front of the text; -1 if there is none.
int take_index(std::string_view& text) {
  int index = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error != std::errc{} || index < 0 || index >= max_particles) return -1;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return index;
}

bool take(std::string_view& text, char c) {
  if (!text.starts_with(c)) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

std::vector<Range> merged(std::vector<Range> ranges) {
  std::ranges::sort(ranges, {}, &Range::first);
  std::vector<Range> apart;
  for (const Range& range : ranges)
    if (apart.empty() || apart.back().last < range.first - 1)
      apart.push_back(range);
    else
      apart.back().last = std::max(apart.back().last, range.last);
  return apart;
}

Pins parse_pins(const std::string& text, const std::string& source, long line) {
  const auto pins = [&](Pins::Kind kind) { return Pins{kind, {}, source, line}; };
  if (text == "none") return pins(Pins::Kind::none);
  if (text == "first-row") return pins(Pins::Kind::first_row);
  if (text == "corners") return pins(Pins::Kind::corners);

  Pins chosen = pins(Pins::Kind::indices);
  std::string_view rest = text;
  do {
    const int first = take_index(rest);
    const int last = take(rest, '-') ? take_index(rest) : first;
    if (first < 0 || last < first || (!rest.empty() && rest.front() != ','))
      throw InputError(source, line,
                       "unusable pins " + springstab::quoted(text) + ", " +
                           expected_one_of(text, {"none", "first-row", "corners", "0,5-9"}) +
                           ", ranges upwards, below " + std::to_string(max_particles));
    chosen.ranges.push_back({first, last});
  } while (take(rest, ','));
  chosen.ranges = merged(std::move(chosen.ranges));
  return chosen;
}

}  // namespace springstab
