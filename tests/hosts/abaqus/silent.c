/* coulomb as a law that gives no status, which the ABI leaves to it. SPDX-License-Identifier: BSD-3-Clause */
#define ILAW_BUILDING_PLUGIN
#include <ilaw/ilaw.h>

#include <dlfcn.h>
#include <string.h>

static const ilaw_law* coulomb;

static ilaw_result ILAW_CALL evaluate(const ilaw_instance* instance, const ilaw_batch* batch,
                                      ilaw_report* report) {
  ilaw_batch silent = *batch;
  silent.status = NULL;
  return coulomb->evaluate(instance, &silent, report);
}

ILAW_EXPORT const ilaw_plugin* ILAW_CALL ILAW_ENTRY(void) {
  static ilaw_law law;
  static const ilaw_law* const laws[] = {&law};
  static ilaw_plugin plugin;
  ilaw_entry_function entry = NULL;
  void* const library = dlopen(ILAW_COULOMB, RTLD_NOW | RTLD_LOCAL);
  void* const symbol = library ? dlsym(library, ILAW_ENTRY_NAME) : NULL;
  if (!symbol) return NULL;
  memcpy(&entry, &symbol, sizeof entry);
  plugin = *entry();
  coulomb = plugin.laws[0];
  law = *coulomb;
  law.outputs &= ~(uint32_t)ILAW_OUTPUT_STATUS;
  law.evaluate = evaluate;
  plugin.laws = laws;
  return &plugin;
}
