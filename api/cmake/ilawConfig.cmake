# find_package(ilaw): targets ilaw::abi (the header), ilaw::kit (to write laws), ilaw::loader (to host them),
# ilaw::coupled (contacts that share bodies), ilaw::device (laws on a GPU, where it was built) and ilaw::device_kit
# (headers of kernels for GPUs), and the functions ilaw_add_plugin, ilaw_describe_plugin and ilaw_check_plugin. The Fortran module is source, in share/ilaw/fortran.
include(${CMAKE_CURRENT_LIST_DIR}/ilawTargets.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/ilaw_add_plugin.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/ilaw_add_kernels.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/ilaw_check_plugin.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/ilaw_describe_plugin.cmake)
