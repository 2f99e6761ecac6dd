// parameters.hpp - fills a law's parameters from the arguments of create, and refuses what is wrong by name.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/decimal_text.hpp>
#include <ilaw/kit/law.hpp>
#include <ilaw/sized.hpp>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// One line for the caller of create, "law '...': ...", why it fails; text that does not fit is cut.
class message {
 public:
  message(const char* law, char* text, std::size_t size) : law_(law), text_(text), size_(text ? size : 0) {
    if (size_ > 0) text_[0] = '\0';
  }

  [[gnu::format(printf, 3, 4)]] ilaw_result refuse(ilaw_result code, const char* format, ...) {
    add("law '%s': ", law_);
    va_list arguments;
    va_start(arguments, format);
    write(format, arguments);
    va_end(arguments);
    return code;
  }
  [[gnu::format(printf, 2, 3)]] void add(const char* format, ...) {
    va_list arguments;
    va_start(arguments, format);
    write(format, arguments);
    va_end(arguments);
  }

 private:
  [[gnu::format(printf, 2, 0)]] void write(const char* format, va_list arguments) {
    if (used_ + 1 >= size_) return;
    const int length = std::vsnprintf(text_ + used_, size_ - used_, format, arguments);
    if (length > 0) used_ += static_cast<std::size_t>(length);
  }

  const char* law_;
  char* text_;
  std::size_t size_, used_ = 0;
};

inline bool in_range(const ilaw_parameter& p, double value) {
  return parameter_range(p.minimum, p.flags & ILAW_FLAG_EXCLUDES_MINIMUM, p.maximum,
                         p.flags & ILAW_FLAG_ALLOWS_INFINITY)
      .has(value);
}

inline void add_number(message& text, double value) { text.add("%s", decimal_text(value).get()); }

inline void add_range(message& text, const ilaw_parameter& p) {
  text.add("%s%s, ", p.flags & ILAW_FLAG_EXCLUDES_MINIMUM ? "(" : "[", decimal_text(p.minimum).get());
  if (p.flags & ILAW_FLAG_ALLOWS_INFINITY)
    text.add("inf]");
  else if (p.maximum == std::numeric_limits<double>::max())
    text.add("inf)");
  else
    text.add("%s]", decimal_text(p.maximum).get());
}

inline void add_choices(message& text, const ilaw_parameter& p) {
  for (std::uint32_t i = 0; i < p.choice_count; ++i) text.add("%s\"%s\"", i ? ", " : "", p.choices[i]);
}

inline void add_value(message& text, const ilaw_parameter& p, double value) {
  if (p.kind == ILAW_KIND_CHOICE)
    text.add("\"%s\"", p.choices[static_cast<std::uint32_t>(value)]);
  else
    add_number(text, value);
}

// Checks one number against the range of its parameter.
inline ilaw_result check_number(const ilaw_parameter& p, double value, message& text) {
  const bool whole = p.kind != ILAW_KIND_INTEGER || value == __builtin_floor(value);
  if (in_range(p, value) && whole) return ILAW_OK;
  const ilaw_result code = text.refuse(ILAW_INVALID_PARAMETER, "parameter '%s' = ", p.name);
  add_number(text, value);
  text.add(" is not allowed: expected a %snumber in ", p.kind == ILAW_KIND_INTEGER ? "whole " : "");
  add_range(text, p);
  return code;
}

inline ilaw_result read_choice(const ilaw_parameter& p, const ilaw_argument& a, double& value,
                               message& text) {
  const bool is_text = a.kind == ILAW_KIND_VALUE_TEXT && a.text;
  for (std::uint32_t i = 0; is_text && i < p.choice_count; ++i)
    if (std::strcmp(p.choices[i], a.text) == 0) {
      value = i;
      return ILAW_OK;
    }
  const ilaw_result code = text.refuse(ILAW_INVALID_PARAMETER, "parameter '%s' = ", p.name);
  if (is_text)
    text.add("\"%s\"", a.text);
  else if (a.kind == ILAW_KIND_VALUE_NUMBER)
    add_number(text, a.number);
  else
    text.add("a table or array");
  text.add(" is not allowed: expected one of ");
  add_choices(text, p);
  return code;
}

inline ilaw_result read_number(const ilaw_parameter& p, const ilaw_argument& a, double& value,
                               message& text) {
  if (a.kind == ILAW_KIND_VALUE_NUMBER) {
    value = a.number;
    return check_number(p, value, text);
  }
  const char* given = a.kind == ILAW_KIND_VALUE_TEXT       ? "a text"
                      : a.kind == ILAW_KIND_VALUE_TABLE    ? "a table"
                      : a.kind == ILAW_KIND_VALUE_PER_NODE ? "a value per node"
                                                           : "a value of unknown kind";
  const ilaw_result code =
      text.refuse(ILAW_INVALID_PARAMETER, "parameter '%s' was given as %s", p.name, given);
  if (a.kind == ILAW_KIND_VALUE_TEXT) text.add(" (\"%s\")", a.text ? a.text : "");
  text.add(": expected a number in ");
  add_range(text, p);
  return code;
}

// Checks an axis of a table: known, named once, points finite and increasing. known: its place in p.axes.
inline ilaw_result check_axis(const ilaw_parameter& p, const ilaw_axis& axis, std::uint32_t& known,
                              message& text) {
  constexpr ilaw_result code = ILAW_INVALID_PARAMETER;
  if (!axis.name || !axis.points || axis.count == 0)
    return text.refuse(
        code, "parameter '%s': the table has an axis without a name or point, expected at least 1 point",
        p.name);
  known = 0;
  while (known < p.axis_count && std::strcmp(p.axes[known], axis.name) != 0) ++known;
  if (known == p.axis_count) {
    text.refuse(code, "parameter '%s': axis '%s' of the table is unknown: expected one of ", p.name,
                axis.name);
    for (std::uint32_t k = 0; k < p.axis_count; ++k) text.add("%s'%s'", k ? ", " : "", p.axes[k]);
    return code;
  }
  for (std::uint64_t k = 0; k < axis.count; ++k)
    if (const double x = axis.points[k]; !is_finite(x) || (k > 0 && x <= axis.points[k - 1])) {
      text.refuse(code, "parameter '%s': point %llu of axis '%s' is ", p.name,
                  static_cast<unsigned long long>(k), axis.name);
      add_number(text, x);
      text.add(": expected finite, increasing points");
      return code;
    }
  return ILAW_OK;
}

// Checks a table, and keeps it.
inline ilaw_result read_table(const ilaw_parameter& p, const ilaw_argument& a, table& made, message& text) {
  const auto refuse = [&](const char* fault, const char* axis = "") {
    return text.refuse(ILAW_INVALID_PARAMETER, "parameter '%s': the table %s%s", p.name, fault, axis);
  };
  if (a.axis_count < 1 || a.axis_count > 3 || !a.axes)
    return refuse("has no axis or more than three, expected 1 to 3");
  if (!a.values) return refuse("has no values");
  ilaw_axis axes[3];
  std::uint64_t size = 1, stored = 0;
  for (std::uint32_t i = 0; i < a.axis_count; ++i) {
    if (!sized::is_complete(a.axes[i]))
      return refuse("has an axis that is null or whose struct_size is of no version");
    axes[i] = sized::read(a.axes[i]);
    std::uint32_t known = 0;
    if (const ilaw_result code = check_axis(p, axes[i], known, text); code != ILAW_OK) return code;
    made.named_axis[i] = static_cast<int>(known);
    for (std::uint32_t k = 0; k < i; ++k)
      if (std::strcmp(axes[k].name, axes[i].name) == 0) return refuse("has twice the axis ", axes[i].name);
    if (axes[i].count > ILAW_TABLE_MAX_VALUES / size) return refuse("has more than 16777216 values");
    size *= axes[i].count;
    stored += axes[i].count;
  }
  for (std::uint64_t k = 0; k < size; ++k)
    if (const ilaw_result code = check_number(p, a.values[k], text); code != ILAW_OK) return code;
  auto* memory = static_cast<double*>(std::malloc((stored + size) * sizeof(double)));
  if (!memory)
    return text.refuse(ILAW_OUT_OF_MEMORY, "out of memory for the table of parameter '%s'", p.name);
  made.axis_count = static_cast<int>(a.axis_count);
  for (std::uint32_t i = 0; i < a.axis_count; ++i) {
    made.count[i] = axes[i].count;
    made.points[i] = memory;
    std::memcpy(memory, axes[i].points, axes[i].count * sizeof(double));
    memory += axes[i].count;
  }
  made.values = memory;
  std::memcpy(memory, a.values, size * sizeof(double));
  return ILAW_OK;
}

}  // namespace ilaw::kit::detail
