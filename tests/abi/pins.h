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
const struct ilaw_pin* ilaw_pins_frozen(void); /* members of the frozen header, where they were */
const struct ilaw_pin* ilaw_pins_today(void);  /* the same members, where they are */
#ifdef __cplusplus
}
#endif

#endif
