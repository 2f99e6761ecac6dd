/* Place and size of the members of all structs of a header; the size of a struct, where member is empty. The
 * list ends with a name that is null. */
#ifndef ILAW_TESTS_PINS_H
#define ILAW_TESTS_PINS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif
struct ilaw_pin {
  const char *name, *member;
  size_t offset, size;
};
/* Members of the frozen header of a version, where they were; and where they are today. */
const struct ilaw_pin* ilaw_pins_1_0_frozen(void);
const struct ilaw_pin* ilaw_pins_1_0_today(void);
#ifdef __cplusplus
}
#endif

#endif
