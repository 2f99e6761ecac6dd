# ilaw_check_plugin(name argument...) adds the test check.<name>: ilaw-check on the library that ilaw_add_plugin
# made, or any other MODULE that is one, with further arguments such as --only RULE. Where there is the program ilaw,
# stress.<name> runs random scenes of the law.
function(ilaw_check_plugin name)
  # Beside this file in a build folder, or where an installed one has it.
  set(here ${CMAKE_CURRENT_FUNCTION_LIST_DIR})
  set(places HINTS ${here}/bin ${here}/../../../bin)
  if(TARGET ilaw_check_program)
    set(check $<TARGET_FILE:ilaw_check_program>)
  else()
    find_program(ILAW_CHECK_PROGRAM ilaw-check ${places} REQUIRED)
    set(check ${ILAW_CHECK_PROGRAM})
  endif()
  add_test(NAME check.${name} COMMAND ${check} $<TARGET_FILE:${name}> ${ARGN})
  find_program(ILAW_PROGRAM ilaw ${places})
  if(ILAW_PROGRAM)
    add_test(NAME stress.${name} COMMAND ${ILAW_PROGRAM} stress --law $<TARGET_FILE:${name}> --scenes 60 --steps 2000)
  endif()
endfunction()
