# The examples, built and run against an installed tree (and one against the source tree).
# A sanitized library would need sanitized consumers, so those builds have no such test.
if(SWEEPCAST_SANITIZE)
  return()
endif()

# install_test(NAME): tests/install/NAME.cmake, in a fresh folder.
function(install_test name)
  add_test(NAME install_${name} COMMAND ${CMAKE_COMMAND}
    -D SOURCE=${PROJECT_SOURCE_DIR} -D BUILD=${PROJECT_BINARY_DIR}
    -D WORK=${CMAKE_CURRENT_BINARY_DIR}/install -D CXX=${CMAKE_CXX_COMPILER}
    -D GENERATOR=${CMAKE_GENERATOR} -D LINK=${SWEEPCAST_WITH_LINK} -D LIBDIR=${CMAKE_INSTALL_LIBDIR}
    -P ${CMAKE_CURRENT_SOURCE_DIR}/install/${name}.cmake)
  set_tests_properties(install_${name} PROPERTIES TIMEOUT 600)
endfunction()

install_test(tree)
set_tests_properties(install_tree PROPERTIES FIXTURES_SETUP installed)
set(consumers cmake pkg_config)
if(SWEEPCAST_WITH_LINK AND SWEEPCAST_APPS)
  list(APPEND consumers link)
endif()
foreach(name IN LISTS consumers)
  install_test(${name})
  set_tests_properties(install_${name} PROPERTIES FIXTURES_REQUIRED installed)
endforeach()
install_test(add_subdirectory)
install_test(shared)
set_tests_properties(install_add_subdirectory PROPERTIES FIXTURES_SETUP subdirectory COST 100)
set_tests_properties(install_shared PROPERTIES FIXTURES_REQUIRED subdirectory)
