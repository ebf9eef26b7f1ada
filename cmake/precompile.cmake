# SPDX-License-Identifier: Apache-2.0
# Precompiled headers: the parsing of Eigen, GoogleTest and the standard library is about half of a
# cold build. Off: every file must include what it uses, and does.
option(SUNDER_PRECOMPILE "Precompile the headers of others" ON)

set(SUNDER_STANDARD_HEADERS
  <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory>
  <numeric> <optional> <span> <string> <string_view> <utility> <variant> <vector>)

# sunder_precompile(TARGET [HEADERS...] [FROM OTHER]): own headers, or those of a target whose
# compile options are the same.
function(sunder_precompile target)
  cmake_parse_arguments(P "" "FROM" "" ${ARGN})
  if(NOT SUNDER_PRECOMPILE)
    return()
  endif()
  if(P_FROM)
    target_precompile_headers(${target} REUSE_FROM ${P_FROM})
  else()
    target_precompile_headers(${target} PRIVATE ${SUNDER_STANDARD_HEADERS} ${P_UNPARSED_ARGUMENTS})
  endif()
endfunction()
