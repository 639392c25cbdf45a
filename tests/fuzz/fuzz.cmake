# SPDX-License-Identifier: BSD-3-Clause
# Fuzzers of each parser that reads files, in the sanitizers' build under clang++
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

plumbline_tests(fuzz PLAIN LIBRARY LIBRARIES calibrator datasets store)
target_sources(plumbline_fuzz_test_helpers PRIVATE
               report/synthetic_record.cpp report/synthetic_replay.cpp
               report/synthetic_replay_judgements.cpp report/synthetic_replay_rig.cpp)

if(PLUMBLINE_READER_OPTIONS)
  add_custom_target(fuzzers)
  foreach(program write_seeds fuzz_parser)
    add_executable(${program} fuzz/programs/${program}.cpp)
    set_target_properties(${program} PROPERTIES PLUMBLINE_UNSANITIZED ON)
    plumbline_link_whole(${program} calibrator datasets store)
    target_link_libraries(${program} PRIVATE plumbline_fuzz_test_helpers)
    add_dependencies(fuzzers ${program})
  endforeach()
  target_link_options(fuzz_parser PRIVATE -fsanitize=fuzzer)
endif()
