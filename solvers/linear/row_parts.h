// How threads divide the rows of a symmetric matrix of which the lower triangle is stored. A part is some
// rows in a row. Of a block that lies below a part's rows in one of its columns, the part takes the
// transposed half itself, before its own rows: so nothing is added by two threads, each sum has the order
// that it has on one thread, and what is read twice is one bandwidth of rows a part.
#pragma once

#include <span>
#include <vector>

#include "solvers/linear/block_pattern.h"
#include "solvers/team.h"

namespace springstab {

struct RowPart {
  IndexRange rows;
  long inner;  // rows from here on have no blocks in columns before the part
  struct Below {
    int row;           // after the part
    long first, last;  // places of its blocks in the part's columns
  };
  std::vector<Below> below;  // rows descend
};

class RowParts {
 public:
  /// One for each thread, made anew where their number has changed; none where that is not worth it: of small
  /// matrices, and of such with so large a bandwidth that parts would read much of each other. Always the
  /// same pattern.
  std::span<const RowPart> of(const BlockPattern& pattern);

 private:
  int threads_ = 1;
  std::vector<RowPart> parts_;
};

}  // namespace springstab
