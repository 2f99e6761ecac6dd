// registry.hpp - the libraries that are open. Whoever opens a file again gets the same object, unless the
// file changed meanwhile: what a file says and what the process runs would be two things.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "checker.hpp"
#include "description.hpp"
#include "file.hpp"

#include <ilaw/ilaw.h>

#include <string>

struct ilaw_library {
  std::string path;
  ilaw::loading::file_status file;  // as it was loaded
  void* handle = nullptr;
  const void* entry = nullptr;   // address of its entry function
  const char* object = nullptr;  // name of the loaded object there
  ilaw::loading::storage kept = {};
  const ilaw_plugin* plugin = nullptr;
  ilaw::loading::instance_descriptions instances = {};
  long users = 0;  // openings and interfaces; none: closed, but the process cannot unload it
};

namespace ilaw::loading {

// Throws refusal: which file, what was found, what was expected.
ilaw_library* open_library(const std::string& path);
void use(ilaw_library& library);
void release(ilaw_library& library);

}  // namespace ilaw::loading
