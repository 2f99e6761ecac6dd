/* loader.h - finds, opens and checks law libraries (libdl), for hosts in any language.
 *
 * Loading a library runs its code. Therefore a library is opened only from an explicit path or from the
 * search path, never from the current folder, and ilaw_library_path says which file it was.
 *
 * Search path for a library given by name ("contact" -> "contact.so"), first match wins:
 *   1. the folders of the environment variable ILAW_PATH, separated by ':' (empty and relative entries
 *      are skipped; the variable is not read in a set-uid program),
 *   2. the installed folder: lib/ilaw beside the bin/ of the running program, then ilaw beside the shared
 *      library that has the loader and ../lib/ilaw from there (none of these in a set-uid program), then that
 *      fixed when the loader was built, /usr/local/lib/ilaw and /usr/lib/ilaw.
 * A folder that every user may write to, or may replace by another, is not searched; the message of an
 * opening that fails says so. A library that every user may write to is refused.
 * A text with a '/' in it is an explicit path; anything else is a name: letters, digits, '_', '-', '+', '.',
 * the first not '.'. A host that has names from an input file opens them by ilaw_library_open_named.
 *
 * Threads: all functions are [any-thread] as ilaw.h says it: from any thread, at the same time as any other
 * call; but one object is not to be closed or destroyed while another call uses it.
 * Ownership: a library stays loaded until it was closed as often as opened, and every interface
 * created from it is destroyed. Objects may outlive main: nothing of the loader ends before them.
 * Errors: functions return an ILAW_* code of ilaw.h; message (message_size bytes, may be null when 0)
 * receives one line: which file, what was found, what was expected. No function throws or prints.
 * Versions: hosts and libraries of other minor versions work together. The results of ilaw_library_plugin,
 * ilaw_library_law, ilaw_interface_law and ilaw_interface_info are checked copies, with zeros where the
 * library had no member yet, of at least the size that the loader was built with.
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#ifndef ILAW_LOADER_H
#define ILAW_LOADER_H

#include <ilaw/ilaw.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(ILAW_BUILDING_SHARED_LOADER)
#pragma GCC visibility push(default)
#endif

/* An opened and checked library. */
typedef struct ilaw_library ilaw_library;
/* An instance of a law together with the library that it keeps loaded. */
typedef struct ilaw_interface ilaw_interface;

/* Opens a library by name or explicit path, checks its whole description, gives *library. Where a JSON file
 * describes the library (see ilaw_library_read_description), both must say the same.
 * Opening the same file again gives the same object. A file that changed since, or that another one took the
 * place of, is refused until the last handle and interface are closed.
 * Returns ILAW_OK, ILAW_INVALID_ARGUMENT, ILAW_NOT_FOUND, ILAW_BAD_LIBRARY, ILAW_OUT_OF_MEMORY. */
ilaw_result ILAW_CALL ilaw_library_open(const char* name_or_path, ilaw_library** library, char* message,
                                        size_t message_size);

/* As ilaw_library_open, along the search path alone: a text that is no name, "../evil" or "/tmp/evil.so", is
 * ILAW_NOT_FOUND. For names that come from an input file. */
ilaw_result ILAW_CALL ilaw_library_open_named(const char* name, ilaw_library** library, char* message,
                                              size_t message_size);

/* Gives the description of a library as JSON (docs/abi.md) without running any code of it: from the file
 * <library>.json beside <library>.so, as ilaw-describe wrote it when the library was built. Finds the library
 * as ilaw_library_open does, and adds its absolute path as "file". Writes the text to buffer (cut at size),
 * its length with the zero to *length: 0 where there is no such file. Returns as ilaw_library_open. */
ilaw_result ILAW_CALL ilaw_library_read_description(const char* name_or_path, char* buffer, size_t size,
                                                    size_t* length, char* message, size_t message_size);

/* Gives back one opening; null is allowed. */
void ILAW_CALL ilaw_library_close(ilaw_library* library);

/* The checked description; valid while the library is open or an interface of it lives. */
const ilaw_plugin* ILAW_CALL ilaw_library_plugin(const ilaw_library* library);

/* The same JSON, from an open library whether it has such a file or not; returns the length with the zero, 0
 * where memory runs out. */
size_t ILAW_CALL ilaw_library_describe(const ilaw_library* library, char* buffer, size_t size);

/* Absolute path of the file that was loaded. */
const char* ILAW_CALL ilaw_library_path(const ilaw_library* library);

/* The law of that id, null when the library has none. */
const ilaw_law* ILAW_CALL ilaw_library_law(const ilaw_library* library, const char* id);

/* Creates an instance of a law; id = null takes the library's only law.
 * Returns as ilaw_law.create, or ILAW_NOT_FOUND (the message lists the laws there are). */
ilaw_result ILAW_CALL ilaw_interface_create(ilaw_library* library, const char* id, const ilaw_setup* setup,
                                            ilaw_interface** interface, char* message, size_t message_size);

/* Ends an interface; null is allowed. */
void ILAW_CALL ilaw_interface_destroy(ilaw_interface* interface);

/* The law of an interface. */
const ilaw_law* ILAW_CALL ilaw_interface_law(const ilaw_interface* interface);

/* The instance, for hosts that call the law's functions themselves. */
const ilaw_instance* ILAW_CALL ilaw_interface_instance(const ilaw_interface* interface);

/* The law's info, initialise and evaluate (ilaw.h), for hosts that would rather not call through
 * function pointers (Fortran). All that follows struct_size in info and report is zero before the library
 * writes to it. */
ilaw_result ILAW_CALL ilaw_interface_info(const ilaw_interface* interface, ilaw_instance_info* info);
ilaw_result ILAW_CALL ilaw_interface_initialise(const ilaw_interface* interface, const ilaw_batch* batch,
                                                ilaw_report* report);
ilaw_result ILAW_CALL ilaw_interface_evaluate(const ilaw_interface* interface, const ilaw_batch* batch,
                                              ilaw_report* report);

/* Function that ilaw_search calls for each library. */
typedef int32_t(ILAW_CALL* ilaw_visit_function)(const char* path, void* context);

/* Calls visit(path, context) for every file *.so of the search path, in search order, files that an
 * earlier folder hides left out. Opens none of them. Stops early when visit returns non-zero, and
 * returns that value; ILAW_OUT_OF_MEMORY where memory runs out. */
int32_t ILAW_CALL ilaw_search(ilaw_visit_function visit, void* context);

/* The folders searched, separated by ':', written to buffer (cut at size); returns the length needed. */
size_t ILAW_CALL ilaw_search_path(char* buffer, size_t size);

#if defined(ILAW_BUILDING_SHARED_LOADER)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
} /* extern "C" */
#endif

#endif /* ILAW_LOADER_H */
