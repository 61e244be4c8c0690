# find_package against the installed tree.
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
build(${SOURCE}/examples/cmake ${WORK}/cmake -D CMAKE_PREFIX_PATH=${PREFIX})
run(${WORK}/cmake/roundtrip)
run(${CMAKE_COMMAND} -E chdir ${WORK}/cmake ./recording)
