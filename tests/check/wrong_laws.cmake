# A law of the tree with one mistake, as libraries that tests check: name law file from to. The file is one of plugins/
# or a header of the kit, "from" stands in it exactly once.
function(ilaw_add_wrong_law name law file from to)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${file})
  file(READ ${PROJECT_SOURCE_DIR}/${file} text)
  string(FIND "${text}" "${from}" first)
  string(FIND "${text}" "${from}" last REVERSE)
  if(first EQUAL -1 OR NOT first EQUAL last)
    message(FATAL_ERROR "${file} has not exactly once: ${from}")
  endif()
  string(REPLACE "${from}" "${to}" text "${text}")
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${name})
  string(REGEX REPLACE "^(api/include|plugins)/" "${folder}/" copy ${file})
  # A header of the kit that had the mistake before would stand in the way of the tree's.
  file(GLOB_RECURSE old ${folder}/ilaw/*.hpp)
  list(REMOVE_ITEM old ${copy})
  if(old)
    file(REMOVE ${old})
  endif()
  foreach(part IN ITEMS ${law} bond)
    file(GLOB sources ${PROJECT_SOURCE_DIR}/plugins/${part}/*.[ch]pp)
    foreach(source IN LISTS sources)
      file(RELATIVE_PATH place ${PROJECT_SOURCE_DIR}/plugins ${source})
      if(NOT copy STREQUAL ${folder}/${place})
        configure_file(${source} ${folder}/${place} COPYONLY)
      endif()
    endforeach()
  endforeach()
  file(CONFIGURE OUTPUT ${copy} CONTENT "${text}" @ONLY)
  add_library(${name} MODULE ${folder}/${law}/${law}.cpp)
  target_include_directories(${name} BEFORE PRIVATE ${folder})
  ilaw_compile_law(${name})
  set_target_properties(${name} PROPERTIES PREFIX "" SUFFIX ".so" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
  add_dependencies(check_test ${name})
endfunction()

# Wrong where H is transverse alone.
ilaw_add_wrong_law(cohesive_transverse cohesive plugins/bond/bonded_inertia.hpp
                   "return {m.left_n * d.n, m.left_t * d.t1, m.left_t * d.t2};"
                   "return {m.left_n * d.n, m.left_n * d.t1, m.left_n * d.t2};")
# Writes its state before its node is solved.
ilaw_add_wrong_law(cohesive_asks cohesive plugins/bond/bond.hpp
                   "    if (any(open)) {\n      p = {as_full(node.delassus)"
                   "    if (any(open)) {\n      node.state.opening = node.state.position;\n      p = {as_full(node.delassus)")
# Loses adhesion per step, not per time.
ilaw_add_wrong_law(rccm_step rccm plugins/rccm/rccm.cpp "viscosity / all.step.velocity_step"
                   "viscosity / (all.step.velocity_step > 0.0 ? 0x1p-10 : 0.0)")
# The moment turns the wrong way in the host's axes.
ilaw_add_wrong_law(rolling_turned rolling api/include/ilaw/kit/detail/frame.hpp
                   "cross(frame.n, axis<V>{u.x, u.y, u.z});"
                   "cross(axis<V>{u.x, u.y, u.z}, frame.n);")
# Energy without the work of the moment.
ilaw_add_wrong_law(rolling_work rolling api/include/ilaw/kit/detail/kernel.hpp
                   "along_tangents = along_tangents - 0.5 * (twist + roll);"
                   "along_tangents = along_tangents - 0.0 * (twist + roll);")
# The velocity does not know the moment.
ilaw_add_wrong_law(rolling_velocity rolling api/include/ilaw/kit/vector.hpp
                   "return transverse<V>::times(r) - k * q.tangential_part();"
                   "return transverse<V>::times(r) - 0.0 * k * q.tangential_part();")
# Does not turn its history with the normal.
ilaw_add_wrong_law(postit_unturned postit api/include/ilaw/kit/detail/frame.hpp
                   "f.t1 = transported_tangent(n, t, f.n);" "f.t1 = any_tangent(f.n);")
# Moves its bond by the velocity without its impulse, which is the one before the step only where no force acts.
ilaw_add_wrong_law(rccm_force rccm plugins/bond/bond_step.hpp "p_.state.opening + V(0.5 * step) * p_.v_previous;"
                   "p_.state.opening + V(0.5 * step) * p_.v_free;")
# Friction against the slip after a force that turned it round within the step: it works along the way before.
ilaw_add_wrong_law(table_friction_turned table_friction api/include/ilaw/kit/friction.hpp
                   "const auto gains = along < impact;" "const auto gains = none<V>();")
# Has one strength for a large area and a small one.
ilaw_add_wrong_law(tie_area tie plugins/tie/tie.cpp "strength * node.area" "strength")
# Has another unit than it says.
ilaw_add_wrong_law(tie_unit tie plugins/tie/tie.cpp "\"N.s/m^2\"" "\"N.s\"")
