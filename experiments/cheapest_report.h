// What `limits` says at its end: which method costs least, and how many of its steps make a frame.
#pragma once

#include "analysis/limits/cheapest_method.h"
#include "experiments/command/output.h"
#include "experiments/limits_options.h"

namespace springstab {

/// Throws InputError for an error that is none.
void check_error(const std::optional<double>& error);
/// The same, and for a frame rate that is none.
void check_cheapest(const LimitsOptions& options);

/// `limits_seconds` is the CPU time that the limits took, of which measuring takes a few per cent [s].
CheapestOptions cheapest_options(const LimitsOptions& options, double limits_seconds);

/// Why the cheapest one is; empty where there is none.
std::string reason(const CheapestMethod& cheapest, const CheapestOptions& options);

/// null where no method has a step that succeeds.
Json cheapest_json(const CheapestMethod& cheapest, const CheapestOptions& options);

/// `substeps`, `frame_step`, `error_step` and `predicted_error`, as far as the options ask for them, beside
/// what else is said of a method.
void add_steps(Json& json, const CheapestMethod& cheapest, const Method& method, const MethodLimits& limits,
               const CheapestOptions& options);

/// With the substeps of a frame where a frame rate is given.
void print_cheapest(std::ostream& out, const CheapestMethod& cheapest, StructureLimits& answer,
                    std::span<const Method> methods, const CheapestOptions& options);

}  // namespace springstab
