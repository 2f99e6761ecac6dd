set(ILAW_LEVELS "v3;v4" CACHE STRING "Levels of x86-64 that laws are compiled for beside the baseline: v3, v4 or both")

# ilaw_add_plugin(name source) makes the law library <name>.so, as portable as a library can be: nothing exported
# but the entry, nothing needed but libc and libm, the same bits on every processor. On x86-64 a source in C++ is
# compiled once per instruction-set level: the compiler's own, the baseline, and those of ILAW_LEVELS; the library takes
# the best one that the processor has when an instance is created.
# A source in C (ilaw/plain_c.h) is compiled once. DEVICE: with kernels for GPUs, where they can be made.
function(ilaw_add_plugin name source)
  cmake_parse_arguments(PARSE_ARGV 2 arg "DEVICE" "" "")
  get_property(languages GLOBAL PROPERTY ENABLED_LANGUAGES)
  if(source MATCHES "[.]c$" AND NOT "C" IN_LIST languages)
    message(FATAL_ERROR "${source} is in C, which this project lacks: project(${PROJECT_NAME} LANGUAGES C)")
  endif()
  add_library(${name} MODULE ${source})
  if(source MATCHES "[.]c$")
    target_link_libraries(${name} PRIVATE ilaw::abi m)
    target_compile_options(${name} PRIVATE -ffp-contract=off -fvisibility=hidden)
    target_link_options(${name} PRIVATE -static-libgcc LINKER:--as-needed)
    set_target_properties(${name} PROPERTIES C_STANDARD 99 C_EXTENSIONS OFF)
  else()
    ilaw_compile_law(${name})
    target_link_options(${name} PRIVATE -static-libgcc -static-libstdc++ LINKER:--as-needed LINKER:--exclude-libs,ALL)
    if(NOT ILAW_SANITIZE)  # clang's sanitizers are in the program alone, so an instrumented library is not complete
      target_link_options(${name} PRIVATE LINKER:-z,defs)
    endif()
  endif()
  # Instrumented and debug builds look for mistakes, not for speed: one level is enough.
  if(NOT source MATCHES "[.]c$" AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT ILAW_SANITIZE AND
     NOT CMAKE_BUILD_TYPE STREQUAL "Debug")
    target_compile_definitions(${name} PRIVATE ILAW_KIT_OTHER_LEVELS)
    foreach(level IN LISTS ILAW_LEVELS)
      if(NOT level MATCHES "^v[34]$")
        message(FATAL_ERROR "ILAW_LEVELS has ${level}, expected v3, v4 or both")
      endif()
      ilaw_add_level(${name} ${source} ${level})
    endforeach()
  endif()
  if(arg_DEVICE AND NOT source MATCHES "[.]c$")
    ilaw_add_kernels(${name} ${source})
  endif()
  set_target_properties(${name} PROPERTIES
    PREFIX "" SUFFIX ".so"
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/ilaw)
  ilaw_describe_plugin(${name})
endfunction()

# A law throws nothing and asks for no type at run time: tables for that would only make the library larger.
function(ilaw_compile_law target)
  target_link_libraries(${target} PRIVATE ilaw::kit)
  target_compile_options(${target} PRIVATE -fno-exceptions -fno-rtti -fno-asynchronous-unwind-tables)
endfunction()

# The source at one level, as an object whose only global symbol is the function that gives its parts. All else is
# made local: an inline function that has the same name at several levels, of a law's own header or of the standard
# library, would else be merged by the linker, and code for the best processors run on the least.
function(ilaw_add_level name source level)
  find_program(ILAW_LD NAMES ld.bfd ld REQUIRED)
  find_program(ILAW_OBJCOPY objcopy REQUIRED)
  add_library(${name}_${level} OBJECT ${source})
  ilaw_compile_law(${name}_${level})
  target_compile_definitions(${name}_${level} PRIVATE ILAW_KIT_LEVEL=${level}
                                                      ILAW_KIT_PARTS=ilaw_kit_parts_${level})
  target_compile_options(${name}_${level} PRIVATE -march=x86-64-${level})
  if(level STREQUAL "v4")
    target_compile_options(${name}_${level} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-mprefer-vector-width=512>)
  endif()
  set_target_properties(${name}_${level} PROPERTIES POSITION_INDEPENDENT_CODE ON INTERPROCEDURAL_OPTIMIZATION OFF)
  set(object ${CMAKE_CURRENT_BINARY_DIR}/${name}_${level}.o)
  add_custom_command(OUTPUT ${object}
    COMMAND ${ILAW_LD} -r --force-group-allocation -o ${object} $<TARGET_OBJECTS:${name}_${level}>
    COMMAND ${ILAW_OBJCOPY} --keep-global-symbol=ilaw_kit_parts_${level} ${object}
    DEPENDS ${name}_${level} $<TARGET_OBJECTS:${name}_${level}>
    COMMAND_EXPAND_LISTS VERBATIM)
  set_source_files_properties(${object} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
  target_sources(${name} PRIVATE ${object})
endfunction()
