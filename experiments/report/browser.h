// A page as PDF, as a browser prints it.
#pragma once

#include <functional>
#include <string>

namespace springstab {

inline constexpr char needs_browser[] =
    "needs a browser to print, expected Chromium to be installed (chromium)";

/// The PDF; empty where `stop` says so before the browser is done, which ends it. Throws InputError where
/// there is no browser, or it fails or takes two minutes.
std::string printed_as_pdf(const std::string& page, const std::function<bool()>& stop);

}  // namespace springstab
