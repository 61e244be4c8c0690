# Runs `agreement` and compares what it prints with agreement.txt beside this script.
#   PROGRAM            what to run; without it, COMPILER builds one for its processor in WORK
#   RUNNER             command in front of the program, a list; optional
cmake_minimum_required(VERSION 3.25)

# need(COMMAND): ends the script where it is not installed.
macro(need command)
  find_program(found_${command} ${command})
  if(NOT found_${command})
    message("skipped: ${command} is not installed; tools/install-deps --all has all but emscripten")
    return()
  endif()
endmacro()

if(RUNNER)
  list(GET RUNNER 0 runner)
  need(${runner})
endif()
if(NOT PROGRAM)
  need(${COMPILER})
  set(options -D CMAKE_CXX_COMPILER=${COMPILER})
  set(PROGRAM ${WORK}/agreement)
  if(COMPILER STREQUAL "em++")
    set(options -D CMAKE_TOOLCHAIN_FILE=/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
    set(PROGRAM ${WORK}/agreement.js)
    set(ENV{NODE_PATH} /usr/share/nodejs)  # where Debian has what emscripten needs of node's
  elseif(COMPILER MATCHES "^([^-]+)-linux")
    list(APPEND options -D CMAKE_SYSTEM_NAME=Linux -D CMAKE_SYSTEM_PROCESSOR=${CMAKE_MATCH_1})
  endif()
  if(LAUNCHER)
    list(APPEND options -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
  endif()
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK} -G ${GENERATOR}
                          -D CMAKE_BUILD_TYPE=Release -D EXPECTED=${EXPECTED} ${options}
                  COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK} COMMAND_ERROR_IS_FATAL ANY)
endif()

file(MAKE_DIRECTORY ${WORK})
file(GLOB frames ${SOURCE}/../golden/beam_*.frame)
execute_process(COMMAND ${RUNNER} ${PROGRAM} ${frames}
                OUTPUT_FILE ${WORK}/printed.txt COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${SOURCE}/agreement.txt ${WORK}/printed.txt
                RESULT_VARIABLE differ)
if(differ)
  execute_process(COMMAND diff -u ${SOURCE}/agreement.txt ${WORK}/printed.txt)
  message(FATAL_ERROR "Frames or clouds differ from tests/cross/agreement.txt. Where all processors "
    "print the same, the encoder has changed: copy ${WORK}/printed.txt there. Where one differs "
    "from the others, its arithmetic does.")
endif()
