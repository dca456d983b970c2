// What ranks must agree on: whether all went well. One that fails ends all, with one line.
#pragma once

#include <functional>
#include <string>

namespace springstab::mpi {

int rank();
int ranks();

/// Whether something is true of every rank. Each must ask.
bool all_of(bool mine);

/// Runs `work`, which communicates with nobody, on every rank. Where it throws on one of them, all throw what
/// the first of these did: std::invalid_argument for bad input, std::bad_alloc, std::runtime_error for the
/// rest.
void together(const std::function<void()>& work);

/// Runs `work`, which communicates. What together() throws passes; anything else ends all ranks with its
/// line.
int guarded(const std::function<int()>& work);

}  // namespace springstab::mpi
