// Libraries of drivers, opened when a device is.
// SPDX-License-Identifier: BSD-3-Clause
#include "driver.hpp"

#include <dlfcn.h>

namespace ilaw::device {

SharedLibrary::SharedLibrary(const char* file) : file_(file), handle_(dlopen(file, RTLD_NOW | RTLD_LOCAL)) {
  if (!handle_) throw Error(ILAW_NOT_FOUND, "no driver: " + std::string(dlerror()));
}
SharedLibrary::~SharedLibrary() { dlclose(handle_); }

void* SharedLibrary::symbol(const char* name) const {
  void* const found = dlsym(handle_, name);
  if (!found) throw Error(ILAW_UNSUPPORTED, file_ + " is too old: it has no " + name);
  return found;
}

}  // namespace ilaw::device
