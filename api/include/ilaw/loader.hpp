// loader.hpp - loader.h for C++20: owners instead of handles, exceptions instead of codes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/loader.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <locale>
#include <memory>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace ilaw {

// Thrown with the loader's or the law's one-line message; code is one of ILAW_* of ilaw.h.
class error : public std::runtime_error {
 public:
  error(ilaw_result code, const std::string& text) : std::runtime_error(text), code_(code) {}
  ilaw_result code() const { return code_; }

 private:
  ilaw_result code_;
};

// Arguments of create: names and values, kept here. Use: ilaw::parameters p; p.number("friction", 0.3);
// p.give(setup).
class parameters {
 public:
  struct axis {
    std::string name;
    std::vector<double> points;
  };

  parameters& number(const std::string& name, double value) {
    entry& made = add(name, ILAW_KIND_VALUE_NUMBER);
    made.number = value;
    return *this;
  }
  parameters& text(const std::string& name, const std::string& choice) {
    entry& made = add(name, ILAW_KIND_VALUE_TEXT);
    made.text = choice;
    return *this;
  }
  // A value as a user writes it, "0.3", "inf" or "moreau", by the law's description of the parameter. Throws
  // error with what is allowed.
  parameters& set(const ilaw_law& law, const std::string& name, const std::string& value) {
    const ilaw_parameter& p = described(law, name);
    if (p.kind > ILAW_KIND_INTEGER) {
      bool known = p.kind != ILAW_KIND_CHOICE;  // of a newer minor version
      for (std::uint32_t i = 0; i < p.choice_count; ++i) known = known || value == p.choices[i];
      if (!known) refuse(law, name, value, "one of " + listed(p.choices, p.choice_count));
      return text(name, value);
    }
    const bool has_infinity = (p.flags & ILAW_FLAG_ALLOWS_INFINITY) != 0;
    if (has_infinity && value == "inf") return number(name, std::numeric_limits<double>::infinity());
    std::istringstream digits(value);
    digits.imbue(std::locale::classic());  // a decimal point in every country
    double found = 0.0;
    const bool is_number = digits >> std::noskipws >> found && digits.peek() == std::char_traits<char>::eof();
    if (!is_number || (p.kind == ILAW_KIND_INTEGER && found != std::floor(found)))
      refuse(law, name, value,
             std::string(p.kind == ILAW_KIND_INTEGER ? "a whole number" : "a number") +
                 (has_infinity ? " or inf" : ""));
    return number(name, found);
  }
  // The last axis varies fastest; throws error unless there is one value per point of the grid.
  parameters& table(const std::string& name, const std::vector<axis>& axes,
                    const std::vector<double>& values) {
    std::size_t points = axes.empty() ? 0 : 1;
    for (const axis& along : axes)
      points = along.points.size() > values.size() ? 0 : points * along.points.size();
    if (points == 0 || points != values.size())
      throw error(ILAW_INVALID_PARAMETER, "parameter '" + name + "': a table of " +
                                              std::to_string(values.size()) +
                                              " values; expected one value per point of its axes");
    entry& made = add(name, ILAW_KIND_VALUE_TABLE);
    made.axes = axes;
    made.values = values;
    return *this;
  }
  parameters& per_node(const std::string& name) {
    add(name, ILAW_KIND_VALUE_PER_NODE);
    return *this;
  }

  // Sets the arguments of a setup; they are valid until these parameters are changed, assigned to or
  // destroyed. Moving these parameters elsewhere keeps them valid as long as the new ones live.
  void give(ilaw_setup& setup) {
    pointers_.clear();
    for (entry& one : entries_) pointers_.push_back(one.refer());
    setup.arguments = pointers_.data();
    setup.argument_count = static_cast<std::uint32_t>(pointers_.size());
  }

 private:
  struct entry {
    std::string name, text;
    ilaw_kind kind = ILAW_KIND_VALUE_NUMBER;
    double number = 0.0;
    std::vector<double> values;
    std::vector<axis> axes;
    // These structs point into the members above.
    ilaw_argument argument{};
    std::vector<ilaw_axis> axis_structs;
    std::vector<const ilaw_axis*> axis_pointers;

    const ilaw_argument* refer() {
      axis_structs.clear();
      axis_pointers.clear();
      for (const axis& along : axes)
        axis_structs.push_back(
            {sizeof(ilaw_axis), 0, along.name.c_str(), along.points.data(), along.points.size()});
      for (const ilaw_axis& along : axis_structs) axis_pointers.push_back(&along);
      const bool is_table = kind == ILAW_KIND_VALUE_TABLE;
      argument = {};
      argument.struct_size = sizeof argument;
      argument.kind = kind;
      argument.name = name.c_str();
      argument.number = number;
      argument.text = kind == ILAW_KIND_VALUE_TEXT ? text.c_str() : nullptr;
      argument.values = is_table ? values.data() : nullptr;
      argument.axes = is_table ? axis_pointers.data() : nullptr;
      argument.axis_count = static_cast<std::uint32_t>(axes.size());
      return &argument;
    }
  };

  static std::string listed(const char* const* names, std::uint32_t count) {
    std::string list;
    for (std::uint32_t i = 0; i < count; ++i) list += (i ? ", " : "") + std::string(names[i]);
    return list;
  }
  [[noreturn]] static void refuse(const ilaw_law& law, const std::string& name, const std::string& found,
                                  const std::string& allowed) {
    throw error(ILAW_INVALID_PARAMETER, std::string("law '") + law.id + "': parameter '" + name +
                                            "': found '" + found + "', expected " + allowed);
  }
  static const ilaw_parameter& described(const ilaw_law& law, const std::string& name) {
    std::vector<const char*> names;
    for (std::uint32_t i = 0; i < law.parameter_count; ++i) {
      if (name == law.parameters[i]->name) return *law.parameters[i];
      names.push_back(law.parameters[i]->name);
    }
    throw error(ILAW_INVALID_PARAMETER, std::string("law '") + law.id + "': unknown parameter '" + name +
                                            "', expected one of " +
                                            listed(names.data(), law.parameter_count));
  }

  entry& add(const std::string& name, ilaw_kind kind) {
    entry& made = entries_.emplace_back();
    made.name = name;
    made.kind = kind;
    return made;
  }

  std::vector<entry> entries_;
  std::vector<const ilaw_argument*> pointers_;
};

// An open library. Movable; closed at the end of its life (interfaces made from it keep it loaded).
class library {
 public:
  // By name along the search path, or by explicit path; see loader.h.
  explicit library(const std::string& name_or_path) : library(ilaw_library_open, name_or_path) {}
  // By name alone, for names from an input file.
  static library named(const std::string& name) { return {ilaw_library_open_named, name}; }

  std::string path() const { return ilaw_library_path(handle_.get()); }
  const ilaw_plugin& plugin() const { return *ilaw_library_plugin(handle_.get()); }
  // Null when the library has no law of that id.
  const ilaw_law* law(const std::string& id) const { return ilaw_library_law(handle_.get(), id.c_str()); }
  ilaw_library* get() const { return handle_.get(); }
  // The description as JSON, with the path as "file".
  std::string describe() const {
    std::string text(ilaw_library_describe(handle_.get(), nullptr, 0), '\0');
    if (text.empty()) throw std::bad_alloc();
    ilaw_library_describe(handle_.get(), text.data(), text.size());
    text.pop_back();  // the zero at its end
    return text;
  }

 private:
  struct closer {
    void operator()(ilaw_library* library) const { ilaw_library_close(library); }
  };
  library(ilaw_result(ILAW_CALL* open)(const char*, ilaw_library**, char*, std::size_t),
          const std::string& text) {
    char message[1024];
    ilaw_library* opened = nullptr;
    const ilaw_result code = open(text.c_str(), &opened, message, sizeof message);
    if (code != ILAW_OK) throw error(code, message);
    handle_.reset(opened);
  }
  std::unique_ptr<ilaw_library, closer> handle_;
};

// An instance of a law. Movable; usable from any number of threads.
class interface {
 public:
  // id empty: the library's only law.
  interface(const library& from, const std::string& id, const ilaw_setup& setup) {
    char message[1024];
    ilaw_interface* made = nullptr;
    const ilaw_result code = ilaw_interface_create(from.get(), id.empty() ? nullptr : id.c_str(), &setup,
                                                   &made, message, sizeof message);
    if (code != ILAW_OK) throw error(code, message);
    handle_.reset(made);
  }

  const ilaw_law& law() const { return *ilaw_interface_law(handle_.get()); }
  const ilaw_instance* instance() const { return ilaw_interface_instance(handle_.get()); }
  const ilaw_interface* get() const { return handle_.get(); }

  ilaw_instance_info info() const {
    ilaw_instance_info info{};
    info.struct_size = sizeof info;
    const ilaw_result code = ilaw_interface_info(handle_.get(), &info);
    if (code != ILAW_OK) throw error(code, "info refuses its own instance");
    return info;
  }

  // As ilaw_law.initialise and ilaw_law.evaluate, codes and all: bad nodes are no exception.
  ilaw_result initialise(const ilaw_batch& batch, ilaw_report* report = nullptr) const {
    return ilaw_interface_initialise(handle_.get(), &batch, report);
  }
  ilaw_result evaluate(const ilaw_batch& batch, ilaw_report* report = nullptr) const {
    return ilaw_interface_evaluate(handle_.get(), &batch, report);
  }

 private:
  struct destroyer {
    void operator()(ilaw_interface* interface) const { ilaw_interface_destroy(interface); }
  };
  std::unique_ptr<ilaw_interface, destroyer> handle_;
};

// The same JSON from the file beside a library, which is not opened; empty where there is no such file.
inline std::string read_description(const std::string& name_or_path) {
  std::string text;
  for (std::size_t length = 0;; text.resize(length)) {
    char message[1024];
    const ilaw_result code = ilaw_library_read_description(name_or_path.c_str(), text.data(), text.size(),
                                                           &length, message, sizeof message);
    if (code != ILAW_OK) throw error(code, message);
    if (length > text.size()) continue;
    text.resize(length == 0 ? 0 : length - 1);  // without the zero at its end
    return text;
  }
}

// All *.so files of the search path; none is opened.
inline std::vector<std::string> search() {
  std::vector<std::string> files;
  const std::int32_t code = ilaw_search(
      [](const char* path, void* context) -> std::int32_t {
        try {
          static_cast<std::vector<std::string>*>(context)->emplace_back(path);
        } catch (const std::bad_alloc&) {  // not through C
          return ILAW_OUT_OF_MEMORY;
        }
        return 0;
      },
      &files);
  if (code != 0) throw std::bad_alloc();
  return files;
}

// The folders searched, separated by ':'.
inline std::string search_path() {
  std::string text(ilaw_search_path(nullptr, 0), '\0');
  ilaw_search_path(text.data(), text.size());
  if (!text.empty()) text.pop_back();  // the zero at its end
  return text;
}

}  // namespace ilaw
