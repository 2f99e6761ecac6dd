// words.hpp - numbers, names and exceptions in messages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <string>
#include <vector>

namespace ilaw::host {

// A text as of printf, however long.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

// One sentence, also of what the standard library throws where memory or a file is missing.
std::string message_of(const std::exception& error);

// A number in so many digits at most.
std::string in_digits(double value, int digits);

// "one, two, three".
std::string joined(const std::vector<std::string>& words);

// " (did you mean 'one'?)" with the nearest of the words, or nothing where none is near.
std::string suggestion(const std::string& found, const std::vector<std::string>& words);

}  // namespace ilaw::host
