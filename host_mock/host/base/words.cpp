// SPDX-License-Identifier: BSD-3-Clause
#include "base/words.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <filesystem>
#include <new>

namespace ilaw::host {
namespace {

// Fewest edits that turn one word into another (Levenshtein 1966).
std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

}  // namespace

std::string message_of(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error)) return "out of memory";
  const auto* const failed = dynamic_cast<const std::filesystem::filesystem_error*>(&error);
  if (!failed) return error.what();
  if (failed->path1().empty()) return "found an empty name, expected that of a file or a folder";
  return failed->path1().string() + ": " + failed->code().message();
}

std::string formatted(const char* format, ...) {
  std::va_list values, again;
  va_start(values, format);
  va_copy(again, values);
  std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, values)), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  va_end(values);
  return text;
}

std::string in_digits(double value, int digits) { return formatted("%.*g", digits, value); }

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string suggestion(const std::string& found, const std::vector<std::string>& words) {
  std::size_t fewest = 3;
  std::string nearest;
  for (const std::string& word : words)
    if (const std::size_t count = edits(found, word); count < fewest) {
      fewest = count;
      nearest = word;
    }
  return nearest.empty() ? "" : " (did you mean '" + nearest + "'?)";
}

}  // namespace ilaw::host
