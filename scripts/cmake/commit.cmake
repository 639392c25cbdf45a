# SPDX-License-Identifier: BSD-3-Clause
# Run by `cmake -P` with INPUT and OUTPUT: writes INPUT with the commit that is checked out, if that is another
# than OUTPUT has.
get_filename_component(folder ${INPUT} DIRECTORY)
execute_process(COMMAND git -C ${folder} rev-parse --short=12 HEAD OUTPUT_VARIABLE commit
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit unknown)
endif()
configure_file(${INPUT} ${OUTPUT} @ONLY)
