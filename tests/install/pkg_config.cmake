# A Makefile and pkg-config against the installed tree.
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
file(REMOVE_RECURSE ${WORK}/pkg-config)
set(ENV{PKG_CONFIG_PATH} ${PREFIX}/${LIBDIR}/pkgconfig)
run(make -C ${SOURCE}/examples/pkg-config BUILD=${WORK}/pkg-config CXX=${CXX} run)
