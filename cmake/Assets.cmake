# sweepcast_assets(FOLDER OUTPUT): writes the source file OUTPUT, which defines `embedded_assets()` of
# src/view/assets.hpp: all files of a built page, their bytes put in by the assembler. No file has to
# be found when the program runs. Where FOLDER has no index.html, there are none.

function(sweepcast_asset_type path type)
  set(types
    .html=text/html .js=text/javascript .mjs=text/javascript .css=text/css .json=application/json
    .map=application/json .wasm=application/wasm .svg=image/svg+xml .png=image/png
    .ico=image/x-icon .woff2=font/woff2 .txt=text/plain)
  get_filename_component(extension ${path} LAST_EXT)
  set(found application/octet-stream)
  foreach(pair IN LISTS types)
    if(pair MATCHES "^(.*)=(.*)$" AND CMAKE_MATCH_1 STREQUAL extension)
      set(found ${CMAKE_MATCH_2})
    endif()
  endforeach()
  if(found MATCHES "^text/")
    string(APPEND found "; charset=utf-8")
  endif()
  set(${type} ${found} PARENT_SCOPE)
endfunction()

function(sweepcast_assets folder output)
  # The glob is looked at again with each build, so that a page that was built since is seen.
  file(GLOB_RECURSE files CONFIGURE_DEPENDS ${folder}/*)
  if(NOT EXISTS ${folder}/index.html)
    set(files "")
    message(STATUS "viewer: its page is not built. To have it: cd viewer && npm ci && npm run build")
  endif()
  set(bytes "")
  set(names "")
  set(table "")
  set(number 0)
  foreach(file IN LISTS files)
    file(RELATIVE_PATH path ${folder} ${file})
    if(NOT path MATCHES "^[A-Za-z0-9._/@-]+$")
      message(FATAL_ERROR "${file}: a page's file has a plain name; rename it")
    endif()
    sweepcast_asset_type(${path} type)
    set(name sweepcast_asset_${number})
    string(APPEND bytes "asm(\".section .rodata\\n${name}:\\n.incbin \\\"${file}\\\"\\n\"\n"
                        "    \"${name}_end:\\n.byte 0\\n.previous\");\n")
    string(APPEND names "extern const char ${name}[];\nextern const char ${name}_end[];\n")
    string(APPEND table "      {\"/${path}\", \"${type}\", bytes_of(${name}, ${name}_end)},\n")
    math(EXPR number "${number} + 1")
  endforeach()
  set(content "// Made by cmake/Assets.cmake.\n#include \"view/assets.hpp\"\n\n")
  if(files)
    string(APPEND content
      "#include <vector>\n\n${bytes}\n#pragma GCC visibility push(hidden)\nextern \"C\" {\n"
      "${names}}\n#pragma GCC visibility pop\n\nnamespace sweepcast::view {\n\n"
      "std::span<const Asset> embedded_assets() {\n"
      "  const auto bytes_of = [](const char* begin, const char* end) {\n"
      "    return std::string_view(begin, static_cast<std::size_t>(end - begin));\n  };\n"
      "  static const std::vector<Asset> assets{\n${table}  };\n  return assets;\n}\n")
  else()
    string(APPEND content
      "namespace sweepcast::view {\n\nstd::span<const Asset> embedded_assets() {\n"
      "  return {};\n}\n")
  endif()
  string(APPEND content "\n}  // namespace sweepcast::view\n")
  file(CONFIGURE OUTPUT ${output} CONTENT "${content}" @ONLY)
  set_source_files_properties(${output} PROPERTIES OBJECT_DEPENDS "${files}")
endfunction()
