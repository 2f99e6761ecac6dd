// The C interface of ilaw/loader.h.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.h>

#include "description.hpp"
#include "elf_file.hpp"
#include "refusal.hpp"
#include "search.hpp"

#include <dlfcn.h>
#include <sys/stat.h>

#include <cstdio>
#include <cstring>
#include <list>
#include <mutex>
#include <new>
#include <string>

struct ilaw_library {
  std::string path;
  dev_t device;
  ino_t inode;
  void* handle;
  const ilaw_plugin* plugin;
  long users = 0;  // openings and interfaces
};

struct ilaw_interface {
  ilaw_library* library;
  const ilaw_law* law;
  ilaw_instance* instance;
};

namespace {

using ilaw::loading::refusal;

// All libraries that are open; std::list keeps their addresses.
std::mutex open_libraries_guard;
std::list<ilaw_library> open_libraries;

void say(char* message, std::size_t size, const char* text) {
  if (message && size > 0) std::snprintf(message, size, "%s", text);
}

// Runs work and turns what it throws into a code and a message.
template <class Work>
std::int32_t guarded(char* message, std::size_t size, Work work) {
  say(message, size, "");
  try {
    return work();
  } catch (const refusal& error) {
    say(message, size, error.what());
    return error.code();
  } catch (const std::bad_alloc&) {
    say(message, size, "out of memory");
    return ILAW_OUT_OF_MEMORY;
  } catch (const std::exception& error) {
    say(message, size, error.what());
    return ILAW_BAD_LIBRARY;
  }
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

const ilaw_plugin* described(const std::string& path, void* handle) {
  void* symbol = dlsym(handle, ILAW_ENTRY_NAME);
  if (!symbol) throw refusal(ILAW_BAD_LIBRARY, path + ": " + other_version(handle));
  ilaw_entry_function entry = nullptr;
  std::memcpy(&entry, &symbol, sizeof entry);  // ISO C++ has no cast from object to function pointer
  const ilaw_plugin* plugin = entry();
  ilaw::loading::check_plugin(path, plugin);
  return plugin;
}

ilaw_library* open_checked(const std::string& path, const struct stat& identity) {
  ilaw::loading::check_shared_object(path);
  void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) throw refusal(ILAW_BAD_LIBRARY, path + ": cannot be loaded: " + dlerror());
  try {
    const ilaw_plugin* plugin = described(path, handle);
    return &open_libraries.emplace_back(ilaw_library{path, identity.st_dev, identity.st_ino, handle, plugin});
  } catch (...) {
    dlclose(handle);
    throw;
  }
}

ilaw_library* open_or_share(const std::string& path) {
  struct stat identity {};
  if (stat(path.c_str(), &identity) != 0) throw refusal(ILAW_NOT_FOUND, path + ": no such file");
  const std::scoped_lock lock(open_libraries_guard);
  ilaw_library* found = nullptr;
  for (ilaw_library& library : open_libraries)
    if (library.device == identity.st_dev && library.inode == identity.st_ino) found = &library;
  if (!found) found = open_checked(path, identity);
  ++found->users;
  return found;
}

void release(ilaw_library* library) {
  const std::scoped_lock lock(open_libraries_guard);
  if (--library->users > 0) return;
  dlclose(library->handle);
  open_libraries.remove_if([library](const ilaw_library& open) { return &open == library; });
}

const ilaw_law& chosen_law(const ilaw_library& library, const char* id) {
  if (!id && library.plugin->law_count == 1) return *library.plugin->laws[0];
  if (id)
    if (const ilaw_law* law = ilaw_library_law(&library, id)) return *law;
  std::string known;
  for (std::uint32_t i = 0; i < library.plugin->law_count; ++i)
    known += (i ? ", " : "") + std::string(library.plugin->laws[i]->id);
  throw refusal(ILAW_NOT_FOUND,
                library.path + ": no law '" + (id ? id : "") + "', expected one of: " + known);
}

ilaw_interface* create_interface(ilaw_library& library, const ilaw_law& law, const ilaw_setup& setup) {
  char text[1024] = "";
  ilaw_instance* instance = nullptr;
  const std::int32_t code = law.create(&setup, &instance, text, sizeof text);
  if (code != ILAW_OK) throw refusal(code, text);
  try {
    ilaw_instance_info info{};
    info.struct_size = sizeof info;
    if (!instance || law.info(instance, &info) != ILAW_OK)
      throw refusal(ILAW_BAD_LIBRARY,
                    library.path + ": law '" + law.id + "': create gave no instance with info");
    ilaw::loading::check_instance_info(library.path, law, info, setup.dimension);
    return new ilaw_interface{&library, &law, instance};
  } catch (...) {
    law.destroy(instance);
    throw;
  }
}

}  // namespace

int32_t ilaw_library_open(const char* name_or_path, ilaw_library** library, char* message,
                          size_t message_size) {
  return guarded(message, message_size, [&]() -> std::int32_t {
    if (!name_or_path || !library || !*name_or_path)
      throw refusal(ILAW_INVALID_ARGUMENT, "name_or_path or library is null or empty");
    *library = nullptr;
    *library = open_or_share(ilaw::loading::find_library(name_or_path));
    return ILAW_OK;
  });
}

void ilaw_library_close(ilaw_library* library) {
  if (library) release(library);
}

const ilaw_plugin* ilaw_library_plugin(const ilaw_library* library) { return library->plugin; }

const char* ilaw_library_path(const ilaw_library* library) { return library->path.c_str(); }

const ilaw_law* ilaw_library_law(const ilaw_library* library, const char* id) {
  for (std::uint32_t i = 0; i < library->plugin->law_count; ++i)
    if (std::strcmp(library->plugin->laws[i]->id, id) == 0) return library->plugin->laws[i];
  return nullptr;
}

int32_t ilaw_interface_create(ilaw_library* library, const char* id, const ilaw_setup* setup,
                              ilaw_interface** interface, char* message, size_t message_size) {
  return guarded(message, message_size, [&]() -> std::int32_t {
    if (!library || !setup || !interface)
      throw refusal(ILAW_INVALID_ARGUMENT, "library, setup or interface is null");
    *interface = nullptr;
    *interface = create_interface(*library, chosen_law(*library, id), *setup);
    const std::scoped_lock lock(open_libraries_guard);
    ++library->users;
    return ILAW_OK;
  });
}

void ilaw_interface_destroy(ilaw_interface* interface) {
  if (!interface) return;
  interface->law->destroy(interface->instance);
  release(interface->library);
  delete interface;
}

const ilaw_law* ilaw_interface_law(const ilaw_interface* interface) { return interface->law; }

const ilaw_instance* ilaw_interface_instance(const ilaw_interface* interface) { return interface->instance; }

int32_t ilaw_interface_info(const ilaw_interface* interface, ilaw_instance_info* info) {
  return interface->law->info(interface->instance, info);
}

int32_t ilaw_interface_initialise(const ilaw_interface* interface, const ilaw_batch* batch,
                                  ilaw_report* report) {
  return interface->law->initialise(interface->instance, batch, report);
}

int32_t ilaw_interface_evaluate(const ilaw_interface* interface, const ilaw_batch* batch,
                                ilaw_report* report) {
  return interface->law->evaluate(interface->instance, batch, report);
}

int32_t ilaw_search(int32_t (*visit)(const char* path, void* context), void* context) {
  try {
    for (const std::string& file : ilaw::loading::library_files())
      if (const std::int32_t stop = visit(file.c_str(), context); stop != 0) return stop;
  } catch (const std::bad_alloc&) {
    return ILAW_OUT_OF_MEMORY;
  }
  return 0;
}

size_t ilaw_search_path(char* buffer, size_t size) {
  std::string text;
  for (const std::string& folder : ilaw::loading::search_folders())
    text += (text.empty() ? "" : ":") + folder;
  say(buffer, size, text.c_str());
  return text.size() + 1;
}
