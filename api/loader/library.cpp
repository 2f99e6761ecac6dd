// The C interface of ilaw/loader.h.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.h>

#include "control_guard.hpp"
#include "description_file.hpp"
#include "description_text.hpp"
#include "elf_file.hpp"
#include "registry.hpp"
#include "search.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <string>

struct ilaw_interface {
  ilaw_library* library;
  const ilaw_law* law;
  ilaw_instance* instance = nullptr;
  ilaw::loading::instance_description* description = nullptr;
};

namespace {

using ilaw::loading::refusal;

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
  } catch (...) {
    say(message, size, "an exception of a library");
    return ILAW_BAD_LIBRARY;
  }
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

// A law's text may be shown on a terminal: characters that are not printable become '?'.
std::string line_of(const char* text) {
  std::string line(text);
  if (ilaw::loading::clean_text(line, false)) return line;
  for (char& c : line)
    if (c < 0x20 || c > 0x7E) c = '?';
  return line;
}

std::int32_t known_code(std::int32_t code) {
  return code >= ILAW_OUT_OF_MEMORY && code < ILAW_OK ? code : std::int32_t{ILAW_BAD_LIBRARY};
}

ilaw_instance* created(const ilaw_library& library, const ilaw_law& law, const ilaw_setup& setup) {
  char text[1024] = "";
  ilaw_instance* instance = nullptr;
  const std::int32_t code = law.create(law.id, &setup, &instance, text, sizeof text);
  text[sizeof text - 1] = '\0';
  if (code == ILAW_OK && instance) return instance;
  const std::string said = line_of(text);
  const std::string silent =
      library.path + ": law '" + law.id + "': create gave no instance, code " + std::to_string(code);
  throw refusal(known_code(code), said.empty() ? silent : said);
}

std::unique_ptr<ilaw_interface> create_interface(ilaw_library& library, const ilaw_law& law,
                                                 const ilaw_setup& setup) {
  // Ends the instance when anything is wrong from here on, and holds the library meanwhile.
  struct unmade {
    void operator()(ilaw_interface* half) const {
      if (half->instance) half->law->destroy(half->instance);
      delete half;
    }
  };
  std::unique_ptr<ilaw_interface, unmade> made(new ilaw_interface{&library, &law});
  const ilaw::loading::control_guard control;
  made->instance = created(library, law, setup);
  control.check(library.path, "create");
  ilaw_instance_info info{};
  info.struct_size = sizeof info;
  if (law.info(made->instance, &info) != ILAW_OK)
    throw refusal(ILAW_BAD_LIBRARY, library.path + ": law '" + law.id + "': info refuses its own instance");
  control.check(library.path, "info");
  info.struct_size = sizeof info;
  made->description = library.instances.checked({library.path, law, library.plugin->abi_minor}, setup, info);
  return std::unique_ptr<ilaw_interface>(made.release());
}

// A reason may be a pointer to nowhere, or steer a terminal: hosts print it.
std::int32_t with_readable_reason(std::int32_t code, ilaw_report* report) {
  if (code == ILAW_OK || !report || !report->reason) return code;
  if (!ilaw::loading::readable_text(report->reason) || !ilaw::loading::clean_text(report->reason, false))
    report->reason = "(the library gave a reason that is no readable text)";
  return code;
}

// A report whose struct_size cannot be true is given to no library.
bool usable(ilaw_report* report) { return !report || ilaw::sized::cleared(report); }

// The text of a description with the library's path, cut at size; returns its length with the zero.
std::size_t write_description(const std::string& text, const std::string& path, char* buffer,
                              std::size_t size) {
  const std::string with_path =
      text.substr(0, text.rfind('}')) + ", \"file\": " + ilaw::loading::quoted_text(path) + "}";
  say(buffer, size, with_path.c_str());
  return with_path.size() + 1;
}

std::int32_t open_with(std::string (*find)(const std::string&), const char* text, ilaw_library** library,
                       char* message, std::size_t message_size) {
  return guarded(message, message_size, [&]() -> std::int32_t {
    if (library) *library = nullptr;
    if (!text || !library || !*text)
      throw refusal(ILAW_INVALID_ARGUMENT, "the name of the library, or where to put it, is null or empty");
    *library = ilaw::loading::open_library(find(text));
    return ILAW_OK;
  });
}

}  // namespace

ilaw_result ILAW_CALL ilaw_library_open(const char* name_or_path, ilaw_library** library, char* message,
                                        size_t message_size) {
  return open_with(ilaw::loading::find_library, name_or_path, library, message, message_size);
}

ilaw_result ILAW_CALL ilaw_library_open_named(const char* name, ilaw_library** library, char* message,
                                              size_t message_size) {
  return open_with(ilaw::loading::find_named, name, library, message, message_size);
}

ilaw_result ILAW_CALL ilaw_library_read_description(const char* name_or_path, char* buffer, size_t size,
                                                    size_t* length, char* message, size_t message_size) {
  return guarded(message, message_size, [&]() -> std::int32_t {
    say(buffer, size, "");
    if (length) *length = 0;
    if (!name_or_path || !*name_or_path || !length)
      throw refusal(ILAW_INVALID_ARGUMENT,
                    "the name of the library, or where to put the length, is null or empty");
    const std::string path = ilaw::loading::find_library(name_or_path);
    ilaw::loading::check_shared_object(path, ilaw::loading::open_file(path));
    const auto found = ilaw::loading::read_description(path);
    if (!found) return ILAW_OK;
    ilaw::loading::check_members(found->parsed, ilaw::loading::description_path(path));
    *length = write_description(found->text, path, buffer, size);
    return ILAW_OK;
  });
}

void ILAW_CALL ilaw_library_close(ilaw_library* library) {
  if (library) ilaw::loading::release(*library);
}

const ilaw_plugin* ILAW_CALL ilaw_library_plugin(const ilaw_library* library) {
  return library ? library->plugin : nullptr;
}

size_t ILAW_CALL ilaw_library_describe(const ilaw_library* library, char* buffer, size_t size) {
  std::size_t needed = 0;
  guarded(buffer, size, [&]() -> std::int32_t {
    if (library)
      needed =
          write_description(ilaw::loading::description_text(*library->plugin), library->path, buffer, size);
    return ILAW_OK;
  });
  if (needed == 0) say(buffer, size, "");
  return needed;
}

const char* ILAW_CALL ilaw_library_path(const ilaw_library* library) {
  return library ? library->path.c_str() : nullptr;
}

const ilaw_law* ILAW_CALL ilaw_library_law(const ilaw_library* library, const char* id) {
  if (!library || !id) return nullptr;
  for (std::uint32_t i = 0; i < library->plugin->law_count; ++i)
    if (std::strcmp(library->plugin->laws[i]->id, id) == 0) return library->plugin->laws[i];
  return nullptr;
}

ilaw_result ILAW_CALL ilaw_interface_create(ilaw_library* library, const char* id, const ilaw_setup* setup,
                                            ilaw_interface** interface, char* message, size_t message_size) {
  return guarded(message, message_size, [&]() -> std::int32_t {
    if (!library || !setup || !interface)
      throw refusal(ILAW_INVALID_ARGUMENT, "library, setup or interface is null");
    *interface = nullptr;
    if (!ilaw::sized::is_complete(setup))
      throw refusal(ILAW_INVALID_ARGUMENT, "setup has struct_size " + std::to_string(setup->struct_size) +
                                               ", expected at least " +
                                               std::to_string(ilaw::sized::least<ilaw_setup>));
    auto made = create_interface(*library, chosen_law(*library, id), *setup);
    ilaw::loading::use(*library);
    *interface = made.release();
    return ILAW_OK;
  });
}

void ILAW_CALL ilaw_interface_destroy(ilaw_interface* interface) {
  if (!interface) return;
  ilaw_library* library = interface->library;
  interface->law->destroy(interface->instance);
  library->instances.give_back(interface->description);
  delete interface;
  ilaw::loading::release(*library);
}

const ilaw_law* ILAW_CALL ilaw_interface_law(const ilaw_interface* interface) {
  return interface ? interface->law : nullptr;
}

const ilaw_instance* ILAW_CALL ilaw_interface_instance(const ilaw_interface* interface) {
  return interface ? interface->instance : nullptr;
}

ilaw_result ILAW_CALL ilaw_interface_info(const ilaw_interface* interface, ilaw_instance_info* info) {
  if (!interface || !info || !ilaw::sized::cleared(info)) return ILAW_INVALID_ARGUMENT;
  const std::uint32_t room = info->struct_size;
  // Members that only the host and the library know come from the library itself.
  if (room > sizeof *info)
    if (const std::int32_t code = interface->law->info(interface->instance, info); code != ILAW_OK)
      return code;
  std::memcpy(info, &interface->description->info, std::min<std::size_t>(room, sizeof *info));
  info->struct_size = room;
  return ILAW_OK;
}

ilaw_result ILAW_CALL ilaw_interface_initialise(const ilaw_interface* interface, const ilaw_batch* batch,
                                                ilaw_report* report) {
  if (!interface || !usable(report)) return ILAW_INVALID_ARGUMENT;
  return with_readable_reason(interface->law->initialise(interface->instance, batch, report), report);
}

ilaw_result ILAW_CALL ilaw_interface_evaluate(const ilaw_interface* interface, const ilaw_batch* batch,
                                              ilaw_report* report) {
  if (!interface || !usable(report)) return ILAW_INVALID_ARGUMENT;
  return with_readable_reason(interface->law->evaluate(interface->instance, batch, report), report);
}

int32_t ILAW_CALL ilaw_search(ilaw_visit_function visit, void* context) {
  return guarded(nullptr, 0, [&]() -> std::int32_t {
    if (!visit) return ILAW_INVALID_ARGUMENT;
    for (const std::string& file : ilaw::loading::library_files())
      if (const std::int32_t stop = visit(file.c_str(), context); stop != 0) return stop;
    return 0;
  });
}

size_t ILAW_CALL ilaw_search_path(char* buffer, size_t size) {
  std::size_t needed = 0;
  say(buffer, size, "");
  guarded(nullptr, 0, [&]() -> std::int32_t {
    const std::string text = ilaw::loading::joined(ilaw::loading::folders_searched().folders);
    say(buffer, size, text.c_str());
    needed = text.size() + 1;
    return ILAW_OK;
  });
  return needed;
}
