// Which run something on disk belongs to: program, command, options, and inputs by their contents. What an
// interrupted run kept serves that run and no other.
#pragma once

#include <string>
#include <vector>

#include "experiments/command/options.h"
#include "experiments/command/output.h"
#include "experiments/inputs/subject.h"

namespace springstab {

/// The identity of a command with options and inputs (contents_of). Also says which program and machine it
/// is.
Json identity_of(const std::string& command, const Json& options, const Json& inputs);

/// U+FFFD in place of what is not UTF-8, as a file's name may be; JSON takes nothing else.
std::string as_utf8(const std::string& text);

/// All bytes of a file; throws InputError if it cannot be read.
std::string bytes_of(const std::string& path);

/// A hash of each file, with that of the mesh which a scene file names, and the input options as given.
/// To `resume`, throws InputError for a pipe, which cannot be read again.
Json contents_of(const InputOptions& input, bool resume);
/// The same of one scene file, mesh or matrix.
Json contents_of(const std::string& file, bool resume);

/// What is wrong with --resume alone.
inline constexpr char needs_output[] = "needs --output, the folder where a run keeps what it has finished";

/// Throws InputError where `path`, in which a run keeps what it has finished, is there already and nobody
/// says what is to become of it, and for --resume beside --overwrite.
void expect_decided(const std::string& path, const EarlierRun& earlier);

/// Throws InputError(path, line, ...) that names the first difference unless both are the same.
void expect_same_run(const Json& kept, const Json& now, const std::string& path, long line);

}  // namespace springstab
