# A robot and a server against the installed tree, one sending to the other.
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
build(${SOURCE}/examples/link ${WORK}/link -D CMAKE_PREFIX_PATH=${PREFIX})
string(RANDOM LENGTH 4 ALPHABET 012345 digits)
set(port 4${digits})
run(${PREFIX}/bin/sweepcast keygen ${WORK}/link/key --robot rover)
# Both at once; the server ends when three sweeps have come.
run(${WORK}/link/server ${port} ${WORK}/link/key 3
    COMMAND ${WORK}/link/robot 127.0.0.1 ${port} ${WORK}/link/key 60)
