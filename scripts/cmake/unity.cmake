# SPDX-License-Identifier: BSD-3-Clause
# PLUMBLINE_UNITY: sources of one target are compiled several at a time, so that Eigen, the standard
# library and JSON are read and instantiated once for all of them, behind precompiled headers. The
# scripts ask for it. It stays off where files are edited, and for clang-tidy's folder, in which every
# source has to bring its own includes.
#
# Files meet in one translation unit only if their anonymous namespaces have no name in common, and
# none that a header of the project declares for a type or a constant. Names are read off the lines
# that begin in the first column, as clang-format leaves them; aliases (`using`, `namespace fs =`) may
# repeat, for the compiler tells where two differ.
option(PLUMBLINE_UNITY "Compile several sources at a time" OFF)
set(PLUMBLINE_UNITY_SIZE 8 CACHE STRING "At most so many sources at a time")

# The names that `text` defines in its first column.
function(plumbline_names out text)
  string(REGEX REPLACE "\\[\\[[a-z_]+\\]\\] ?" "" text "${text}")
  string(REPLACE "[" " = " text "${text}")
  string(REPLACE "]" "" text "${text}")
  string(REPLACE ";" "=" text "${text}")
  string(REGEX REPLACE "\n(using|namespace) [^\n]*" "\n" text "${text}")
  string(REGEX MATCHALL "\n[A-Za-z][^\n({=]*[ &*>][A-Za-z_][A-Za-z0-9_]* ?[({=]" lines "${text}")
  set(names "")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE ".*[ &*>]([A-Za-z_][A-Za-z0-9_]*) ?[({=]$" "\\1" name "${line}")
    list(APPEND names ${name})
  endforeach()
  list(REMOVE_DUPLICATES names)
  set(${out} "${names}" PARENT_SCOPE)
endfunction()

# Names of types and constants in the project's headers.
function(plumbline_header_names out)
  file(GLOB_RECURSE headers ${PROJECT_SOURCE_DIR}/calibrator/*.h ${PROJECT_SOURCE_DIR}/datasets/*.h
       ${PROJECT_SOURCE_DIR}/evaluate/*.h ${PROJECT_SOURCE_DIR}/report/*.h)
  set(all "")
  foreach(header IN LISTS headers)
    file(READ ${header} text)
    plumbline_names(names "${text}")
    list(APPEND all ${names})
  endforeach()
  list(FILTER all INCLUDE REGEX "^(k?[A-Z])")
  list(REMOVE_DUPLICATES all)
  set(${out} "${all}" PARENT_SCOPE)
endfunction()

# The names in the anonymous namespace of a source.
function(plumbline_anonymous_names out file)
  file(READ ${file} text)
  string(FIND "${text}" "\nnamespace {\n" begin)
  if(begin EQUAL -1)
    set(${out} "" PARENT_SCOPE)
    return()
  endif()
  string(SUBSTRING "${text}" ${begin} -1 text)
  string(FIND "${text}" "\n}  // namespace\n" end)
  string(SUBSTRING "${text}" 0 ${end} text)
  plumbline_names(names "${text}")
  set(${out} "${names}" PARENT_SCOPE)
endfunction()

# Whether two lists share an element.
function(plumbline_share out first second)
  set(${out} OFF PARENT_SCOPE)
  foreach(name IN LISTS ${first})
    if(name IN_LIST ${second})
      set(${out} ON PARENT_SCOPE)
      return()
    endif()
  endforeach()
endfunction()

# Each source goes into the first group with room and without a name of its own.
function(plumbline_unite target)
  if(NOT PLUMBLINE_UNITY)
    return()
  endif()
  get_property(header_names GLOBAL PROPERTY PLUMBLINE_HEADER_NAMES)
  if(NOT header_names)
    plumbline_header_names(header_names)
    set_property(GLOBAL PROPERTY PLUMBLINE_HEADER_NAMES "${header_names}")
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # g++ takes the sources, which are included here, for headers.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  set(count 0)
  foreach(source IN LISTS ARGN)
    set(names "")
    get_filename_component(path ${source} ABSOLUTE)
    if(EXISTS ${path})  # else made by the build
      plumbline_anonymous_names(names ${path})
    endif()
    plumbline_share(alone names header_names)
    set(group 0)
    while(NOT alone)
      if(group EQUAL count)
        math(EXPR count "${count} + 1")
        set(size_${group} 0)
        set(names_${group} "")
      endif()
      plumbline_share(clash names names_${group})
      if(NOT clash AND size_${group} LESS PLUMBLINE_UNITY_SIZE)
        math(EXPR size_${group} "${size_${group}} + 1")
        list(APPEND names_${group} ${names})
        set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
        break()
      endif()
      math(EXPR group "${group} + 1")
    endwhile()
  endforeach()
endfunction()

# The headers given, compiled once as the target `name` for all that include them with its flags.
# PRIVATE names what they need to be found.
function(plumbline_headers name)
  cmake_parse_arguments(ARG "" "" "HEADERS;PRIVATE;OPTIONS" ${ARGN})
  set(source ${PROJECT_BINARY_DIR}/${name}.cpp)
  file(TOUCH ${source})
  add_library(${name} OBJECT ${source})
  target_link_libraries(${name} PRIVATE plumbline_flags ${ARG_PRIVATE})
  target_compile_options(${name} PRIVATE ${ARG_OPTIONS})
  target_precompile_headers(${name} PRIVATE ${ARG_HEADERS})
endfunction()

# The project's own headers here are those that most sources include and that seldom change.
set(PLUMBLINE_BASE ${PROJECT_SOURCE_DIR}/calibrator/base)
set(PLUMBLINE_COMMON_HEADERS
    <algorithm> <cmath> <functional> <map> <memory> <numbers> <optional> <span> <string> <variant>
    <vector> <Eigen/Cholesky> <Eigen/Core> <Eigen/Geometry> <Eigen/LU>
    ${PLUMBLINE_BASE}/calibration.h ${PLUMBLINE_BASE}/error.h ${PLUMBLINE_BASE}/lie.h
    ${PLUMBLINE_BASE}/results.h)

# Libraries share two sets: below calibrator/ (which the sanitizer build optimises), and above it.
# Under clang++ only: g++ 12 gains little, and warns of the standard library once it is precompiled.
function(plumbline_precompile_library target)
  if(NOT PLUMBLINE_UNITY OR NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    return()
  endif()
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  if(folder MATCHES "^calibrator")
    set(headers plumbline_calibrator_headers)
    if(NOT TARGET ${headers})
      plumbline_headers(${headers} HEADERS ${PLUMBLINE_COMMON_HEADERS})
    endif()
  else()
    set(headers plumbline_evaluation_headers)
    if(NOT TARGET ${headers})
      find_package(nlohmann_json REQUIRED)
      plumbline_headers(${headers} PRIVATE fmt::fmt nlohmann_json::nlohmann_json
        HEADERS ${PLUMBLINE_COMMON_HEADERS} <filesystem> <fstream> <sstream> <fmt/format.h>
                <nlohmann/json.hpp> ${PROJECT_SOURCE_DIR}/report/records/calibration_record.h)
    endif()
    target_link_libraries(${target} PRIVATE fmt::fmt)
  endif()
  target_precompile_headers(${target} REUSE_FROM ${headers})
endfunction()

function(plumbline_precompile_test target)
  if(NOT PLUMBLINE_UNITY)
    return()
  endif()
  if(NOT TARGET plumbline_test_headers)
    plumbline_headers(plumbline_test_headers PRIVATE ${ARGN} OPTIONS ${PLUMBLINE_TEST_OPTIONS}
      HEADERS ${PLUMBLINE_COMMON_HEADERS} <filesystem> <random> <sstream> <tuple> <fmt/format.h>
              <gmock/gmock.h> <gtest/gtest.h>)
  endif()
  target_precompile_headers(${target} REUSE_FROM plumbline_test_headers)
endfunction()
