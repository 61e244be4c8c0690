# What `cmake --install` puts where. Three components, so that a robot may install little:
#   runtime      the tool `sweepcast`, and the libraries where they are shared
#   lab          `sweepcast-lab`, which needs heavy libraries, and its weights; `sweepcast` runs it
#   development  headers, static libraries, CMake package, pkg-config files

include(CMakePackageConfigHelpers)

# Before 1.0 every minor version may change the binary interface.
set(libraries sweepcast sweepcast_io)
if(SWEEPCAST_WITH_LINK)
  list(APPEND libraries sweepcast_link)
endif()
set_target_properties(${libraries} PROPERTIES
  VERSION ${PROJECT_VERSION}
  SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
  INSTALL_RPATH $ORIGIN)

install(TARGETS ${libraries} EXPORT sweepcast-targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT development
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/sweepcast
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development FILES_MATCHING PATTERN *.hpp)

set(cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/sweepcast)
get_target_property(library_type sweepcast TYPE)  # the config file asks: STATIC_LIBRARY?
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/sweepcast-config.cmake.in
  ${PROJECT_BINARY_DIR}/sweepcast-config.cmake INSTALL_DESTINATION ${cmake_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sweepcast-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(EXPORT sweepcast-targets NAMESPACE sweepcast:: DESTINATION ${cmake_dir}
  COMPONENT development)
install(FILES ${PROJECT_BINARY_DIR}/sweepcast-config.cmake
              ${PROJECT_BINARY_DIR}/sweepcast-config-version.cmake
  DESTINATION ${cmake_dir} COMPONENT development)

# The pkg-config files find their prefix from their own place, so the tree may be moved.
set(pc_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH pc_to_prefix /prefix/${pc_dir} /prefix)
foreach(name sweepcast sweepcast-io)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${pc_dir} COMPONENT development)
endforeach()

if(SWEEPCAST_APPS)
  # install_tool(TARGET FOLDER COMPONENT): it finds shared libraries wherever the tree lies.
  function(install_tool target folder component)
    file(RELATIVE_PATH to_lib /prefix/${folder} /prefix/${CMAKE_INSTALL_LIBDIR})
    set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN/${to_lib}")
    install(TARGETS ${target} DESTINATION ${folder} COMPONENT ${component})
  endfunction()
  install_tool(sweepcast_tool ${CMAKE_INSTALL_BINDIR} runtime)
  install_tool(sweepcast_lab_tool ${CMAKE_INSTALL_LIBEXECDIR}/sweepcast lab)
  install(FILES ${PROJECT_SOURCE_DIR}/models/pointpillars.weights
    DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/sweepcast COMPONENT lab)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
