# The source tree inside another project.
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
build(${SOURCE}/examples/add_subdirectory ${WORK}/add_subdirectory -D SWEEPCAST_SOURCE=${SOURCE})
run(${WORK}/add_subdirectory/columns)
