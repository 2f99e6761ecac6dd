# ilaw_add_plugin(name source...) makes the law library <name>.so, as portable as a library can be:
# nothing exported but the entry, nothing needed but libc and libm, the same bits on every processor.
function(ilaw_add_plugin name)
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE ilaw::kit)
  set_target_properties(${name} PROPERTIES
    PREFIX "" SUFFIX ".so"
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/ilaw)
  install(TARGETS ${name} LIBRARY DESTINATION lib/ilaw)
endfunction()
