# SPDX-License-Identifier: BSD-3-Clause
# The functions with which every folder declares its library and its tests.
include(${CMAKE_CURRENT_LIST_DIR}/unity.cmake)

# plumbline_library(NAME SOURCES a.cpp ... [DEPENDS target ...])
# A static library `plumbline_NAME` with the project's flags. Headers are included from the root of
# the repository: #include "calibrator/base/time.h".
function(plumbline_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  if(ARG_SOURCES)
    add_library(plumbline_${name} STATIC ${ARG_SOURCES})
    plumbline_unite(plumbline_${name} ${ARG_SOURCES})
    target_link_libraries(plumbline_${name} PUBLIC plumbline_flags ${ARG_DEPENDS})
  else()
    add_library(plumbline_${name} INTERFACE)
    target_link_libraries(plumbline_${name} INTERFACE plumbline_flags ${ARG_DEPENDS})
  endif()
endfunction()

# plumbline_test(NAME SOURCES a_test.cpp ... DEPENDS target ... [LABELS label ...])
# One GoogleTest program; label `unit` unless others are given. Tests under the label `real-data`
# read PLUMBLINE_SHARED_DATA (a path, as a C++ string literal) and fail loudly without it.
function(plumbline_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;LABELS" ${ARGN})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE plumbline_flags ${ARG_DEPENDS} GTest::gmock GTest::gtest
                                        GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE
    PLUMBLINE_SHARED_DATA="${PLUMBLINE_SHARED_DATA}"
    PLUMBLINE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  add_test(NAME ${name} COMMAND ${name})
  if("unit" IN_LIST ARG_LABELS)
    add_dependencies(plumbline_unit_tests ${name})
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT 900)
endfunction()

# plumbline_cli_test(NAME SOURCES a_test.cpp ... [DEPENDS target ...] [LABELS label ...])
# A plumbline_test() that runs the program, whose path it knows as PLUMBLINE_BINARY (a C++ string
# literal); label `cli` unless others are given: the program is not rebuilt for the sanitizers.
function(plumbline_cli_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;LABELS" ${ARGN})
  if(NOT ARG_LABELS)
    set(ARG_LABELS cli)
  endif()
  plumbline_test(${name} SOURCES ${ARG_SOURCES} LABELS ${ARG_LABELS}
                 DEPENDS plumbline_base nlohmann_json::nlohmann_json ${ARG_DEPENDS})
  target_compile_definitions(${name} PRIVATE PLUMBLINE_BINARY="$<TARGET_FILE:plumbline>")
  add_dependencies(${name} plumbline)
endfunction()
