// parameters.hpp - fills a law's parameters from the arguments of create, and refuses what is wrong by name.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/declare.hpp>
#include <ilaw/sized.hpp>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// One line for the caller of create; text that does not fit is cut.
class message {
 public:
  message(char* text, std::size_t size) : text_(text), size_(text ? size : 0) {
    if (size_ > 0) text_[0] = '\0';
  }

  [[gnu::format(printf, 2, 3)]] void add(const char* format, ...) {
    if (used_ + 1 >= size_) return;
    va_list arguments;
    va_start(arguments, format);
    const int length = std::vsnprintf(text_ + used_, size_ - used_, format, arguments);
    va_end(arguments);
    if (length > 0) used_ += static_cast<std::size_t>(length);
  }

 private:
  char* text_;
  std::size_t size_, used_ = 0;
};

// A parameter given as a table in time.
struct time_table {
  const ilaw_parameter* parameter;
  double* pairs;  // owned by the instance
  std::uint64_t count;

  // The first of its times after one; infinity where there is none.
  double next_time(double time) const {
    std::uint64_t low = 0, high = count;
    while (low < high) {
      const std::uint64_t middle = (low + high) / 2;
      if (pairs[2 * middle] > time)
        high = middle;
      else
        low = middle + 1;
    }
    return low < count ? pairs[2 * low] : infinity;
  }

  // Piecewise linear, constant outside its ends.
  double at(double time) const {
    if (time <= pairs[0]) return pairs[1];
    std::uint64_t low = 0, high = count - 1;
    if (time >= pairs[2 * high]) return pairs[2 * high + 1];
    while (high - low > 1) {
      const std::uint64_t middle = (low + high) / 2;
      (time < pairs[2 * middle] ? high : low) = middle;
    }
    const double t0 = pairs[2 * low], t1 = pairs[2 * high], y0 = pairs[2 * low + 1], y1 = pairs[2 * high + 1];
    const double fraction = (time - t0) / (t1 - t0);
    // At its ends a segment has their values, also beside an infinite one.
    if (y0 == y1 || fraction == 0.0) return y0;
    return fraction == 1.0 ? y1 : y0 * (1.0 - fraction) + y1 * fraction;
  }
};

// What a parameter may be, without a branch: the loops over nodes ask it, too.
struct parameter_range {
  double minimum, excluded, maximum, beyond;

  explicit parameter_range(const ilaw_parameter& p)
      : minimum(p.minimum),
        excluded((p.flags & ILAW_PARAMETER_EXCLUDES_MINIMUM) ? p.minimum
                                                             : std::numeric_limits<double>::quiet_NaN()),
        maximum(smaller(p.maximum, std::numeric_limits<double>::max())),
        beyond((p.flags & ILAW_PARAMETER_ALLOWS_INFINITY) ? infinity
                                                          : std::numeric_limits<double>::quiet_NaN()) {}
  bool has(double value) const {
    return (value >= minimum) & (value != excluded) & ((value <= maximum) | (value == beyond));
  }
};
inline bool in_range(const ilaw_parameter& p, double value) { return parameter_range(p).has(value); }

inline void add_range(message& text, const ilaw_parameter& p) {
  text.add("%s%g, ", (p.flags & ILAW_PARAMETER_EXCLUDES_MINIMUM) ? "(" : "[", p.minimum);
  if (p.flags & ILAW_PARAMETER_ALLOWS_INFINITY)
    text.add("inf]");
  else if (p.maximum == std::numeric_limits<double>::max())
    text.add("inf)");
  else
    text.add("%g]", p.maximum);
}

inline void add_choices(message& text, const ilaw_parameter& p) {
  for (std::uint32_t i = 0; i < p.choice_count; ++i) text.add("%s\"%s\"", i ? ", " : "", p.choices[i]);
}

// With as few digits as read back to the same number.
inline void add_number(message& text, double value) {
  char digits[32];
  int precision = 15;
  do std::snprintf(digits, sizeof digits, "%.*g", precision, value);
  while (precision++ < 17 && std::strtod(digits, nullptr) != value);
  text.add("%s", digits);
}

inline void add_value(message& text, const ilaw_parameter& p, double value) {
  if (p.kind == ILAW_PARAMETER_CHOICE)
    text.add("\"%s\"", p.choices[static_cast<std::uint32_t>(value)]);
  else
    add_number(text, value);
}

// Checks one number against the range of its parameter.
inline std::int32_t check_number(const char* law, const ilaw_parameter& p, double value, message& text) {
  const bool whole = p.kind != ILAW_PARAMETER_COUNT || value == __builtin_floor(value);
  if (in_range(p, value) && whole) return ILAW_OK;
  text.add("law '%s': parameter '%s' = ", law, p.name);
  add_number(text, value);
  text.add(" is not allowed: expected a %snumber in ", p.kind == ILAW_PARAMETER_COUNT ? "whole " : "");
  add_range(text, p);
  return ILAW_INVALID_PARAMETER;
}

inline std::int32_t read_choice(const char* law, const ilaw_parameter& p, const ilaw_argument& a,
                                double& value, message& text) {
  if (a.kind == ILAW_VALUE_TEXT && a.text)
    for (std::uint32_t i = 0; i < p.choice_count; ++i)
      if (std::strcmp(p.choices[i], a.text) == 0) {
        value = i;
        return ILAW_OK;
      }
  text.add("law '%s': parameter '%s' = ", law, p.name);
  if (a.kind == ILAW_VALUE_TEXT && a.text)
    text.add("\"%s\"", a.text);
  else if (a.kind == ILAW_VALUE_NUMBER)
    add_number(text, a.number);
  else
    text.add("a table or array");
  text.add(" is not allowed: expected one of ");
  add_choices(text, p);
  return ILAW_INVALID_PARAMETER;
}

inline std::int32_t read_number(const char* law, const ilaw_parameter& p, const ilaw_argument& a,
                                double& value, message& text) {
  if (a.kind == ILAW_VALUE_NUMBER) {
    value = a.number;
    return check_number(law, p, value, text);
  }
  const char* given = a.kind == ILAW_VALUE_TEXT       ? "a text"
                      : a.kind == ILAW_VALUE_TABLE    ? "a table in time"
                      : a.kind == ILAW_VALUE_PER_NODE ? "a value per node"
                                                      : "a value of unknown kind";
  text.add("law '%s': parameter '%s' was given as %s", law, p.name, given);
  if (a.kind == ILAW_VALUE_TEXT) text.add(" (\"%s\")", a.text ? a.text : "");
  text.add(": expected a number in ");
  add_range(text, p);
  return ILAW_INVALID_PARAMETER;
}

// Checks a table over time: times finite and increasing, values in range.
inline std::int32_t check_table(const char* law, const ilaw_parameter& p, const ilaw_argument& a,
                                message& text) {
  const auto refused = [&](const char* why) {
    text.add("law '%s': parameter '%s': %s", law, p.name, why);
    return ILAW_INVALID_PARAMETER;
  };
  if (a.axis_count != 1 || !a.axes || !sized::is_complete(a.axes[0]))
    return refused("the table has no axis, more than one or a broken one; expected one axis \"time\"");
  const ilaw_axis axis = sized::read(a.axes[0]);
  if (!axis.name || std::strcmp(axis.name, "time") != 0) {
    text.add("law '%s': parameter '%s': a table over '%s' is not served; expected an axis \"time\"", law,
             p.name, axis.name ? axis.name : "(null)");
    return ILAW_INVALID_PARAMETER;
  }
  if (!a.values || !axis.points || axis.count == 0)
    return refused("the table is empty; expected at least one time and value");
  if (axis.count > ILAW_TABLE_MAX_VALUES) return refused("the table has more than 2^24 values");
  for (std::uint64_t k = 0; k < axis.count; ++k) {
    const double time = axis.points[k];
    if (!is_finite(time) || (k > 0 && time <= axis.points[k - 1])) {
      text.add("law '%s': parameter '%s': time ", law, p.name);
      add_number(text, time);
      text.add(" at place %llu of the table is not allowed: expected finite, increasing times",
               static_cast<unsigned long long>(k));
      return ILAW_INVALID_PARAMETER;
    }
    if (const std::int32_t code = check_number(law, p, a.values[k], text); code != ILAW_OK) return code;
  }
  return ILAW_OK;
}

}  // namespace ilaw::kit::detail
