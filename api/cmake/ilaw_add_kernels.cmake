# ilaw_add_kernels(name source) gives the law library <name>.so kernels for GPUs (ilaw/ext/draft/device.h): the same
# source goes once more through clang, which alone makes PTX of it, and SPIR-V with llvm-spirv; neither CUDA nor ROCm
# is needed. It does nothing where ILAW_KERNELS does not name the law, where clang cannot, and in instrumented and debug
# builds.
set(ILAW_KERNELS OFF CACHE STRING "Kernels for GPUs: ON for all laws that ask for them, or names of laws")

# Each operation is rounded, as on the CPU. The standard headers are the host's. PTX: a law's step is compiled into the
# kernel, whatever its length, as a call would take the node out of the registers.
macro(ilaw_set_kernel_flags)
  set(ILAW_KERNEL_FLAGS -std=c++20 -O3 -ffp-contract=off -fno-math-errno -fno-trapping-math -fno-exceptions -fno-rtti
      -fno-threadsafe-statics -DILAW_KIT_DEVICE -DILAW_KIT_LEVEL=device
      -include ilaw/device/prelude.hpp -Wno-bitwise-instead-of-logical -Wno-c++11-narrowing
      -Wno-unknown-cuda-version)
  set(ILAW_KERNEL_FLAGS_PTX -x cuda --cuda-device-only -nocudainc -nocudalib --cuda-gpu-arch=sm_70 -Xclang
      -target-feature -Xclang +ptx63 -mllvm -inline-threshold=1000 -S)
  set(ILAW_KERNEL_FLAGS_SPIRV -x hip --offload=spirv64 --cuda-device-only -nogpulib -nogpuinc -emit-llvm -c)
endmacro()

# ILAW_KERNEL_KINDS: which of the two this machine can make, found once.
function(ilaw_find_kernel_compiler)
  if(DEFINED ILAW_KERNEL_KINDS)
    return()
  endif()
  ilaw_set_kernel_flags()
  find_program(ILAW_KERNEL_CLANG NAMES clang++-14 clang++)
  find_program(ILAW_LLVM_SPIRV NAMES llvm-spirv-14 llvm-spirv)
  set(probe ${CMAKE_BINARY_DIR}/CMakeFiles/kernel_probe)
  file(WRITE ${probe}.cpp "extern \"C\" __attribute__((global)) void probe(double* a) { *a = 1.0; }\n")
  set(kinds)
  foreach(kind PTX SPIRV)
    if(ILAW_KERNEL_CLANG AND (kind STREQUAL "PTX" OR ILAW_LLVM_SPIRV))
      execute_process(COMMAND ${ILAW_KERNEL_CLANG} ${ILAW_KERNEL_FLAGS_${kind}} ${probe}.cpp -o ${probe}.${kind}
                      RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
      if(NOT failed)
        list(APPEND kinds ${kind})
      endif()
    endif()
  endforeach()
  set(ILAW_KERNEL_KINDS "${kinds}" CACHE INTERNAL "Kinds of kernels for GPUs that can be made here")
endfunction()

# The images of a source as <folder>/<name>.ptx and .spirv, linked into a target between the symbols <prefix>_ptx and
# <prefix>_ptx_end, and the same of spirv.
function(ilaw_add_kernel_images target name source prefix)
  ilaw_set_kernel_flags()
  target_link_libraries(${target} PRIVATE ilaw::device_kit)
  set(includes -I$<JOIN:$<TARGET_PROPERTY:ilaw::device_kit,INTERFACE_INCLUDE_DIRECTORIES>,$<SEMICOLON>-I>)
  set(text)
  set(images)
  foreach(kind IN LISTS ILAW_KERNEL_KINDS)
    string(TOLOWER ${kind} lower)
    set(image ${CMAKE_CURRENT_BINARY_DIR}/${name}.${lower})
    set(compile ${ILAW_KERNEL_CLANG} ${ILAW_KERNEL_FLAGS_${kind}} ${ILAW_KERNEL_FLAGS} ${includes} -MD -MT ${image}
                -MF ${image}.d ${source})
    if(kind STREQUAL "PTX")
      set(commands COMMAND ${compile} -o ${image})
    else()
      # ContractionOff in every kernel: a driver may fuse no operations either.
      set(commands COMMAND ${compile} -o ${image}.bc
                   COMMAND ${ILAW_LLVM_SPIRV} --spirv-fp-contract=off --spirv-max-version=1.1 ${image}.bc -o ${image})
    endif()
    add_custom_command(OUTPUT ${image} ${commands} DEPENDS ${source} DEPFILE ${image}.d COMMAND_EXPAND_LISTS VERBATIM
                       COMMENT "Kernels ${image}")
    string(APPEND text "ILAW_IMAGE(${prefix}_${lower}, \"${image}\")\n")
    list(APPEND images ${image})
    target_compile_definitions(${target} PRIVATE ILAW_HAS_${kind})
  endforeach()
  set(holder ${CMAKE_CURRENT_BINARY_DIR}/${name}_images.cpp)
  file(CONFIGURE OUTPUT ${holder} @ONLY CONTENT [=[
// Images of kernels as they are, and a zero behind each.
#define ILAW_IMAGE(name, file)                                                                     \
  asm(".section .rodata\n.balign 16\n.globl " #name "\n.hidden " #name "\n" #name ":\n.incbin \"" file \
      "\"\n.globl " #name "_end\n.hidden " #name "_end\n" #name "_end:\n.byte 0\n.text\n");
@text@]=])
  set_source_files_properties(${holder} PROPERTIES OBJECT_DEPENDS "${images}")
  target_sources(${target} PRIVATE ${holder})
endfunction()

# Whether kernels are made at all.
function(ilaw_makes_kernels result)
  ilaw_find_kernel_compiler()
  set(${result} ON PARENT_SCOPE)
  if(NOT ILAW_KERNELS OR NOT ILAW_KERNEL_KINDS OR ILAW_SANITIZE OR CMAKE_BUILD_TYPE STREQUAL "Debug")
    set(${result} OFF PARENT_SCOPE)
  endif()
endfunction()

function(ilaw_add_kernels name source)
  ilaw_makes_kernels(makes_kernels)
  if(makes_kernels AND (ILAW_KERNELS STREQUAL "ON" OR name IN_LIST ILAW_KERNELS))
    get_filename_component(source ${source} ABSOLUTE)
    ilaw_add_kernel_images(${name} ${name} ${source} ilaw_kit)
  endif()
endfunction()
