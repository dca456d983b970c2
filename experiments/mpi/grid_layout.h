// Who has which particles of a grid, and which numbers they have: a box of rows and columns for each rank, as
// square as the number of ranks allows, and the free particles numbered box by box.
#pragma once

#include <vector>

#include "solvers/scene/spring_cloth.h"
#include "solvers/team.h"

namespace springstab::mpi {

class GridLayout {
 public:
  /// Of an input's grid and its pinned particles, ascending.
  GridLayout(const Grid& grid, const std::vector<int>& pinned, int ranks);

  struct Box {
    IndexRange rows, columns;
    long width() const { return columns.last - columns.first; }
  };
  Box box(int rank) const;
  /// The numbers of the rank's free particles.
  IndexRange numbers(int rank) const;
  /// Of the particle in that row and column; -1 of a pinned one.
  long number(long row, long column) const;

 private:
  long place(long row, long column) const;  // with the pinned ones
  long first_place(int rank) const;
  long free_before(long place) const;
  IndexRange rows_of(int box_row) const;
  IndexRange columns_of(int box_column) const;

  long rows_, columns_;
  int box_rows_ = 1, box_columns_ = 1;
  std::vector<long> pinned_;  // their places, ascending
};

}  // namespace springstab::mpi
