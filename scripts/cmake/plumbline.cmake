# SPDX-License-Identifier: BSD-3-Clause
# The functions with which every folder declares its library, and what is precompiled.

# Where CMAKE_UNITY_BUILD is ON, as in the scripts that build everything, the sources of several rooms, or of a room
# that is not named here (calibrator/batch and all below it; of report each folder, for pages have parts of the same
# name), are compiled as one, and those of their tests likewise: headers and templates are read once, which takes 13
# to 22 % less time than room by room. Names in anonymous namespaces are therefore unique among them. Whoever edits
# configures without it.
set(PLUMBLINE_TOGETHER
    "calibrator/(base|guidance|initialise|odometry|simulate)"
    "calibrator/(camera|dense|fields|information|linear|residuals|target|window)"
    "datasets/[a-z]+"
    "evaluate/(calibration|lint|process|results|session|statistics|studies)"
    "evaluate/(compare|odometry|trajectory)"
    "evaluate/(replay|simulation)")

function(plumbline_unity target)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source)
    cmake_path(IS_PREFIX PROJECT_BINARY_DIR ${source} is_generated)
    if(NOT is_generated)
      cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE folder)
      cmake_path(GET folder PARENT_PATH folder)
      string(REGEX REPLACE "^((tests/)?(calibrator|datasets|evaluate)/[^/]+)/.*" "\\1" room ${folder})
      foreach(rooms IN LISTS PLUMBLINE_TOGETHER)
        if(room MATCHES "^(tests/)?${rooms}$")
          set(room "${CMAKE_MATCH_1}${rooms}")
        endif()
      endforeach()
      string(MAKE_C_IDENTIFIER "in_${room}" group)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
endfunction()

# plumbline_library(NAME [EXCLUDE regex] [KERNELS folder ...] [SOURCES generated.cpp ...] [DEPENDS target ...])
# A static library `plumbline_NAME` of every source below the current folder, with the project's flags.
# Headers are included from the root of the repository: #include "calibrator/base/time.h".
# KERNELS: folders optimised further than all else. CMake makes unity sources of what shares its options only: they
# are compiled as a target of their own, `plumbline_NAME_kernels`. Its objects stand first in the library: of an
# inline function in both the linker keeps the first.
function(plumbline_library name)
  cmake_parse_arguments(ARG "" "EXCLUDE" "KERNELS;SOURCES;DEPENDS" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.cpp)
  if(ARG_EXCLUDE)
    list(FILTER sources EXCLUDE REGEX ${ARG_EXCLUDE})
  endif()
  if(ARG_KERNELS)
    list(JOIN ARG_KERNELS "|" folders)
    set(kernels ${sources})
    list(FILTER kernels INCLUDE REGEX "^(${folders})/")
    list(REMOVE_ITEM sources ${kernels})
    add_library(plumbline_${name}_kernels OBJECT ${kernels})
    plumbline_unity(plumbline_${name}_kernels)
    target_link_libraries(plumbline_${name}_kernels PUBLIC plumbline_flags ${ARG_DEPENDS})
    plumbline_precompile_library(plumbline_${name}_kernels)
    list(PREPEND ARG_SOURCES $<TARGET_OBJECTS:plumbline_${name}_kernels>)
  endif()
  add_library(plumbline_${name} STATIC ${sources} ${ARG_SOURCES})
  plumbline_unity(plumbline_${name})
  target_link_libraries(plumbline_${name} PUBLIC plumbline_flags ${ARG_DEPENDS})
  if(NOT name STREQUAL "calibrator")
    target_compile_options(plumbline_${name} PRIVATE ${PLUMBLINE_READER_OPTIONS})
  endif()
  target_compile_options(plumbline_${name} PRIVATE ${PLUMBLINE_PLAIN_OPTIONS})
  plumbline_precompile_library(plumbline_${name})
endfunction()

# Precompiled headers, so that Eigen, the standard library and JSON are read once. Under clang++ only:
# g++ 12 gains little, and warns of the standard library once it is precompiled.
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  option(PLUMBLINE_PRECOMPILE "Precompile the headers that most sources include" ON)
endif()

# The headers given, compiled once as the target `name` for all that include them with its flags.
# PRIVATE names what they need to be found.
function(plumbline_headers name)
  cmake_parse_arguments(ARG "UNSANITIZED" "" "HEADERS;PRIVATE;OPTIONS" ${ARGN})
  set(source ${PROJECT_BINARY_DIR}/${name}.cpp)
  file(TOUCH ${source})
  add_library(${name} OBJECT ${source})
  target_link_libraries(${name} PRIVATE plumbline_flags ${ARG_PRIVATE})
  target_compile_options(${name} PRIVATE ${ARG_OPTIONS})
  # The time of a header is not part of what is precompiled, so that a new clone finds what ccache keeps.
  target_compile_options(${name} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  set_target_properties(${name} PROPERTIES PLUMBLINE_UNSANITIZED ${ARG_UNSANITIZED})
  target_precompile_headers(${name} PRIVATE ${ARG_HEADERS})
endfunction()

# The project's own headers here are those that most sources include and that seldom change.
set(PLUMBLINE_BASE ${PROJECT_SOURCE_DIR}/calibrator/base)
set(PLUMBLINE_COMMON_HEADERS
    <algorithm> <cmath> <functional> <map> <memory> <numbers> <optional> <random> <span> <string> <variant>
    <vector> <Eigen/Cholesky> <Eigen/Core> <Eigen/Geometry> <Eigen/LU>
    ${PLUMBLINE_BASE}/calibration.h ${PLUMBLINE_BASE}/error.h
    ${PLUMBLINE_BASE}/results.h)

# Libraries and the tests' helpers share two sets: calibrator's (which the sanitizer build optimises), and that above
# it, whose branches are counted there. clang++ shares a set between what is optimised, no matter how far.
function(plumbline_precompile_library target)
  if(NOT PLUMBLINE_PRECOMPILE)
    return()
  endif()
  get_target_property(options ${target} COMPILE_OPTIONS)
  if(target MATCHES "^plumbline_calibrator(_kernels)?$" OR (PLUMBLINE_READER_OPTIONS AND NOT "${options}" MATCHES "fuzzer-no-link"))
    set(headers plumbline_calibrator_headers)
    if(NOT TARGET ${headers})
      plumbline_headers(${headers} HEADERS ${PLUMBLINE_COMMON_HEADERS}
                        OPTIONS $<$<BOOL:${PLUMBLINE_SANITIZE}>:-O1>)
    endif()
  else()
    set(headers plumbline_evaluation_headers)
    if(NOT TARGET ${headers})
      find_package(nlohmann_json REQUIRED)
      plumbline_headers(${headers} PRIVATE fmt::fmt nlohmann_json::nlohmann_json
        OPTIONS ${PLUMBLINE_READER_OPTIONS}
        HEADERS ${PLUMBLINE_COMMON_HEADERS} <filesystem> <fstream> <sstream> <fmt/format.h>
                <nlohmann/json.hpp> ${PROJECT_SOURCE_DIR}/report/records/calibration_record.h)
    endif()
    target_link_libraries(${target} PRIVATE fmt::fmt)
  endif()
  target_precompile_headers(${target} REUSE_FROM ${headers})
endfunction()

function(plumbline_precompile_test target)
  if(NOT PLUMBLINE_PRECOMPILE)
    return()
  endif()
  if(NOT TARGET plumbline_test_headers)
    plumbline_headers(plumbline_test_headers UNSANITIZED PRIVATE fmt::fmt GTest::gmock OPTIONS ${PLUMBLINE_TEST_OPTIONS}
      HEADERS ${PLUMBLINE_COMMON_HEADERS} <filesystem> <sstream> <tuple> <fmt/format.h>
              <gmock/gmock.h> <gtest/gtest.h>)
  endif()
  target_precompile_headers(${target} REUSE_FROM plumbline_test_headers)
endfunction()

# What is measured and shipped is compiled with -O2; the tests' own code need not be, but where it is itself
# what computes. At -O1 g++ 12 says of sound copies of strings and matrices that they overlap, overrun or read
# what was never written.
set(PLUMBLINE_TEST_OPTIONS $<$<CONFIG:Release>:-O0>)
set(PLUMBLINE_OPTIMISED_TEST_OPTIONS -O1)
foreach(warning array-bounds maybe-uninitialized restrict stringop-overflow stringop-overread)
  list(APPEND PLUMBLINE_OPTIMISED_TEST_OPTIONS $<$<CXX_COMPILER_ID:GNU>:-Wno-${warning}>)
endforeach()

# plumbline_module_build(NAME header...)
# What a program and a module that it loads must have in common, as k<Name>Build in generated/NAME_build.h: the
# version and what both were compiled by, the headers that they share among it.
function(plumbline_module_build name)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${ARGN})
  foreach(header IN LISTS ARGN)
    file(SHA256 ${header} hash)
    string(APPEND hashes ${hash})
  endforeach()
  string(SHA256 hash "${CMAKE_CXX_COMPILER_ID} ${PLUMBLINE_SANITIZE} ${hashes}")
  string(SUBSTRING ${hash} 0 12 hash)
  string(SUBSTRING ${name} 0 1 initial)
  string(SUBSTRING ${name} 1 -1 rest)
  string(TOUPPER ${initial} initial)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/include/generated/${name}_build.h @ONLY CONTENT
       "#pragma once\nnamespace plumbline::internal {\ninline constexpr const char* k${initial}${rest}Build = \"${PROJECT_VERSION} (${name} ${hash})\";\n}\n")
endfunction()
