// Counts what this program's own code (its libraries' headers included) takes from the heap. The linker's
// --wrap sends malloc and operator new through the counter, so it works under sanitizers and valgrind, too.
#pragma once

namespace springstab {

/// Allocations on all threads since the program started.
long allocations();

}  // namespace springstab
