# The page of `dyn view` and --html: tools/viewer bundled into share/dyn/viewer.html, in the build tree as in the installed one.
# Without npm and a network, and without Debian's packages (tools/packages_page), it is left out, and the command says so when it is asked for.
option(DYN_VIEWER "Make the page of dyn view and --html (npm and a network, or Debian's packages)" ${PROJECT_IS_TOP_LEVEL})
file(RELATIVE_PATH datadir_from_bindir ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_DATADIR})
set_source_files_properties(tools/cli/page/page.cpp PROPERTIES COMPILE_DEFINITIONS "DYN_VIEWER_FROM_BIN=\"${datadir_from_bindir}/dyn/viewer.html\"")
if(DYN_VIEWER)
  file(GLOB DYN_VIEWER_SOURCES CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tools/viewer/src/* ${PROJECT_SOURCE_DIR}/tools/viewer/package*.json
    ${PROJECT_SOURCE_DIR}/tools/viewer/three_r111.js)
  set(page ${PROJECT_BINARY_DIR}/share/dyn/viewer.html)
  add_custom_command(OUTPUT ${page} COMMAND ${PROJECT_SOURCE_DIR}/tools/viewer/bundle ${PROJECT_BINARY_DIR}/viewer ${page}
    DEPENDS ${DYN_VIEWER_SOURCES} tools/viewer/bundle COMMENT "Bundling the page of dyn view" VERBATIM)
  add_custom_target(dyn_viewer ALL DEPENDS ${page})
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_DATADIR}/dyn OPTIONAL)
endif()
