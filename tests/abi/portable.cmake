# Fails unless PLUGIN exports only the entry, needs only libc and libm, uses no symbol newer than GLIBC_2.28, and has
# no fused multiply-add, whose rounding would differ between processors.
execute_process(COMMAND ${READELF} -W --dyn-syms ${PLUGIN} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]*(GLOBAL|WEAK)[ ]+DEFAULT[ ]+[0-9]+ [^\n]*" exported "${symbols}")
if(NOT exported MATCHES "^[^;]* ilaw_plugin_v1$")
  message(FATAL_ERROR "${PLUGIN}: exports ${exported}, expected ilaw_plugin_v1 alone")
endif()

execute_process(COMMAND ${READELF} -W -d ${PLUGIN} OUTPUT_VARIABLE dynamic COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "\\(NEEDED\\)[^\n]*\\[[^]\n]*\\]" needed "${dynamic}")
foreach(library ${needed})
  if(NOT library MATCHES "\\[(libc\\.so\\.6|libm\\.so\\.6)\\]")
    message(FATAL_ERROR "${PLUGIN}: ${library}, expected libc.so.6 and libm.so.6 at most")
  endif()
endforeach()

string(REGEX MATCHALL "GLIBC_[0-9.]+" versions "${symbols}")
foreach(version ${versions})
  string(REPLACE "GLIBC_" "" number ${version})
  if(number VERSION_GREATER 2.28)
    message(FATAL_ERROR "${PLUGIN}: needs ${version}, expected at most GLIBC_2.28")
  endif()
endforeach()

execute_process(COMMAND ${OBJDUMP} -d --no-show-raw-insn ${PLUGIN} OUTPUT_VARIABLE code COMMAND_ERROR_IS_FATAL ANY)
if(code MATCHES "(vfn?m(add|sub)[a-z0-9]*)")
  message(FATAL_ERROR "${PLUGIN}: contains ${CMAKE_MATCH_1}, expected no fused multiply-add")
endif()
