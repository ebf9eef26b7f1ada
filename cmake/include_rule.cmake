# SPDX-License-Identifier: Apache-2.0
# Which room may include which: checked before anything is compiled, in every build.
#   cmake -DROOT=SOURCE [-DSTAMP=FILE] -P cmake/include_rule.cmake
# A room is a folder; a file belongs to the innermost one that is named here. It may include its own
# room, the rooms after the colon, and headers that are none of ours, in quotes or angle brackets
# alike. A header in quotes that has no folder in its name ("pieces.hpp") is looked up next to the file.
cmake_minimum_required(VERSION 3.22)

set(rooms
  "core/sunder:"
  "core/scene:core/sunder"
  "core/machine:"
  "core/material:core/sunder core/machine"
  "core/linear_algebra:core/sunder core/machine"
  "core/body:core/sunder core/machine core/material core/linear_algebra"
  "core/solver:core/sunder core/machine core/material core/linear_algebra core/body"
  "core/finite:core/sunder core/machine core/material core/linear_algebra core/body core/solver"
  "core/fracture:core/sunder core/material core/linear_algebra core/body"
  "core/frame:core/sunder core/material core/body core/fracture"
  "cpu_reference:core/sunder core/machine core/material core/linear_algebra core/body core/solver core/finite"
  "cpu_reference/plain:core/sunder"
  "shaders:"
  "gpu:core/sunder core/machine core/material core/linear_algebra core/body core/solver core/finite shaders"
  "api/sunder:core/sunder"
  "api:core/sunder api/sunder core/frame cpu_reference gpu"
  "app/system:core/machine"
  "app/input:core/sunder app/system"
  "app/inputs:core/sunder app/system app/input app/output"
  "app/mesh_board:core/sunder app/system app/input app/output"
  "app/gmsh:core/sunder app/input app/mesh_board"
  "app/output:core/sunder app/system"
  "app/figure:core/sunder app/output"
  "app/report:core/sunder app/output app/figure"
  "app/reproduce:core/sunder api/sunder app/system app/input app/output app/figure app/report"
  "app/sweep:core/sunder api/sunder app/system app/input app/output app/report"
  "app/view:core/sunder api/sunder app/input app/inputs app/output app/figure"
  "app/commands:core/sunder api/sunder app/system app/input app/inputs app/mesh_board app/output app/figure app/report app/reproduce app/sweep app/view"
  "app/cli:core/sunder api/sunder app/system app/input app/commands"
)
# Where the headers of a room are looked for: "body/element.hpp" is core/body/element.hpp.
set(include_folders . core api)

set(names "")
foreach(entry IN LISTS rooms)
  string(REGEX MATCH "^([^:]*):(.*)$" _ "${entry}")
  set(name "${CMAKE_MATCH_1}")
  string(REPLACE " " ";" allowed "${CMAKE_MATCH_2}")
  list(APPEND names "${name}")
  string(MAKE_C_IDENTIFIER "${name}" id)
  set(allowed_${id} "${name};${allowed}")
endforeach()

# room_of(FILE OUT): the innermost room that holds a path.
function(room_of path out)
  set(best "")
  foreach(name IN LISTS names)
    string(LENGTH "${name}/" length)
    string(SUBSTRING "${path}////////////////" 0 ${length} head)
    if(head STREQUAL "${name}/")
      string(LENGTH "${best}" before)
      string(LENGTH "${name}" now)
      if(now GREATER before)
        set(best "${name}")
      endif()
    endif()
  endforeach()
  set(${out} "${best}" PARENT_SCOPE)
endfunction()

# header_path(HEADER BESIDE OUT): the header's path below ROOT; empty: it is none of ours. BESIDE is
# the folder of the file that includes it, empty for angle brackets: they do not look there.
function(header_path header beside out)
  set(found "")
  foreach(folder IN LISTS include_folders ITEMS ${beside})
    if(NOT found AND EXISTS "${ROOT}/${folder}/${header}")
      set(found "${folder}/${header}")
    endif()
  endforeach()
  string(REGEX REPLACE "^\\./" "" found "${found}")
  set(${out} "${found}" PARENT_SCOPE)
endfunction()

set(wrong "")
foreach(top core cpu_reference shaders gpu api app)
  file(GLOB_RECURSE files RELATIVE "${ROOT}" "${ROOT}/${top}/*.cpp" "${ROOT}/${top}/*.hpp"
    "${ROOT}/${top}/*.h")
  foreach(file IN LISTS files)
    room_of("${file}" room)
    string(MAKE_C_IDENTIFIER "${room}" id)
    if(room STREQUAL "")
      list(APPEND wrong "${file} lies in no room: name its folder in cmake/include_rule.cmake")
      continue()
    endif()
    file(STRINGS "${ROOT}/${file}" lines REGEX "^[ \t]*#[ \t]*include[ \t]*[\"<]")
    get_filename_component(folder "${file}" DIRECTORY)
    foreach(line IN LISTS lines)
      string(REGEX MATCH "[\"<]([^\">]*)" header "${line}")
      set(header "${CMAKE_MATCH_1}")
      set(beside "${folder}")
      if(line MATCHES "^[^\"]*<")
        set(beside "")
      endif()
      header_path("${header}" "${beside}" path)
      if(path STREQUAL "")
        continue()
      endif()
      room_of("${path}" target)
      if(NOT target IN_LIST allowed_${id})
        string(REPLACE ";" " " may "${allowed_${id}}")
        string(STRIP "${may}" may)
        list(APPEND wrong "${file} includes ${path} (${room} may include: ${may})")
      endif()
    endforeach()
  endforeach()
endforeach()

if(wrong)
  list(JOIN wrong "\n  " text)
  message(FATAL_ERROR "The include rule is broken:\n  ${text}")
endif()
if(STAMP)
  file(TOUCH "${STAMP}")
endif()
