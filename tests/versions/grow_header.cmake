# Writes to OUT what a later minor version could make of the header HEADER: one member more at the end of every struct
# that may grow (ilaw_input and ilaw_output never do).
# cmake -DHEADER=ilaw.h -DOUT=folder -P grow_header.cmake
file(READ ${HEADER} text)
# A list in CMake ends at ';': hidden while the text is worked on.
string(REPLACE ";" "<semicolon>" text "${text}")
string(REGEX REPLACE "\n} (ilaw_[a-z_]+)<semicolon>" "\n  double grown<semicolon> /* of a later version */\n} \\1<semicolon>" text "${text}")
foreach(fixed input output)
  string(REPLACE "  double grown<semicolon> /* of a later version */\n} ilaw_${fixed}<semicolon>" "} ilaw_${fixed}<semicolon>"
                 text "${text}")
endforeach()
string(REGEX MATCHALL "double grown<" grown "${text}")
list(LENGTH grown count)
if(NOT count EQUAL 11)
  message(FATAL_ERROR "${HEADER}: ${count} structs grew, expected 11")
endif()
string(REPLACE "ILAW_ABI_MINOR = 0" "ILAW_ABI_MINOR = 1" text "${text}")
string(REPLACE "<semicolon>" ";" text "${text}")
file(WRITE ${OUT}/ilaw/ilaw.h "${text}")
