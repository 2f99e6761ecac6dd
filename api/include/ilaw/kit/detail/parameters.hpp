// parameters.hpp - fills a law's parameters from the arguments of create, and refuses what is wrong by name.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/law.hpp>
#include <ilaw/kit/math.hpp>
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

// A parameter given as a table in time: piecewise linear, constant beyond its ends.
struct time_table {
  double* times = nullptr;  // owned by the instance; behind them the values
  std::uint64_t count = 0;

  const double* values() const { return times + count; }
  // Position of the first time after one.
  std::uint64_t after(double time) const {
    std::uint64_t low = 0, high = count;
    while (low < high) {
      const std::uint64_t middle = (low + high) / 2;
      if (times[middle] > time)
        high = middle;
      else
        low = middle + 1;
    }
    return low;
  }
  double next_time(double time) const {
    const std::uint64_t k = after(time);
    return k < count ? times[k] : infinity;
  }
  double at(double time) const {
    const std::uint64_t k = after(time);
    if (k == 0) return values()[0];
    if (k == count) return values()[count - 1];
    const double t0 = times[k - 1], t1 = times[k], y0 = values()[k - 1], y1 = values()[k];
    const double fraction = (time - t0) / (t1 - t0);
    // At its ends a segment has their values, also beside an infinite one.
    if (y0 == y1 || fraction == 0.0) return y0;
    return fraction == 1.0 ? y1 : y0 * (1.0 - fraction) + y1 * fraction;
  }
};

// What a parameter may be.
struct parameter_range {
  double minimum, excluded, maximum, beyond;

  constexpr parameter_range(double least, bool excludes, double most, bool allows_infinity)
      : minimum(least),
        excluded(excludes ? least : not_a_number),
        maximum(smaller(most, std::numeric_limits<double>::max())),
        beyond(allows_infinity ? infinity : not_a_number) {}
  template <class V>
  ILAW_KIT_INLINE auto has(V value) const {
    return (value >= minimum) & (value != excluded) & ((value <= maximum) | (value == beyond));
  }
};
inline bool in_range(const ilaw_parameter& p, double value) {
  return parameter_range(p.minimum, p.flags & ILAW_PARAMETER_EXCLUDES_MINIMUM, p.maximum,
                         p.flags & ILAW_PARAMETER_ALLOWS_INFINITY)
      .has(value);
}

inline void add_range(message& text, const ilaw_parameter& p) {
  text.add("%s%g, ", p.flags & ILAW_PARAMETER_EXCLUDES_MINIMUM ? "(" : "[", p.minimum);
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
inline ilaw_result check_number(const char* law, const ilaw_parameter& p, double value, message& text) {
  const bool whole = p.kind != ILAW_PARAMETER_COUNT || value == __builtin_floor(value);
  if (in_range(p, value) && whole) return ILAW_OK;
  text.add("law '%s': parameter '%s' = ", law, p.name);
  add_number(text, value);
  text.add(" is not allowed: expected a %snumber in ", p.kind == ILAW_PARAMETER_COUNT ? "whole " : "");
  add_range(text, p);
  return ILAW_INVALID_PARAMETER;
}

inline ilaw_result read_choice(const char* law, const ilaw_parameter& p, const ilaw_argument& a,
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

inline ilaw_result read_number(const char* law, const ilaw_parameter& p, const ilaw_argument& a,
                                double& value, message& text) {
  if (a.kind == ILAW_VALUE_NUMBER) {
    value = a.number;
    return check_number(law, p, value, text);
  }
  const char* given = a.kind == ILAW_VALUE_TEXT       ? "a text"
                      : a.kind == ILAW_VALUE_TABLE    ? "a table"
                      : a.kind == ILAW_VALUE_PER_NODE ? "a value per node"
                                                      : "a value of unknown kind";
  text.add("law '%s': parameter '%s' was given as %s", law, p.name, given);
  if (a.kind == ILAW_VALUE_TEXT) text.add(" (\"%s\")", a.text ? a.text : "");
  text.add(": expected a number in ");
  add_range(text, p);
  return ILAW_INVALID_PARAMETER;
}

// Checks a table over time: points finite and increasing, values in range.
inline ilaw_result check_table(const char* law, const ilaw_parameter& p, const ilaw_argument& a, ilaw_axis& axis,
                               message& text) {
  const auto refuse = [&](const char* what) {
    text.add("law '%s': parameter '%s': the table %s", law, p.name, what);
    return ILAW_INVALID_PARAMETER;
  };
  if (a.axis_count != 1 || !a.axes) return refuse("has no or several axes, expected 1");
  if (!sized::is_complete(a.axes[0])) return refuse("has an axis that is null or whose struct_size is of no version");
  axis = sized::read(a.axes[0]);
  if (!axis.name || std::strcmp(axis.name, "time") != 0) {
    text.add("law '%s': parameter '%s': axis '%s' of the table is unknown: expected 'time'", law, p.name,
             axis.name ? axis.name : "");
    return ILAW_INVALID_PARAMETER;
  }
  if (!axis.points || !a.values || axis.count == 0) return refuse("has no point, expected at least 1");
  if (axis.count > ILAW_TABLE_MAX_VALUES) return refuse("has more than 16777216 points");
  for (std::uint64_t k = 0; k < axis.count; ++k) {
    const double time = axis.points[k];
    if (!is_finite(time) || (k > 0 && time <= axis.points[k - 1])) {
      text.add("law '%s': parameter '%s': time ", law, p.name);
      add_number(text, time);
      text.add(" of point %llu of the table is not allowed: expected finite, increasing times",
               static_cast<unsigned long long>(k));
      return ILAW_INVALID_PARAMETER;
    }
    if (const ilaw_result code = check_number(law, p, a.values[k], text); code != ILAW_OK) return code;
  }
  return ILAW_OK;
}

}  // namespace ilaw::kit::detail
