# ilaw_add_plugin(name source) makes the law library <name>.so, as portable as a library can be: nothing exported
# but the entry, nothing needed but libc and libm, the same bits on every processor. On x86-64 the source is compiled
# once per instruction-set level; the library takes the best one that it finds when an instance is created.
function(ilaw_add_plugin name source)
  add_library(${name} MODULE ${source})
  target_link_libraries(${name} PRIVATE ilaw::kit)
  # Instrumented and debug builds look for mistakes, not for speed: one level is enough.
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT ILAW_SANITIZE AND
     NOT CMAKE_BUILD_TYPE STREQUAL "Debug")
    target_compile_definitions(${name} PRIVATE ILAW_KIT_OTHER_LEVELS)
    foreach(level v3 v4)
      add_library(${name}_${level} OBJECT ${source})
      target_link_libraries(${name}_${level} PRIVATE ilaw::kit)
      target_compile_definitions(${name}_${level} PRIVATE ILAW_KIT_LEVEL=${level}
                                                          ILAW_KIT_WALKS=ilaw_kit_walks_${level})
      target_compile_options(${name}_${level} PRIVATE -march=x86-64-${level})
      set_target_properties(${name}_${level} PROPERTIES POSITION_INDEPENDENT_CODE ON)
      target_sources(${name} PRIVATE $<TARGET_OBJECTS:${name}_${level}>)
    endforeach()
    target_compile_options(${name}_v4 PRIVATE $<$<CXX_COMPILER_ID:GNU>:-mprefer-vector-width=512>)
  endif()
  set_target_properties(${name} PROPERTIES
    PREFIX "" SUFFIX ".so"
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/ilaw)
endfunction()
