// SPDX-License-Identifier: BSD-3-Clause
#include "registry.hpp"

#include "control_guard.hpp"
#include "description_file.hpp"
#include "dynamic.hpp"
#include "elf_file.hpp"
#include "refusal.hpp"

#include <cstring>
#include <list>
#include <memory>
#include <mutex>

namespace ilaw::loading {
namespace {

// std::list keeps addresses. Never destroyed: interfaces that a host keeps at namespace scope end after
// whatever this file would.
struct registry {
  std::mutex guard;
  std::list<ilaw_library> open;
};
registry& libraries() {
  static registry& all = *new registry;
  return all;
}

struct closer {
  void operator()(void* handle) const { dlclose(handle); }
};
using dynamic_handle = std::unique_ptr<void, closer>;

// The loader of glibc knows a library by each path under which it was asked for, whatever file has that path
// now.
bool is_loaded(const std::string& path) {
  return dynamic_handle(dlopen(path.c_str(), RTLD_LAZY | RTLD_NOLOAD)) != nullptr;
}

// Name of the loaded object that an address lies in, null where it lies in none.
const char* object_at(const void* address) {
  Dl_info found;
  return dladdr(address, &found) != 0 ? found.dli_fname : nullptr;
}

bool is_kept(const ilaw_library& closed) {
  return closed.users == 0 && object_at(closed.entry) == closed.object;
}

// "ilaw_plugin_v2" tells a library of another major version from a file that is no law library at all.
std::string other_version(void* handle) {
  for (int major = 0; major < 10; ++major) {
    const std::string name = "ilaw_plugin_v" + std::to_string(major);
    if (major != ILAW_ABI_MAJOR && dlsym(handle, name.c_str()))
      return "a library for ABI major version " + std::to_string(major) + ", expected major version " +
             std::to_string(ILAW_ABI_MAJOR);
  }
  return std::string("not a law library: the symbol ") + ILAW_ENTRY_NAME + " is missing";
}

const void* entry_of(const std::string& path, void* handle) {
  const void* symbol = dlsym(handle, ILAW_ENTRY_NAME);
  if (!symbol) throw refusal(ILAW_BAD_LIBRARY, path + ": " + other_version(handle));
  return symbol;
}

const ilaw_plugin* described(const std::string& path, const void* entry, storage& kept) {
  ilaw_entry_function function = nullptr;
  std::memcpy(&function, &entry, sizeof function);  // ISO C++ has no cast from object to function pointer
  return checked_plugin(path, function(), kept);
}

[[noreturn]] void refuse_change(const std::string& path, const file_status& then, const file_status& now,
                                const char* until) {
  const std::string size = std::to_string(now.size) + " bytes";
  const std::string found = then.is_same_file(now) ? "its file was written to and has " + size
                                                   : "another file of " + size + " took its place";
  throw refusal(ILAW_BAD_LIBRARY, path + ": changed since it was opened: " + found +
                                      ", expected the file of " + std::to_string(then.size) + " bytes " +
                                      until);
}

// By the path, since the loader of glibc knows libraries by it: under that of a descriptor, /proc/self/fd/3,
// $ORIGIN leads nowhere, and the next file with that number would be taken for this one.
void load(ilaw_library& made, const open_file& file) {
  const std::string& path = made.path;
  check_shared_object(path, file);
  const auto written = read_description(path);  // refused before any code of the library runs
  const control_guard control;
  const bool was_loaded = is_loaded(path);
  dynamic_handle handle(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL));
  if (!handle) throw refusal(ILAW_BAD_LIBRARY, path + ": cannot be loaded: " + dlerror());
  // The file that was checked still has the path, and nobody wrote to it.
  if (const file_status now = status_of(path);
      !made.file.is_unchanged(now) || !made.file.is_unchanged(file.status()))
    refuse_change(path, made.file, now, "while it is loaded");
  made.entry = entry_of(path, handle.get());
  made.object = object_at(made.entry);
  const std::string mapped = was_loaded ? mapped_file(made.entry) : "";
  if (!mapped.empty() && mapped != path && !status_of(mapped).is_same_file(made.file))
    throw refusal(ILAW_BAD_LIBRARY, path + ": changed since another part of this process loaded it: found " +
                                        mapped + ", expected the file that has the path now");
  made.plugin = described(path, made.entry, made.kept);
  control.check(path, "loading it");
  if (written) check_same(written->parsed, *made.plugin, path);
  made.handle = handle.release();
}

// The library of a file among those that are loaded, whatever its path.
ilaw_library* find(std::list<ilaw_library>& open, const std::string& path, const file_status& now) {
  for (ilaw_library& library : open)
    if (library.file.is_unchanged(now)) {
      library.file = now;
      return &library;
    }
  for (const ilaw_library& library : open)
    if (library.path == path || library.file.is_same_file(now))
      refuse_change(path, library.file, now,
                    library.users > 0 ? "until its last handle and interface are closed"
                                      : "as long as this process keeps it loaded");
  return nullptr;
}

}  // namespace

ilaw_library* open_library(const std::string& path) {
  registry& all = libraries();
  const std::scoped_lock lock(all.guard);
  const open_file file(path);
  const file_status now = file.status();
  if (!now.exists) throw refusal(ILAW_NOT_FOUND, path + ": no such file");
  std::erase_if(all.open, [](const ilaw_library& one) { return one.users == 0 && !is_kept(one); });
  ilaw_library* found = find(all.open, path, now);
  if (!found || found->users == 0) {
    std::list<ilaw_library> made(1);
    made.back().path = path;
    made.back().file = now;
    load(made.back(), file);
    all.open.remove_if([found](const ilaw_library& closed) { return &closed == found; });
    found = &made.back();
    all.open.splice(all.open.end(), made);
  }
  ++found->users;
  return found;
}

void use(ilaw_library& library) {
  const std::scoped_lock lock(libraries().guard);
  ++library.users;
}

// The process keeps a library with unique symbols of C++, or one that others opened, too.
void release(ilaw_library& library) {
  registry& all = libraries();
  const std::scoped_lock lock(all.guard);
  if (--library.users > 0) return;
  dlclose(library.handle);
  if (!is_kept(library))
    all.open.remove_if([&library](const ilaw_library& open) { return &open == &library; });
}

}  // namespace ilaw::loading
