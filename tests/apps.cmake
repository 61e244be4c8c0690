# The tools, run as a user runs them.
if(SWEEPCAST_APPS)
  add_library(tool_fixture STATIC apps/tool_fixture.cpp)
  target_link_libraries(tool_fixture PUBLIC nlohmann_json::nlohmann_json GTest::gtest)
  target_include_directories(tool_fixture PUBLIC ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(tool_fixture PRIVATE SWEEPCAST_TOOL="$<TARGET_FILE:sweepcast_tool>")
  target_compile_definitions(tool_fixture PUBLIC SWEEPCAST_VERSION="${PROJECT_VERSION}")
  add_dependencies(tool_fixture sweepcast_tool sweepcast_lab_tool)
  sweepcast_target(tool_fixture)

  sweepcast_test(apps/commands tool_fixture)
  sweepcast_test(apps/errors tool_fixture sweepcast_io)
  sweepcast_test(apps/interruption tool_fixture)
endif()
