# Tests of the viewer's server.
sweepcast_test(view/access sweepcast_view)
sweepcast_test(view/foxglove sweepcast_view nlohmann_json::nlohmann_json)
sweepcast_test(view/hub sweepcast_view nlohmann_json::nlohmann_json)
sweepcast_test(view/page_client sweepcast_view nlohmann_json::nlohmann_json)
sweepcast_test(view/recording sweepcast_view)
sweepcast_test(view/assets)
sweepcast_assets(${CMAKE_CURRENT_SOURCE_DIR}/view/page ${CMAKE_CURRENT_BINARY_DIR}/page.cpp)
target_sources(view_assets_test PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/page.cpp)
target_compile_definitions(view_assets_test PRIVATE
  SWEEPCAST_PAGE="${CMAKE_CURRENT_SOURCE_DIR}/view/page")
if(SWEEPCAST_WITH_VIEW)
  sweepcast_test(view/server sweepcast_view nlohmann_json::nlohmann_json Boost::headers)
  target_sources(view_server_test PRIVATE view/web_client.cpp)
  if(SWEEPCAST_APPS)
    sweepcast_test(apps/view tool_fixture Boost::headers)
    target_sources(apps_view_test PRIVATE view/web_client.cpp)
    target_compile_definitions(apps_view_test PRIVATE
      SWEEPCAST_FOXGLOVE_TEST="${CMAKE_CURRENT_SOURCE_DIR}/view/foxglove")
  endif()
endif()

# The page, in a browser.
if(SWEEPCAST_WITH_VIEW AND SWEEPCAST_APPS AND NOT SWEEPCAST_SANITIZE)
  add_test(NAME viewer_page COMMAND ${CMAKE_COMMAND} -E env SWEEPCAST=$<TARGET_FILE:sweepcast_tool>
    ${PROJECT_SOURCE_DIR}/viewer/tests/ctest)
  set_tests_properties(viewer_page PROPERTIES
    TIMEOUT 900 PROCESSORS 2 SKIP_RETURN_CODE 77)
endif()
