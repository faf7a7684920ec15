# SPDX-License-Identifier: Apache-2.0
# Pages for browsers: bundled by esbuild with uPlot, and compiled into the programs as text. Where these
# cannot be had, condyle is built without reports and without the live page.

find_program(CONDYLE_ESBUILD esbuild)
set(CONDYLE_WEB_PARTS ${PROJECT_BINARY_DIR}/web_parts)
set(CONDYLE_HAS_WEB_PARTS OFF)
if(NOT CONDYLE_ESBUILD)
  set(problem "esbuild is missing; toolchain/install_dependencies build installs it")
elseif(EXISTS ${CONDYLE_WEB_PARTS}/dist/uPlot.esm.js)
  set(CONDYLE_HAS_WEB_PARTS ON)
else()
  execute_process(COMMAND ${PROJECT_SOURCE_DIR}/toolchain/fetch_web_parts ${CONDYLE_WEB_PARTS}
    RESULT_VARIABLE failed ERROR_VARIABLE problem ERROR_STRIP_TRAILING_WHITESPACE)
  if(failed EQUAL 0)
    set(CONDYLE_HAS_WEB_PARTS ON)
  elseif(failed EQUAL 3)
    message(FATAL_ERROR "${problem}")
  endif()
endif()
set(CONDYLE_HAS_WEB_PARTS ${CONDYLE_HAS_WEB_PARTS} CACHE INTERNAL "the pages for browsers are built")
if(NOT CONDYLE_HAS_WEB_PARTS)
  message(STATUS "condyle report and the live page are left out: ${problem}")
endif()

# condyle_add_page(TARGET HEADER NAMESPACE ENTRY.js STYLE.css [BODY.html]): adds to TARGET the texts of a
# page, the bundles of ENTRY and STYLE among them, as HEADER declares them in NAMESPACE.
function(condyle_add_page target header namespace entry style)
  set(body -)
  if(ARGC GREATER 5)
    set(body ${ARGV5})
  endif()
  cmake_path(GET entry STEM name)
  cmake_path(GET entry PARENT_PATH folder)
  file(GLOB sources CONFIGURE_DEPENDS ${folder}/*.js ${folder}/*.css ${folder}/*.html
    ${PROJECT_SOURCE_DIR}/firmware/hosted/page/*.js)
  set(out ${CMAKE_CURRENT_BINARY_DIR}/${name}_page)
  add_custom_command(OUTPUT ${out}/page_text.cpp
    COMMAND ${CONDYLE_ESBUILD} ${entry} --bundle --minify --charset=ascii --format=iife
      --target=es2019 --log-level=warning --alias:uplot=${CONDYLE_WEB_PARTS}/dist/uPlot.esm.js
      --legal-comments=none --outfile=${out}/page.js
    COMMAND ${CONDYLE_ESBUILD} ${style} --bundle --minify --charset=ascii --log-level=warning
      --outfile=${out}/page.css
    COMMAND ${PROJECT_SOURCE_DIR}/toolchain/page_text ${header} ${namespace} ${body} ${out}/page.js
      ${CONDYLE_WEB_PARTS}/LICENSE ${out}/page_text.cpp
      ${CONDYLE_WEB_PARTS}/dist/uPlot.min.css ${out}/page.css
    DEPENDS ${sources} ${PROJECT_SOURCE_DIR}/toolchain/page_text
      ${CONDYLE_WEB_PARTS}/dist/uPlot.esm.js
    COMMENT "Bundling the page of ${name}"
    VERBATIM)
  # Our compilers take texts of any length; the standard promises less.
  set_source_files_properties(${out}/page_text.cpp PROPERTIES COMPILE_OPTIONS -Wno-overlength-strings)
  target_sources(${target} PRIVATE ${out}/page_text.cpp)
endfunction()
