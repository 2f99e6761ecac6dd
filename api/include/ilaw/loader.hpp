// loader.hpp - loader.h for C++20: owners instead of handles, exceptions instead of codes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/loader.h>

#include <cstdint>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace ilaw {

// Thrown with the loader's or the law's one-line message; code is one of ILAW_* of ilaw.h.
class error : public std::runtime_error {
 public:
  error(std::int32_t code, const std::string& text) : std::runtime_error(text), code_(code) {}
  std::int32_t code() const { return code_; }

 private:
  std::int32_t code_;
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

 private:
  struct closer {
    void operator()(ilaw_library* library) const { ilaw_library_close(library); }
  };
  library(std::int32_t (*open)(const char*, ilaw_library**, char*, std::size_t), const std::string& text) {
    char message[1024];
    ilaw_library* opened = nullptr;
    const std::int32_t code = open(text.c_str(), &opened, message, sizeof message);
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
    const std::int32_t code = ilaw_interface_create(from.get(), id.empty() ? nullptr : id.c_str(), &setup,
                                                    &made, message, sizeof message);
    if (code != ILAW_OK) throw error(code, message);
    handle_.reset(made);
  }

  const ilaw_law& law() const { return *ilaw_interface_law(handle_.get()); }
  const ilaw_instance* instance() const { return ilaw_interface_instance(handle_.get()); }

  ilaw_instance_info info() const {
    ilaw_instance_info info{};
    info.struct_size = sizeof info;
    const std::int32_t code = ilaw_interface_info(handle_.get(), &info);
    if (code != ILAW_OK) throw error(code, "info refuses its own instance");
    return info;
  }

  // As ilaw_law.initialise and ilaw_law.evaluate, codes and all: bad nodes are no exception.
  std::int32_t initialise(const ilaw_batch& batch, ilaw_report* report = nullptr) const {
    return ilaw_interface_initialise(handle_.get(), &batch, report);
  }
  std::int32_t evaluate(const ilaw_batch& batch, ilaw_report* report = nullptr) const {
    return ilaw_interface_evaluate(handle_.get(), &batch, report);
  }

 private:
  struct destroyer {
    void operator()(ilaw_interface* interface) const { ilaw_interface_destroy(interface); }
  };
  std::unique_ptr<ilaw_interface, destroyer> handle_;
};

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
