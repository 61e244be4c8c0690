# The source tree inside another project, its libraries shared; shared.cmake goes on with them.
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
build(${SOURCE}/examples/add_subdirectory ${WORK}/add_subdirectory -D SWEEPCAST_SOURCE=${SOURCE}
      -D BUILD_SHARED_LIBS=ON -D SWEEPCAST_INSTALL=ON -D CMAKE_INSTALL_LIBDIR=lib
      -D CMAKE_UNITY_BUILD=ON)
run(${WORK}/add_subdirectory/columns)
