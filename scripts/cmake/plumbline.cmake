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
    plumbline_precompile_library(plumbline_${name})
  else()
    add_library(plumbline_${name} INTERFACE)
    target_link_libraries(plumbline_${name} INTERFACE plumbline_flags ${ARG_DEPENDS})
  endif()
endfunction()

# What is measured and shipped is compiled with -O2; the tests' own code need not be. Inline functions are
# theirs and the libraries' alike, and the linker keeps the test's: where a test runs a library a hundred
# times (label statistics), or is itself the one that computes (OPTIMISED), it is optimised too. At -O1
# g++ 12 says of sound copies of strings and matrices that they overlap, overrun or read what was never
# written.
set(PLUMBLINE_TEST_OPTIONS $<$<CONFIG:Release>:-O0>)
set(PLUMBLINE_OPTIMISED_TEST_OPTIONS -O1)
foreach(warning array-bounds maybe-uninitialized restrict stringop-overflow stringop-overread)
  list(APPEND PLUMBLINE_OPTIMISED_TEST_OPTIONS $<$<CXX_COMPILER_ID:GNU>:-Wno-${warning}>)
endforeach()

# plumbline_test(NAME [OPTIMISED] SOURCES a_test.cpp ... DEPENDS target ... [LABELS label ...])
# One GoogleTest program; label `unit` unless others are given. Tests under the label `real-data`
# read PLUMBLINE_SHARED_DATA (a path, as a C++ string literal) and fail loudly without it.
function(plumbline_test name)
  cmake_parse_arguments(ARG "OPTIMISED" "" "SOURCES;DEPENDS;LABELS" ${ARGN})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  plumbline_unite(${name} ${ARG_SOURCES})
  set(common plumbline_flags fmt::fmt GTest::gmock GTest::gtest)
  target_link_libraries(${name} PRIVATE ${common} ${ARG_DEPENDS} GTest::gtest_main)
  if(ARG_OPTIMISED OR "statistics" IN_LIST ARG_LABELS)
    target_compile_options(${name} PRIVATE ${PLUMBLINE_OPTIMISED_TEST_OPTIONS})
  else()
    plumbline_precompile_test(${name} ${common})
    target_compile_options(${name} PRIVATE ${PLUMBLINE_TEST_OPTIONS})
  endif()
  target_compile_definitions(${name} PRIVATE
    PLUMBLINE_SHARED_DATA="${PLUMBLINE_SHARED_DATA}"
    PLUMBLINE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  add_test(NAME ${name} COMMAND ${name})
  if("unit" IN_LIST ARG_LABELS)
    add_dependencies(plumbline_unit_tests ${name})
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT 900)
  list(GET ARG_LABELS 0 kind)
  if(PLUMBLINE_COST_${kind})
    set_tests_properties(${name} PROPERTIES COST ${PLUMBLINE_COST_${kind}})
  endif()
endfunction()

# Seconds that tests of a kind may well take: a ctest without history starts the long ones first.
set(PLUMBLINE_COST_statistics 20)
set(PLUMBLINE_COST_cli 10)
set(PLUMBLINE_COST_real-data 5)
set(PLUMBLINE_COST_vtk 3)

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
