#include "experiments/command/words.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>

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

/// What is told apart: neither capitals nor kinds of dashes.
std::string plain(std::string_view word) {
  std::string letters(word);
  for (char& c : letters)
    c = c == '_' || c == ' ' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return letters;
}

}  // namespace

std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& known) {
  // Farther than that is no misspelling, and neither is a word of any length.
  std::size_t least = word.size() < 100 ? word.size() / 2 + 1 : 0;
  std::string_view nearest;
  for (const std::string_view each : known)
    if (const std::size_t distance = edit_distance(plain(word), plain(each)); distance < least) {
      least = distance;
      nearest = each;
    }
  return nearest.empty() ? "" : " (did you mean " + springstab::quoted(nearest) + "?)";
}

std::string expected_one_of(std::string_view word, const std::vector<std::string_view>& known) {
  std::string text = "expected ";
  for (std::size_t k = 0; k < known.size(); ++k)
    text += (k == 0 ? "" : k + 1 < known.size() ? ", " : " or ") + springstab::quoted(known[k]);
  return text + did_you_mean(word, known);
}

}  // namespace springstab
