// SPDX-License-Identifier: Apache-2.0
// Checks of option values; each message names the option, the value and what is allowed.
#pragma once

#include <string>
#include <vector>

namespace sunder::app {

/// Throws UsageError unless `value` is one of `allowed`.
void check_word(const std::string& option, const std::string& value,
                const std::vector<std::string>& allowed);

/// A whole number of at least `least`. Throws UsageError.
[[nodiscard]] int whole_number(const std::string& option, const std::string& value, int least);

/// "5,10,20": whole numbers of at least 1. Throws UsageError.
[[nodiscard]] std::vector<int> number_list(const std::string& option, const std::string& value);

/// A finite number above zero. Throws UsageError.
[[nodiscard]] double positive_number(const std::string& option, const std::string& value);

}  // namespace sunder::app
