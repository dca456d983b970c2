// Other programs that this one can use where they are installed.
#pragma once

#include <optional>
#include <string>

namespace springstab {

/// Where the program is in PATH.
std::optional<std::string> find_program(const std::string& name);

/// A browser that prints pages without a screen: Chromium or Chrome.
std::optional<std::string> find_browser();

}  // namespace springstab
