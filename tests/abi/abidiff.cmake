# The header of this minor version against the one released with it: FROZEN and TODAY are libraries made from
# surface.c. Any difference fails, also one that neither names nor sizes show, such as two members that changed places.
execute_process(COMMAND ${ABIDIFF} --no-show-locs ${FROZEN} ${TODAY} RESULT_VARIABLE code OUTPUT_VARIABLE text
                ERROR_VARIABLE text)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "abidiff found (code ${code}):\n${text}")
endif()
