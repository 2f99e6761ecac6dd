# ilaw_describe_plugin(name) writes the description of the law library <name>.so to <name>.json beside it whenever the
# library is built, so that programs read it without running the library's code. Install it with the library.
function(ilaw_describe_plugin name)
  if(CMAKE_CROSSCOMPILING)
    return()  # a library of another machine cannot be opened here
  endif()
  if(TARGET ilaw_describe)
    set(program $<TARGET_FILE:ilaw_describe>)
    add_dependencies(${name} ilaw_describe)
  else()
    # Beside this file in a build folder, or where an installed one has it.
    set(here ${CMAKE_CURRENT_FUNCTION_LIST_DIR})
    find_program(ILAW_DESCRIBE_PROGRAM ilaw-describe HINTS ${here}/bin ${here}/../../../bin REQUIRED)
    set(program ${ILAW_DESCRIBE_PROGRAM})
  endif()
  get_target_property(folder ${name} LIBRARY_OUTPUT_DIRECTORY)
  if(NOT folder)
    set(folder ${CMAKE_CURRENT_BINARY_DIR})
  endif()
  add_custom_command(TARGET ${name} POST_BUILD COMMAND ${program} $<TARGET_FILE:${name}>
                     BYPRODUCTS ${folder}/${name}.json VERBATIM)
endfunction()
