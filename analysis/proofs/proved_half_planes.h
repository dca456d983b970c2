// What follows from half-planes a d + b k <= c that are proved to hold the joint numerical range W. With
// λ_i >= 0,
//     c M - a D - b K = Σ λ_i (c_i M - a_i D - b_i K) + (c - Σ λ_i c_i) M + (Σ λ_i a_i - a) D + (Σ λ_i b_i -
//     b) K,
// a sum of positive semidefinite matrices where the last three numbers are not negative, M, D and K being so:
//     ProvedHalfPlanes proved;
//     proved.add(4, 0, 1);       // 4 M - K is positive definite
//     proved.add(4, 2, 0);       // and so is 4 M - 2 D
//     proved.imply(4, 1, 0.4);   // so 4 M - D - 0.4 K is: half of each, and more
//     proved.imply(4, 1, 0.6);   // no
#pragma once

#include <vector>

namespace springstab {

class ProvedHalfPlanes {
 public:
  /// c M - a D - b K is positive semidefinite, c >= 0.
  void add(double c, double a, double b);

  /// Whether c M - a D - b K follows to be so, in spite of the rounding of the λ_i.
  bool imply(double c, double a, double b) const;

 private:
  struct Triple {
    double c, a, b;
  };
  std::vector<Triple> proved_;
};

}  // namespace springstab
