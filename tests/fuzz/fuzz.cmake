# SPDX-License-Identifier: BSD-3-Clause
# Fuzzers: one program for each parser that reads files, in the sanitizers' build under clang++
# (docs/fuzzing.md). Everywhere else the parsers run on their seeds and on what once made them fail.
set(PLUMBLINE_PARSERS
    # a recording
    corners imu_samples image_list target sensor imu_yaml suggestions study corner_cache png jpeg
    bag_message mcap
    # calibrations
    camchain kalibr_results kalibr_poses yac basalt ours
    # trajectories
    trajectory_tum trajectory_euroc trajectory_kitti trajectory_motive trajectory_vicon
    # records
    document store)
list(TRANSFORM PLUMBLINE_PARSERS REPLACE "(.+)" "PLUMBLINE_PARSER(\\1)\n" OUTPUT_VARIABLE parsers)
list(JOIN parsers "" parsers)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/include/generated/fuzz/parser_list.inc CONTENT "${parsers}" @ONLY)

if(NOT PLUMBLINE_SANITIZE)  # only seeds and regressions: compiling takes longer
  set(plain PLAIN)
endif()
plumbline_tests(fuzz ${plain} LIBRARY LIBRARIES calibrator datasets store)
target_sources(plumbline_fuzz_test_helpers PRIVATE
               report/synthetic_record.cpp report/synthetic_replay.cpp
               report/synthetic_replay_judgements.cpp report/synthetic_replay_rig.cpp)

if(PLUMBLINE_READER_OPTIONS)
  add_executable(write_seeds fuzz/programs/write_seeds.cpp)
  target_link_libraries(write_seeds PRIVATE plumbline_fuzz_test_helpers)
  add_custom_target(fuzzers DEPENDS write_seeds)
  foreach(parser IN LISTS PLUMBLINE_PARSERS)
    configure_file(fuzz/programs/target.cpp.in fuzz_${parser}.cpp @ONLY)
    add_executable(fuzz_${parser} ${CMAKE_CURRENT_BINARY_DIR}/fuzz_${parser}.cpp)
    target_link_libraries(fuzz_${parser} PRIVATE plumbline_fuzz_test_helpers)
    target_link_options(fuzz_${parser} PRIVATE -fsanitize=fuzzer)
    set_target_properties(fuzz_${parser} PROPERTIES
                          RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/fuzzers)
    add_dependencies(fuzzers fuzz_${parser})
  endforeach()
endif()
