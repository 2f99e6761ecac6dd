// Each header of the C interface, under -pedantic-errors.
#include <ilaw/coupled.h>
#include <ilaw/ilaw.h>
#include <ilaw/loader.h>
#include <ilaw/search.h>

extern int abi_header_compiles;
int abi_header_compiles = ILAW_ABI_MAJOR;
