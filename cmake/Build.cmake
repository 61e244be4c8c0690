# What every target is built with.

add_library(sweepcast_build INTERFACE)
target_compile_options(sweepcast_build INTERFACE
  -Wall -Wextra -Wconversion -Wshadow $<$<BOOL:${SWEEPCAST_WERROR}>:-Werror>
  # g++ 12 sees overlaps in std::string's operator+ that are not there (its bug 105651).
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>
  # Of a class in a .cpp that one file includes with others, g++ thinks it is in a header.
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${CMAKE_UNITY_BUILD}>>:-Wno-subobject-linkage>
  # g++ is told of loops whose stores miss their loads; clang sees that by itself.
  $<$<CXX_COMPILER_ID:Clang>:-Wno-unknown-pragmas>
  # Clouds must be the same on every machine: no fused multiply-add behind the source's back.
  -ffp-contract=off
  # Nobody reads errno or floating-point traps; without them square roots and choices vectorise.
  -fno-math-errno -fno-trapping-math)
if(SWEEPCAST_SANITIZE)
  target_compile_options(sweepcast_build INTERFACE
    -fsanitize=${SWEEPCAST_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(sweepcast_build INTERFACE -fsanitize=${SWEEPCAST_SANITIZE})
endif()
if(SWEEPCAST_FUZZ)
  # The fuzzer must see which way its input takes through the libraries, not only the target.
  target_compile_options(sweepcast_build INTERFACE -fsanitize=fuzzer-no-link)
  target_compile_definitions(sweepcast_build INTERFACE _GLIBCXX_ASSERTIONS)
endif()

# sweepcast_target(NAME): the settings above, and src/ as the root of internal includes.
function(sweepcast_target name)
  target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:sweepcast_build>)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/src)
endfunction()

# sweepcast_commands(NAME): in optimised builds the files of a program that includes CLI11 and JSON
# everywhere are compiled a few at a time, since those headers take longer than the files. Their
# unnamed namespaces then meet. Debug builds keep files apart: one that changes is built alone.
function(sweepcast_commands name)
  if(NOT CMAKE_BUILD_TYPE STREQUAL Debug)
    set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 7)
  endif()
endfunction()
