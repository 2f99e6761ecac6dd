// decimal_text.hpp - numbers in messages and descriptions: the same text whatever the locale of the host.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace ilaw {

// A number in decimal digits, with a dot. Needs the C library alone, as the libraries of laws do.
class decimal_text {
 public:
  // With as few digits as read back to the same number, from 15 on.
  explicit decimal_text(double value) {
    int digits = 15;
    do std::snprintf(text_, sizeof text_, "%.*g", digits, value);
    while (digits++ < 17 && std::strtod(text_, nullptr) != value);
    put_dot();
  }
  decimal_text(double value, int digits) {
    std::snprintf(text_, sizeof text_, "%.*g", digits, value);
    put_dot();
  }
  const char* get() const { return text_; }

 private:
  // The locale decides on the decimal point, of one byte or several.
  void put_dot() {
    char* to = text_;
    for (const char* from = text_; *from; ++from)
      if (std::strchr("+-0123456789einfa", *from))
        *to++ = *from;
      else if (to == text_ || to[-1] != '.')
        *to++ = '.';
    *to = '\0';
  }

  char text_[48];
};

}  // namespace ilaw
