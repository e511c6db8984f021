# beltpick_library: makes a library of one folder and enforces the layers of the design.
#
#   beltpick_library(<name> LAYER <n> [SOURCES <file>...] [LINKS <beltpick library>...] [PACKAGES <external target>...]
#                    [PRIVATE_PACKAGES <external target>...] [ONLY <library>...] [NEVER <library>...])
#
# A library lives in the folder of its own name, is included as "<name>/<header>.hpp", and may link only libraries of a
# lower layer: a sibling or a higher layer fails to configure. So does a source that includes the header of a library it
# does not reach through LINKS. ONLY names all that may be reached (the virtual cell must share no geometry with what
# it tests), NEVER what may not (the host does without capture and plc).
# beltpick_program makes an executable under the same checks.

function(_beltpick_closure out)
  set(seen)
  set(queue ${ARGN})
  while(queue)
    list(POP_FRONT queue item)
    if(item IN_LIST seen)
      continue()
    endif()
    if(NOT TARGET ${item})
      message(FATAL_ERROR "beltpick: '${item}' is linked before it is defined; a library may link only lower layers")
    endif()
    list(APPEND seen ${item})
    get_target_property(links ${item} BELTPICK_LINKS)
    if(links)
      list(APPEND queue ${links})
    endif()
  endwhile()
  set(${out} ${seen} PARENT_SCOPE)
endfunction()

# Refuses an include of a beltpick library that is not among what the target reaches.
function(_beltpick_check_includes name reach)
  get_property(known GLOBAL PROPERTY BELTPICK_LIBRARIES)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*.hpp" "${CMAKE_CURRENT_SOURCE_DIR}/*.h"
    "${CMAKE_CURRENT_SOURCE_DIR}/*.cpp")
  if(ARGN)
    set(files ${ARGN})
  endif()
  foreach(file IN LISTS files)
    get_filename_component(absolute "${file}" ABSOLUTE)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${absolute}")
    file(STRINGS "${absolute}" lines REGEX "^#include \"[a-z_0-9]+/")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^#include \"([a-z_0-9]+)/.*" "\\1" folder "${line}")
      if(folder IN_LIST known AND NOT folder IN_LIST reach AND NOT folder STREQUAL name)
        message(FATAL_ERROR "beltpick: ${absolute} includes ${folder}/, which ${name} does not link")
      endif()
    endforeach()
  endforeach()
endfunction()

function(_beltpick_check_reach name reach only never)
  foreach(item IN LISTS reach)
    if(only AND NOT item IN_LIST only)
      message(FATAL_ERROR "beltpick: ${name} may link only ${only}, but reaches '${item}'")
    endif()
    if(item IN_LIST never)
      message(FATAL_ERROR "beltpick: ${name} must not link '${item}'")
    endif()
  endforeach()
endfunction()

function(beltpick_library name)
  cmake_parse_arguments(arg "" "LAYER" "SOURCES;LINKS;PACKAGES;PRIVATE_PACKAGES;ONLY;NEVER" ${ARGN})
  _beltpick_closure(reach ${arg_LINKS})
  foreach(item IN LISTS reach)
    get_target_property(layer ${item} BELTPICK_LAYER)
    if(NOT layer LESS arg_LAYER)
      message(FATAL_ERROR "beltpick: ${name} (layer ${arg_LAYER}) links '${item}' (layer ${layer}); only lower layers may be linked")
    endif()
  endforeach()
  _beltpick_check_reach(${name} "${reach}" "${arg_ONLY}" "${arg_NEVER}")
  set_property(GLOBAL APPEND PROPERTY BELTPICK_LIBRARIES ${name})
  _beltpick_check_includes(${name} "${reach}")

  get_filename_component(include_root "${CMAKE_CURRENT_SOURCE_DIR}" DIRECTORY)
  if(arg_SOURCES)
    add_library(${name} STATIC ${arg_SOURCES})
    target_include_directories(${name} PUBLIC "${include_root}")
    target_link_libraries(${name} PUBLIC ${arg_LINKS} ${arg_PACKAGES} PRIVATE ${arg_PRIVATE_PACKAGES} beltpick_warnings)
  else()
    add_library(${name} INTERFACE)
    target_include_directories(${name} INTERFACE "${include_root}")
    target_link_libraries(${name} INTERFACE ${arg_LINKS} ${arg_PACKAGES})
  endif()
  set_target_properties(${name} PROPERTIES BELTPICK_LAYER "${arg_LAYER}" BELTPICK_LINKS "${arg_LINKS}")
endfunction()

function(beltpick_program name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINKS;PACKAGES;ONLY;NEVER" ${ARGN})
  _beltpick_closure(reach ${arg_LINKS})
  _beltpick_check_reach(${name} "${reach}" "${arg_ONLY}" "${arg_NEVER}")
  _beltpick_check_includes(${name} "${reach}" ${arg_SOURCES})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LINKS} ${arg_PACKAGES} beltpick_warnings)
endfunction()

# Compiles sources with BELTPICK_KERNEL functions (base/kernel.hpp) for speed, with the same bits on every vector unit:
# errno and floating-point traps, which nobody reads, would only keep sqrt and comparisons from being vectorised. Vectors
# wider than the baseline's pass between functions of one source only, so that how they do (-Wpsabi) matters to nobody.
function(beltpick_kernel_sources)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "-O3;-ffp-contract=off;-fno-math-errno;-fno-trapping-math;-Wno-psabi")
endfunction()
