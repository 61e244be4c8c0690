# What this build can have. A part whose library is absent is turned off, aloud;
# `sweepcast --version` lists the outcome.

find_package(PkgConfig REQUIRED)
find_package(tl-expected REQUIRED)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)

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

find_package(embree 3 QUIET)
sweepcast_component(embree "${embree_FOUND}" libembree-dev "the simulator")
find_package(draco QUIET)
sweepcast_component(draco "${draco_FOUND}" libdraco-dev "the comparison with Draco")

if(SWEEPCAST_APPS)
  find_package(CLI11 REQUIRED)
  find_package(fmt REQUIRED)
  find_package(nlohmann_json REQUIRED)
endif()
if(SWEEPCAST_APPS OR SWEEPCAST_TESTS)
  find_package(nanoflann REQUIRED)
  find_package(Eigen3 REQUIRED)
endif()
find_package(liblzf REQUIRED)  # PCD's binary_compressed
