# Writes to OUT a C source with the place and size of every member of every struct of the header HEADER, as the compiler
# of OUT finds them. Compiled with the frozen header and with today's, it says whether a member has moved.
# cmake -DHEADER=frozen/1.0/ilaw/ilaw.h -DOUT=pins.c -P pins.cmake
file(READ ${HEADER} text)
# A list in CMake ends at ';', and brackets join its entries: neither may stand in the text while it is worked on.
string(REPLACE ";" "<semicolon>" text "${text}")
string(REGEX REPLACE "/[*][^*]*[*]+([^/*][^*]*[*]+)*/" "" text "${text}")
string(REGEX MATCHALL "typedef struct ilaw_[a-z_]+ {[^}]*}" structs "${text}")
set(lines)
set(count 0)
foreach(struct IN LISTS structs)
  string(REGEX REPLACE "typedef struct (ilaw_[a-z_]+) .*" "\\1" name "${struct}")
  string(REGEX MATCHALL "[a-z_0-9]+<semicolon>" members "${struct}")
  foreach(member IN LISTS members)
    string(REPLACE "<semicolon>" "" member ${member})
    string(APPEND lines "    {\"${name}\", \"${member}\", offsetof(${name}, ${member}), sizeof(((${name}*)0)->${member})},\n")
    math(EXPR count "${count} + 1")
  endforeach()
  string(APPEND lines "    {\"${name}\", \"\", sizeof(${name}), 0},\n")
endforeach()
if(count LESS 140)
  message(FATAL_ERROR "${HEADER}: found ${count} members, expected at least 140")
endif()
file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT [[
/* Made by pins.cmake. ILAW_PINS is the name of the function. */
#include "pins.h"

#include <ilaw/ilaw.h>

const struct ilaw_pin* ILAW_PINS(void) {
  static const struct ilaw_pin pins[] = {
@lines@    {NULL, NULL, 0, 0}};
  return pins;
}
]])
