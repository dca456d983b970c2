// The notation for pinned particles: none, first-row, corners, indices and ranges such as 0,5-9, a group or
// an object of an OBJ file, or a box.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
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

[[noreturn]] void fail_box(const Location& at, const std::string& words) {
  at.fail("the box " + springstab::quoted(words) +
          " is not one, expected three times lower:upper bound in metres, like "
          "0:0.5,:,1.2:, where a bound that is left out is infinite");
}

Eigen::AlignedBox3d parse_box(const std::string& words, const Location& at) {
  Eigen::AlignedBox3d box;
  std::string_view rest = words;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view bounds = rest.substr(0, rest.find(','));
    const std::size_t colon = bounds.find(':');
    if ((bounds.size() == rest.size()) != (axis == 2) || colon == bounds.npos) fail_box(at, words);
    const std::string_view lower = bounds.substr(0, colon), upper = bounds.substr(colon + 1);
    if (upper.find(':') != upper.npos) fail_box(at, words);
    box.min()[axis] = lower.empty() ? -HUGE_VAL : at.real(lower);
    box.max()[axis] = upper.empty() ? HUGE_VAL : at.real(upper);
    if (!(box.min()[axis] <= box.max()[axis])) fail_box(at, words);
    rest.remove_prefix(std::min(rest.size(), bounds.size() + 1));
  }
  return box;
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

  const std::string_view all(text);
  for (const auto& [prefix, kind] :
       {std::pair{"group:", Pins::Kind::group}, {"object:", Pins::Kind::object}, {"box:", Pins::Kind::box}}) {
    if (!all.starts_with(prefix)) continue;
    Pins chosen = pins(kind);
    chosen.name = trimmed(all.substr(std::string_view(prefix).size()));
    if (chosen.name.empty())
      throw InputError(source, line,
                       springstab::quoted(text) + " names nothing, expected one like 'group:collar'");
    if (kind == Pins::Kind::box) chosen.box = parse_box(std::exchange(chosen.name, {}), {source, line});
    return chosen;
  }
  Pins chosen = pins(Pins::Kind::indices);
  std::string_view rest = text;
  do {
    const int first = take_index(rest);
    const int last = take(rest, '-') ? take_index(rest) : first;
    if (first < 0 || last < first || (!rest.empty() && rest.front() != ','))
      throw InputError(source, line,
                       "unusable pins " + springstab::quoted(text) + ", " +
                           expected_one_of(text, {"none", "first-row", "corners", "group:NAME", "object:NAME",
                                                  "box:x0:x1,y0:y1,z0:z1", "0,5-9"}) +
                           ", ranges upwards, below " + std::to_string(max_particles));
    chosen.ranges.push_back({first, last});
  } while (take(rest, ','));
  chosen.ranges = merged(std::move(chosen.ranges));
  return chosen;
}

}  // namespace springstab
