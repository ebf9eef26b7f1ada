# SPDX-License-Identifier: Apache-2.0
# Compile options of every target of the project.
add_library(sunder_options INTERFACE)
target_compile_options(sunder_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wcast-qual
  # Bitwise repeatability over compilers' whims: no contraction of a*b+c.
  -ffp-contract=off
  # Everywhere alike: it defines a macro, and precompiled headers are shared between targets.
  -pthread)
target_link_options(sunder_options INTERFACE -pthread)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # g++ 12 sees overlaps in std::string's operator+ that are not there (GCC bug 105651).
  # With precompiled headers it also loses that the standard library's are system headers.
  target_compile_options(sunder_options INTERFACE
    -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
endif()
if(SUNDER_WERROR)
  target_compile_options(sunder_options INTERFACE -Werror)
endif()
# Only the parts of Eigen under MPL2: the library links into closed trainers.
target_compile_definitions(sunder_options INTERFACE EIGEN_MPL2_ONLY)
if(SUNDER_SANITIZE)
  target_compile_options(sunder_options INTERFACE
    -fsanitize=${SUNDER_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(sunder_options INTERFACE -fsanitize=${SUNDER_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    target_compile_options(sunder_options INTERFACE
      -fsanitize-ignorelist=${CMAKE_CURRENT_LIST_DIR}/sanitizer_ignore.txt)
  endif()
endif()

# sunder_keep_libraries(PROGRAM): with sanitizers libraries that it has loaded stay so.
function(sunder_keep_libraries program)
  if(SUNDER_SANITIZE)
    if(NOT TARGET sunder_kept_libraries)
      add_library(sunder_kept_libraries OBJECT ${PROJECT_SOURCE_DIR}/cmake/keep_libraries.cpp)
    endif()
    target_link_libraries(${program} PRIVATE sunder_kept_libraries)
  endif()
endfunction()
