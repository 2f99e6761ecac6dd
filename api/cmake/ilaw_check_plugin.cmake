# ilaw_check_plugin(name argument...) adds the test check.<name>: ilaw-check on the library that ilaw_add_plugin
# made, or any other MODULE that is one, with further arguments such as --only RULE.
function(ilaw_check_plugin name)
  if(TARGET ilaw_check_program)
    set(program $<TARGET_FILE:ilaw_check_program>)
  else()
    # Beside this file in a build folder, or where an installed one has it.
    set(here ${CMAKE_CURRENT_FUNCTION_LIST_DIR})
    find_program(ILAW_CHECK_PROGRAM ilaw-check HINTS ${here}/bin ${here}/../../../bin REQUIRED)
    set(program ${ILAW_CHECK_PROGRAM})
  endif()
  add_test(NAME check.${name} COMMAND ${program} $<TARGET_FILE:${name}> ${ARGN})
endfunction()
