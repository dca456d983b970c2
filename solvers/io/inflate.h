// What was deflated by zlib, as archives of NumPy's and VTK's XML files hold it.
#pragma once

#include <string>
#include <string_view>

#include "solvers/io/text_file.h"

namespace springstab {

enum class Deflated { raw, with_zlib_header };

/// Whether this program was built with zlib.
bool has_zlib();

/// The `size` bytes that were deflated to these. Throws InputError where they are not that, and before
/// anything is allocated where they cannot be: deflate packs at most 1032 to one. Likewise where this program
/// was built without zlib.
std::string inflated(std::string_view bytes, std::size_t size, Deflated form, const Location& at);

}  // namespace springstab
