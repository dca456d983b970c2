// Runs of linear structures between walls, at a part of the limit that they have without them: which diverge.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "analysis/method.h"
#include "solvers/contact/contact.h"

namespace springstab {

/// Random chains, random nets, or pieces of cloth stretched by a hundredth: without damping, of a few to some
/// dozens of masses.
inline constexpr const char* walled_structures[] = {"chains", "nets", "cloth"};

struct WalledRuns {
  std::string structure;
  Method method;
  ContactModel model;
  double part;  // of the method's own limit for the structure
  int runs = 0, diverged = 0;
  double largest_energy = 0;  // over that of the start, of those that did not
};

/// Runs number 1 to `count`: every one has its structure, one to four walls through the places of all masses
/// or near them, and a random push. It has diverged where kinetic and elastic energy exceed a thousand times
/// the push.
WalledRuns run_between_walls(const WalledRuns& what, int count, long steps);

}  // namespace springstab
