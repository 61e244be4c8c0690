# What this build can have. A part whose library is absent is turned off, aloud;
# `sweepcast --version` lists the outcome.

# Seen from the parent project too, where this one is a subdirectory.
set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)

find_package(PkgConfig REQUIRED)
find_package(tl-expected REQUIRED)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET GLOBAL libzstd)
find_package(liblzf REQUIRED)  # PCD's binary_compressed

set(SWEEPCAST_COMPONENTS "")

# sweepcast_component(NAME FOUND PACKAGE WHAT): sets SWEEPCAST_WITH_<NAME> and says what is missing.
function(sweepcast_component name found package what)
  string(TOUPPER ${name} upper)
  if(found)
    set(SWEEPCAST_WITH_${upper} ON PARENT_SCOPE)
    set(SWEEPCAST_COMPONENTS "${SWEEPCAST_COMPONENTS}+${name} " PARENT_SCOPE)
    message(STATUS "${name}: on")
  else()
    set(SWEEPCAST_WITH_${upper} OFF PARENT_SCOPE)
    set(SWEEPCAST_COMPONENTS "${SWEEPCAST_COMPONENTS}-${name} " PARENT_SCOPE)
    message(STATUS "${name}: OFF, ${what} is left out. To have it: apt-get install ${package}")
  endif()
endfunction()

pkg_check_modules(srt QUIET IMPORTED_TARGET GLOBAL srt>=1.5)
pkg_check_modules(libsodium QUIET IMPORTED_TARGET GLOBAL libsodium)
if(srt_FOUND AND libsodium_FOUND)
  set(link_found ON)
endif()
sweepcast_component(link "${link_found}" "libsrt-openssl-dev libsodium-dev" "the live link")
if(SWEEPCAST_APPS)
  find_package(prometheus-cpp QUIET COMPONENTS pull)
  sweepcast_component(metrics "${prometheus-cpp_FOUND}" prometheus-cpp-dev "--metrics")
endif()

if(SWEEPCAST_APPS OR SWEEPCAST_TESTS)
  find_package(CLI11 REQUIRED)
  find_package(fmt REQUIRED)
  find_package(nlohmann_json REQUIRED)
  find_package(nanoflann REQUIRED)
  find_package(Eigen3 REQUIRED)
  find_package(embree 3 QUIET)
  sweepcast_component(embree "${embree_FOUND}" libembree-dev "the simulator")
  find_package(draco QUIET)
  sweepcast_component(draco "${draco_FOUND}" libdraco-dev "the comparison with Draco")
endif()

if(SWEEPCAST_TESTS)
  find_package(GTest QUIET)
  if(NOT GTest_FOUND)
    set(SWEEPCAST_TESTS OFF)
    message(STATUS "tests: OFF. To have them: apt-get install libgtest-dev")
  endif()
endif()
if(SWEEPCAST_BENCH)
  find_package(benchmark QUIET)
  if(NOT benchmark_FOUND)
    set(SWEEPCAST_BENCH OFF)
    message(STATUS "benchmarks: OFF. To have them: apt-get install libbenchmark-dev")
  endif()
endif()
