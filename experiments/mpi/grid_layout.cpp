#include "experiments/mpi/grid_layout.h"

#include <algorithm>
#include <cmath>

namespace springstab::mpi {
namespace {

IndexRange slice(long count, long part, long parts) {
  return {count * part / parts, count * (part + 1) / parts};
}

// The part that holds an index.
long part_with(long count, long index, long parts) {
  long part = std::min(index * parts / count, parts - 1);
  while (slice(count, part, parts).last <= index) ++part;
  while (slice(count, part, parts).first > index) --part;
  return part;
}

}  // namespace

// Boxes with the shortest edges in all.
GridLayout::GridLayout(const Grid& grid, const std::vector<int>& pinned, int ranks)
    : rows_(grid.rows), columns_(grid.columns) {
  double shortest = INFINITY;
  for (int r = 1; r <= ranks; ++r) {
    if (ranks % r != 0) continue;
    const double edge = static_cast<double>(rows_) / r + static_cast<double>(columns_) / (ranks / r);
    if (edge < shortest) shortest = edge, box_rows_ = r, box_columns_ = ranks / r;
  }
  pinned_.reserve(pinned.size());
  for (const int particle : pinned) pinned_.push_back(place(particle / columns_, particle % columns_));
  std::sort(pinned_.begin(), pinned_.end());
}

IndexRange GridLayout::rows_of(int box_row) const { return slice(rows_, box_row, box_rows_); }
IndexRange GridLayout::columns_of(int box_column) const { return slice(columns_, box_column, box_columns_); }

GridLayout::Box GridLayout::box(int rank) const {
  return {rows_of(rank / box_columns_), columns_of(rank % box_columns_)};
}

// The particles of the boxes before it: whole rows of boxes, and those to its left.
long GridLayout::first_place(int rank) const {
  const Box at = box(std::min(rank, box_rows_ * box_columns_ - 1));
  if (rank == box_rows_ * box_columns_) return rows_ * columns_;
  return at.rows.first * columns_ + (at.rows.last - at.rows.first) * at.columns.first;
}

long GridLayout::place(long row, long column) const {
  const long box_row = part_with(rows_, row, box_rows_),
             box_column = part_with(columns_, column, box_columns_);
  const int owner = static_cast<int>(box_row * box_columns_ + box_column);
  const Box at = box(owner);
  return first_place(owner) + (row - at.rows.first) * at.width() + column - at.columns.first;
}

long GridLayout::free_before(long place) const {
  return place - (std::lower_bound(pinned_.begin(), pinned_.end(), place) - pinned_.begin());
}

IndexRange GridLayout::numbers(int rank) const {
  return {free_before(first_place(rank)), free_before(first_place(rank + 1))};
}

long GridLayout::number(long row, long column) const {
  const long at = place(row, column);
  return std::binary_search(pinned_.begin(), pinned_.end(), at) ? -1 : free_before(at);
}

}  // namespace springstab::mpi
