# Finds OpenVDB and makes the target sweepcast::openvdb of it. Its own find module ends the
# configuration where a library that only other programs need is absent.
find_path(OPENVDB_INCLUDE_DIR openvdb/openvdb.h)
find_path(OPENVDB_BOOST_INCLUDE_DIR boost/numeric/conversion/conversion_traits.hpp)
find_library(OPENVDB_LIBRARY openvdb)
find_package(TBB QUIET)
find_package(Imath QUIET)
mark_as_advanced(OPENVDB_INCLUDE_DIR OPENVDB_BOOST_INCLUDE_DIR OPENVDB_LIBRARY)

set(openvdb_FOUND OFF)
if(OPENVDB_INCLUDE_DIR AND OPENVDB_BOOST_INCLUDE_DIR AND OPENVDB_LIBRARY AND TARGET TBB::tbb
   AND TARGET Imath::Imath)
  set(openvdb_FOUND ON)
  add_library(sweepcast::openvdb UNKNOWN IMPORTED GLOBAL)
  set_target_properties(sweepcast::openvdb PROPERTIES IMPORTED_LOCATION "${OPENVDB_LIBRARY}")
  target_include_directories(sweepcast::openvdb SYSTEM INTERFACE
    "${OPENVDB_INCLUDE_DIR}" "${OPENVDB_BOOST_INCLUDE_DIR}")
  target_link_libraries(sweepcast::openvdb INTERFACE TBB::tbb Imath::Imath)
endif()
