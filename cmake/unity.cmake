# SPDX-License-Identifier: Apache-2.0
# Several source files compiled as one, so that what Eigen's templates become is compiled once for
# all of them: most of the work of a build. CI compiles so; `run`, `bench` and `develop` compile each
# file by itself, and `.ci/run parse` shows that each can be.
option(SUNDER_UNITY "Compile several source files of a library or a test at once" OFF)
if(SUNDER_UNITY)
  # Two files' names in anonymous namespaces then hide each other without harm.
  target_compile_options(sunder_options INTERFACE -Wno-shadow)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Such units are large: g++ else spends a sixth of its time on looking for garbage.
    target_compile_options(sunder_options INTERFACE --param=ggc-min-heapsize=1000000)
  endif()
endif()

# sunder_unity(TARGET [ALONE FILES...]): a file stays alone whose anonymous namespace has a name that
# another of the target has too; the compiler calls it a redefinition.
function(sunder_unity target)
  cmake_parse_arguments(U "" "" "ALONE" ${ARGN})
  get_target_property(sources ${target} SOURCES)
  list(LENGTH sources count)
  if(NOT SUNDER_UNITY OR count LESS 2)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 12)
  set_source_files_properties(${U_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
