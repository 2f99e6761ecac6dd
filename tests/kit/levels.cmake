# Fails unless the instruction-set levels of a library keep to themselves: OBJECT, of a level other than the baseline,
# gives one global symbol, that of its parts; BASELINE, the objects of the baseline, have no VEX or EVEX instruction.
execute_process(COMMAND ${NM} --defined-only --extern-only ${OBJECT} OUTPUT_VARIABLE symbols
                COMMAND_ERROR_IS_FATAL ANY)
string(REGEX REPLACE "[0-9a-f]+ [A-Za-z] " "" symbols "${symbols}")
if(NOT symbols STREQUAL "${PARTS}\n")
  message(FATAL_ERROR "${OBJECT}: gives ${symbols}, expected ${PARTS} alone")
endif()
execute_process(COMMAND ${OBJDUMP} -d --no-show-raw-insn ${BASELINE} OUTPUT_VARIABLE code COMMAND_ERROR_IS_FATAL ANY)
if(code MATCHES "\t(v[a-z0-9]+) [^\n]*%[xyz]mm")
  message(FATAL_ERROR "${BASELINE}: contains ${CMAKE_MATCH_1}, expected code for any x86-64 processor")
endif()
