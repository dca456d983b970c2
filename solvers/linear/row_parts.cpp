#include "solvers/linear/row_parts.h"

#include <algorithm>

namespace springstab {
namespace {

constexpr double block_cost = 2;         // [ns]
constexpr double most_read_twice = 0.2;  // of the blocks

// The first place of row i whose column is not before `column`.
long place_from(const BlockPattern& pattern, int i, long column) {
  long low = pattern.row_begin(i), high = pattern.diagonal(i) + 1;
  while (low < high) {
    const long middle = (low + high) / 2;
    if (pattern.column(middle) < column) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

// Row ends such that all parts have about as many blocks.
long end_of(const BlockPattern& pattern, int part, int parts) {
  if (part == parts) return pattern.rows();
  long low = 0, high = pattern.rows();
  while (low < high) {
    const long middle = (low + high) / 2;
    if (pattern.row_begin(static_cast<int>(middle)) < pattern.blocks() * part / parts) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

RowPart row_part(const BlockPattern& pattern, const IndexRange& rows) {
  RowPart part{rows, rows.first, {}};
  for (int i = static_cast<int>(rows.first); i < rows.last; ++i)
    if (pattern.column(pattern.row_begin(i)) < rows.first) part.inner = i + 1;
  for (int i = pattern.rows() - 1; i >= rows.last; --i)
    if (const long first = place_from(pattern, i, rows.first), last = place_from(pattern, i, rows.last);
        first < last)
      part.below.push_back({i, first, last});
  return part;
}

}  // namespace

std::span<const RowPart> RowParts::of(const BlockPattern& pattern) {
  const int wanted = static_cast<double>(pattern.blocks()) * block_cost < worth_sharing ? 1 : loop_threads();
  if (threads_ == wanted) return parts_;
  threads_ = wanted;
  parts_.clear();
  if (wanted == 1) return parts_;
  long twice = 0;
  for (int p = 0; p < wanted; ++p) {
    parts_.push_back(row_part(pattern, {end_of(pattern, p, wanted), end_of(pattern, p + 1, wanted)}));
    for (const RowPart::Below& below : parts_.back().below) twice += below.last - below.first;
  }
  if (static_cast<double>(twice) > most_read_twice * static_cast<double>(pattern.blocks())) parts_.clear();
  return parts_;
}

}  // namespace springstab
