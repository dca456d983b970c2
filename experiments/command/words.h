// Help for a misspelt word.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace springstab {

/// " (did you mean 'soft'?)" with the nearest of the words that are known, whether in capitals or not; empty
/// if none is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& known);

/// The half of a message about an unknown word that says what was expected:
/// "expected 'soft' or 'stiff' (did you mean 'soft'?)".
std::string expected_one_of(std::string_view word, const std::vector<std::string_view>& known);

}  // namespace springstab
