# SPDX-License-Identifier: Apache-2.0
# sunder_header_package(NAME TARGET [VERSION]): a package of headers alone. For another machine its
# target is made here: what Debian has names /usr/include, which holds this machine's C library too.
function(sunder_header_package name target)
  if(NOT CMAKE_CROSSCOMPILING)
    find_package(${name} ${ARGN} REQUIRED)
  elseif(NOT TARGET ${target})
    add_library(${target} INTERFACE IMPORTED)
    target_include_directories(${target} SYSTEM INTERFACE ${SUNDER_HOST_HEADERS})
  endif()
endfunction()
