# ilaw_add_part(name license contained|linked [version]) records a library of others that is compiled into what is
# installed, or that it needs at run time, for the list of parts (ilaw_add_sbom).
function(ilaw_add_part name license relation)
  string(JSON part SET "{}" name "\"${name}\"")
  string(JSON part SET "${part}" license "\"${license}\"")
  string(JSON part SET "${part}" relation "\"${relation}\"")
  if(ARGN)
    string(JSON part SET "${part}" version "\"${ARGN}\"")
  endif()
  get_property(parts GLOBAL PROPERTY ILAW_PARTS)
  string(JSON parts SET "{${parts}}" "${name}" "${part}")
  string(REGEX REPLACE "^{(.*)}$" "\\1" parts "${parts}")
  set_property(GLOBAL PROPERTY ILAW_PARTS "${parts}")
endfunction()

# An SPDX document (JSON, version 2.3) of all parts and of the sources that are built or installed.
function(ilaw_add_sbom)
  find_package(Python3 COMPONENTS Interpreter)
  if(NOT Python3_Interpreter_FOUND)
    message(STATUS "No Python: the list of parts, ilaw.spdx.json, is left out")
    return()
  endif()
  get_property(parts GLOBAL PROPERTY ILAW_PARTS)
  set(folder ${PROJECT_BINARY_DIR}/sbom)
  file(CONFIGURE OUTPUT ${folder}/parts.json CONTENT "{${parts}}\n" @ONLY)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}
       ${PROJECT_SOURCE_DIR}/api/* ${PROJECT_SOURCE_DIR}/plugins/* ${PROJECT_SOURCE_DIR}/host_mock/*
       ${PROJECT_SOURCE_DIR}/docs/man/*.1 ${PROJECT_SOURCE_DIR}/docs/template_repository/*)
  list(FILTER files EXCLUDE REGEX "/(__pycache__|build|[^/]*[.]egg-info)/|~$")
  list(APPEND files CMakeLists.txt LICENSE)
  list(JOIN files "\n" lines)
  file(CONFIGURE OUTPUT ${folder}/files.txt CONTENT "${lines}\n" @ONLY)
  list(TRANSFORM files PREPEND ${PROJECT_SOURCE_DIR}/)
  set(script ${PROJECT_SOURCE_DIR}/api/cmake/make_sbom.py)
  set(document ${PROJECT_BINARY_DIR}/ilaw.spdx.json)
  add_custom_command(OUTPUT ${document}
    COMMAND ${Python3_EXECUTABLE} ${script} ${PROJECT_SOURCE_DIR} ${PROJECT_VERSION} ${folder}/files.txt
            ${folder}/parts.json ${document}
    DEPENDS ${files} ${folder}/files.txt ${folder}/parts.json VERBATIM)
  add_custom_target(ilaw_sbom ALL DEPENDS ${document})
  install(FILES ${document} DESTINATION share/doc/ilaw COMPONENT programs)
endfunction()
