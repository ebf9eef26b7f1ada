# SPDX-License-Identifier: Apache-2.0
# Windows on x86-64 by Debian's mingw-w64 (g++-mingw-w64-x86-64-posix), run by its wine64.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
# The runtime of g++ and its threads go into each file: a DLL or a program stands alone.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static")
set(CMAKE_SHARED_LINKER_FLAGS_INIT "-static")
find_program(SUNDER_WINE NAMES wine64 wine64-stable wine PATHS /usr/lib/wine)
set(CMAKE_CROSSCOMPILING_EMULATOR ${SUNDER_WINE})
# Debian has zlib for it.
set(ZLIB_INCLUDE_DIR /usr/x86_64-w64-mingw32/include CACHE PATH "zlib")
set(ZLIB_LIBRARY /usr/x86_64-w64-mingw32/lib/libz.a CACHE FILEPATH "zlib")
include(${CMAKE_CURRENT_LIST_DIR}/headers.cmake)
