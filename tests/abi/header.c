/* The header alone, under -pedantic-errors. */
#include <ilaw/ilaw.h>
#include <ilaw/loader.h>

extern int abi_header_compiles;
int abi_header_compiles = ILAW_ABI_MAJOR;
