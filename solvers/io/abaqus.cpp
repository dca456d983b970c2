#include "solvers/io/abaqus.h"

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace springstab {
namespace {

constexpr std::size_t abaqus_by_nodes = 5, abaqus_by_rows = 3;  // words of an entry

/// Steps to the next entry and splits it; `line` is what the words are of. False at the end.
bool next_abaqus_entry(LineReader& lines, std::string& line, std::vector<std::string_view>& words) {
  words.clear();
  while (words.empty()) {
    if (!lines.next()) return false;
    if (trimmed(lines.line()).starts_with('*')) continue;
    line = lines.line();
    std::ranges::replace(line, ',', ' ');
    append_words(line, words);
  }
  return true;
}

class AbaqusReader {
 public:
  AbaqusReader(std::string_view source, std::string_view text) : source_(source), lines_(source, text) {}

  Eigen::SparseMatrix<double> read(Duplicates duplicates) {
    while (next_abaqus_entry(lines_, line_, words_)) entry();
    if (entries_.empty()) lines_.at().fail("no entries, expected lines such as '1,1, 1,1, 2.5e3'");
    int number = 0;
    for (auto& [degree, index] : numbers_) index = ++number;
    const long long size = size_ == abaqus_by_nodes ? number : largest_;
    const bool above = has([](long long r, long long c) { return r < c; }),
               below = has([](long long r, long long c) { return r > c; });
    const int n = static_cast<int>(size);
    check_rows({source_}, n, n, static_cast<long long>(entries_.size()));
    MatrixBuilder builder(std::string(source_), n, n,
                          above && below ? Symmetry::general : Symmetry::symmetric);
    builder.reserve(entries_.size());
    for (const Entry& e : entries_) builder.add(e.line, index(e.row), index(e.column), e.value);
    return std::move(builder).build(duplicates);
  }

 private:
  using Degree = std::pair<long long, long long>;  // node and degree of freedom; or a row and 0
  struct Entry {
    Degree row, column;
    double value;
    long line;
  };

  void entry() {
    const Location at = lines_.at();
    if (entries_.empty()) size_ = words_.size();
    if (words_.size() != size_ || (size_ != abaqus_by_nodes && size_ != abaqus_by_rows))
      at.fail("an entry of " + std::to_string(words_.size()) + " numbers, expected " +
              (entries_.empty()
                   ? "node, degree of freedom, node, degree of freedom and value; or row, column and value"
                   : "the " + std::to_string(size_) + " of the first entry"));
    const bool by_nodes = size_ == abaqus_by_nodes;
    Entry e{{}, {}, at.fortran_real(words_.back()), at.line};
    e.row = {at.integer(words_[0]), by_nodes ? at.integer(words_[1]) : 0};
    e.column = {at.integer(words_[by_nodes ? 2 : 1]), by_nodes ? at.integer(words_[3]) : 0};
    for (const Degree& degree : {e.row, e.column}) {
      if (by_nodes) {
        numbers_.emplace(degree, 0);
      } else if (degree.first < 1 || degree.first > std::numeric_limits<int>::max()) {
        at.fail("the entry (" + std::to_string(e.row.first) + ", " + std::to_string(e.column.first) +
                ") lies outside any matrix, expected rows and columns from 1 to 2^31 - 1");
      }
      largest_ = std::max(largest_, degree.first);
    }
    entries_.push_back(e);
  }

  long long index(const Degree& degree) const {
    return size_ == abaqus_by_nodes ? numbers_.at(degree) : degree.first;
  }

  template <class Side>
  bool has(const Side& side) const {
    return std::ranges::any_of(entries_, [&](const Entry& e) { return side(index(e.row), index(e.column)); });
  }

  std::string_view source_;
  LineReader lines_;
  std::string line_;
  std::vector<std::string_view> words_;
  std::size_t size_ = 0;
  std::vector<Entry> entries_;
  std::map<Degree, int> numbers_;  // from 1
  long long largest_ = 0;
};

}  // namespace

/// Values have a decimal point: a Matrix Market file without its banner begins with three integers.
bool looks_like_abaqus(std::string_view text) {
  LineReader lines({}, text);
  std::string line;
  std::vector<std::string_view> words;
  if (!next_abaqus_entry(lines, line, words) ||
      (words.size() != abaqus_by_nodes && words.size() != abaqus_by_rows))
    return false;
  const auto is_integer = [](std::string_view word) {
    return word.find_first_not_of("+-0123456789") == word.npos;
  };
  return std::all_of(words.begin(), words.end() - 1, is_integer) &&
         words.back().find('.') != std::string_view::npos &&
         words.back().find_first_not_of("+-.0123456789eEdD") == std::string_view::npos;
}

Eigen::SparseMatrix<double> parse_abaqus(std::string_view source, std::string_view text,
                                         Duplicates duplicates) {
  return AbaqusReader(source, text).read(duplicates);
}

}  // namespace springstab
