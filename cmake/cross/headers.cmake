# SPDX-License-Identifier: Apache-2.0
# What Debian has for this machine and is headers alone serves every other: links to it in a folder
# of their own, since /usr/include as a whole would bring this machine's C library along.
set(SUNDER_HOST_HEADERS ${CMAKE_BINARY_DIR}/host-headers CACHE PATH "Headers of this machine that serve any")
file(MAKE_DIRECTORY ${SUNDER_HOST_HEADERS})
foreach(header vulkan vk_video toml++ nlohmann CLI)
  if(EXISTS /usr/include/${header})
    file(CREATE_LINK /usr/include/${header} ${SUNDER_HOST_HEADERS}/${header} SYMBOLIC)
  endif()
endforeach()
set(VULKAN_INCLUDE_DIR ${SUNDER_HOST_HEADERS} CACHE PATH "Vulkan headers")
set(Eigen3_DIR /usr/share/eigen3/cmake CACHE PATH "Eigen")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
