// driver.hpp - what launchers need of CUDA and of OpenCL.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/device.h>

#include <cstddef>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ilaw::device {

class Error : public std::runtime_error {
 public:
  Error(ilaw_result code, const std::string& what) : std::runtime_error(what), code_(code) {}
  ilaw_result code() const { return code_; }

 private:
  ilaw_result code_;
};

// A kernel with one argument, a struct by value.
class Kernel {
 public:
  virtual ~Kernel() = default;
  // pointers: of the device, that the argument holds.
  virtual void launch(void* queue, std::int64_t threads, void* argument, std::size_t size,
                      const std::vector<void*>& pointers) = 0;
};

// Images stay loaded until the device is closed, since a driver may take seconds to compile one. They are
// known by their content: a library may be gone, and another stand in its place.
template <class Module>
class LoadedImages {
 public:
  template <class Make>
  std::shared_ptr<Module> get(const ilaw_device_image& image, Make make) {
    const std::string_view content(image.begin, static_cast<std::size_t>(image.end - image.begin));
    std::shared_ptr<Module>& module = modules_[{content.size(), std::hash<std::string_view>()(content)}];
    if (!module) module = make();
    return module;
  }
  void clear() { modules_.clear(); }

 private:
  std::map<std::pair<std::size_t, std::size_t>, std::shared_ptr<Module>> modules_;
};

// Kernels live no longer than their device.
class Driver {
 public:
  virtual ~Driver() = default;
  virtual std::string name() const = 0;
  virtual void* own_queue() const = 0;
  virtual ilaw_kind image_kind() const = 0;  // that it takes from a library
  virtual void* allocate(std::size_t size) = 0;
  virtual void free(void* memory) noexcept = 0;
  virtual void write(void* queue, void* to, const void* from, std::size_t size) = 0;
  virtual void read(void* queue, void* to, const void* from, std::size_t size) = 0;
  virtual std::unique_ptr<Kernel> load(const ilaw_device_image& image, const std::string& kernel) = 0;
};

std::unique_ptr<Driver> open_cuda(int number, void* context);
std::unique_ptr<Driver> open_opencl(int number, void* context, void* device_id);

// A shared library that is opened when it is needed.
class SharedLibrary {
 public:
  explicit SharedLibrary(const char* file);
  ~SharedLibrary();
  SharedLibrary(const SharedLibrary&) = delete;
  SharedLibrary& operator=(const SharedLibrary&) = delete;

  template <class Function>
  void find(Function*& function, const char* name) const {
    function = reinterpret_cast<Function*>(symbol(name));
  }

 private:
  void* symbol(const char* name) const;
  std::string file_;
  void* handle_;
};

}  // namespace ilaw::device
