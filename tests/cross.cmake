# The same frames and clouds on every processor: `agreement` prints their checksums.
if(SWEEPCAST_SANITIZE)
  return()
endif()

add_executable(agreement cross/agreement.cpp)
target_link_libraries(agreement PRIVATE sweepcast)
target_include_directories(agreement PRIVATE ${PROJECT_SOURCE_DIR}/tests)
sweepcast_target(agreement)

# cross_test(NAME ARGUMENTS...): tests/cross/agreement.cmake; what is absent is skipped, aloud.
find_path(SWEEPCAST_EXPECTED_FOLDER tl/expected.hpp REQUIRED)
function(cross_test name)
  add_test(NAME cross_${name} COMMAND ${CMAKE_COMMAND}
    -D SOURCE=${CMAKE_CURRENT_SOURCE_DIR}/cross -D WORK=${CMAKE_CURRENT_BINARY_DIR}/cross/${name}
    -D EXPECTED=${SWEEPCAST_EXPECTED_FOLDER} -D GENERATOR=${CMAKE_GENERATOR}
    -D LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER} ${ARGN}
    -P ${CMAKE_CURRENT_SOURCE_DIR}/cross/agreement.cmake)
  set_tests_properties(cross_${name} PROPERTIES
    TIMEOUT 1200 COST 100 SKIP_REGULAR_EXPRESSION "^skipped: ")
endfunction()

cross_test(here -D PROGRAM=$<TARGET_FILE:agreement>)
# A processor without AVX2.
if(CMAKE_SYSTEM_PROCESSOR STREQUAL x86_64)
  cross_test(x86_plain -D PROGRAM=$<TARGET_FILE:agreement>
    "-DRUNNER=qemu-x86_64-static\\;-cpu\\;core2duo")
endif()
cross_test(arm64 -D COMPILER=aarch64-linux-gnu-g++ -D RUNNER=qemu-aarch64-static)
cross_test(wasm -D COMPILER=em++ -D RUNNER=node)
