/* A plug-in of a program that knows nothing of laws, with a loader of its own. */
#include <ilaw/loader.h>

size_t plugin_search_path(char* buffer, size_t size);
size_t plugin_search_path(char* buffer, size_t size) { return ilaw_search_path(buffer, size); }
