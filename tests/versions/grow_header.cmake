# Writes to OUT what a later minor version could make of the header HEADER and, given FORTRAN, of the Fortran module: one
# member more at the end of every struct that may grow (ilaw_input and ilaw_output never do).
# cmake -DHEADER=ilaw.h -DOUT=folder [-DFORTRAN=ilaw_abi.f90] -P grow_header.cmake
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
if(NOT count EQUAL 9)
  message(FATAL_ERROR "${HEADER}: ${count} structs grew, expected 9")
endif()
string(REPLACE "#define ILAW_ABI_MINOR 0" "#define ILAW_ABI_MINOR 1" text "${text}")
string(REPLACE "<semicolon>" ";" text "${text}")
file(WRITE ${OUT}/ilaw/ilaw.h "${text}")

if(FORTRAN)
  file(READ ${FORTRAN} text)
  string(REPLACE ";" "<semicolon>" text "${text}")
  string(REPLACE "  end type" "    real(c_double) :: grown = 0\n  end type" text "${text}")
  foreach(size 40 48 56 64 96 136 400)
    math(EXPR longer "${size} + 8")
    string(REGEX REPLACE "struct_size = ${size}([^0-9])" "struct_size = <${longer}>\\1" text "${text}")
  endforeach()
  string(REGEX REPLACE "<([0-9]+)>" "\\1" text "${text}")
  foreach(fixed input output)
    string(REGEX REPLACE "(type, bind\\(c\\) :: ilaw_${fixed}\n[^\n]*\n[^\n]*\n)    real\\(c_double\\) :: grown = 0\n" "\\1"
                         text "${text}")
  endforeach()
  string(REPLACE "ILAW_ABI_MINOR = 0" "ILAW_ABI_MINOR = 1" text "${text}")
  string(REPLACE "<semicolon>" ";" text "${text}")
  file(WRITE ${OUT}/ilaw_abi.f90 "${text}")
endif()
