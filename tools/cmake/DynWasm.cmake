# WebAssembly: one module with all functions of dyn.h, and what loads robot files, for capi/js. Hulls and libccd are linked in. Threads and
# levels are left out.
set(exports ${PROJECT_BINARY_DIR}/exports.json)
add_custom_command(OUTPUT ${exports} DEPENDS ${DYN_TABLES}/table/functions.inc VERBATIM
  COMMAND ${DYN_PYTHON} -B ${PROJECT_SOURCE_DIR}/capi/js/exports.py ${DYN_TABLES}/table/functions.inc ${exports})
add_custom_target(dyn_exports DEPENDS ${exports})

file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/empty.cpp CONTENT "// the objects are all\n")
add_executable(dyn_wasm ${PROJECT_BINARY_DIR}/empty.cpp ${DYN_OBJECTS_plain})
set_target_properties(dyn_wasm PROPERTIES OUTPUT_NAME dyn_module SUFFIX .js LINK_DEPENDS ${exports})
add_dependencies(dyn_wasm dyn_exports)
target_link_libraries(dyn_wasm PRIVATE ${DYN_HOST_LIBRARIES})
target_link_options(dyn_wasm PRIVATE --no-entry -sMODULARIZE=1 -sEXPORT_ES6=1 -sEXPORT_NAME=dynModule -sENVIRONMENT=web,worker,node -sALLOW_MEMORY_GROWTH=1
  -sWASM_BIGINT=1 -sFILESYSTEM=1 -sFORCE_FILESYSTEM=1 -sEXPORTED_RUNTIME_METHODS=FS,HEAPU8 -sEXPORTED_FUNCTIONS=@${exports} -sUSE_ES6_IMPORT_META=1)

# the hashes of all scenes (tests/soak)
add_executable(dyn_soak EXCLUDE_FROM_ALL tests/soak/soak.cpp ${DYN_OBJECTS_plain})
target_include_directories(dyn_soak PRIVATE tests)
target_link_libraries(dyn_soak PRIVATE dyn_flags dyn_warnings ${DYN_HOST_LIBRARIES})
target_link_options(dyn_soak PRIVATE -sALLOW_MEMORY_GROWTH=1 -sENVIRONMENT=node -sEXIT_RUNTIME=1)

# the npm package
add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/npm/libdyn.d.ts VERBATIM
  COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/npm
  COMMAND ${DYN_PYTHON} -B ${PROJECT_SOURCE_DIR}/capi/js/typescript.py ${PROJECT_SOURCE_DIR}/include/dyn.h ${PROJECT_SOURCE_DIR}/capi/js/classes.d.ts
          ${PROJECT_BINARY_DIR}/npm/libdyn.d.ts
  DEPENDS ${PROJECT_SOURCE_DIR}/include/dyn.h ${PROJECT_SOURCE_DIR}/capi/js/typescript.py ${PROJECT_SOURCE_DIR}/capi/js/classes.d.ts)
add_custom_target(dyn_types ALL DEPENDS ${PROJECT_BINARY_DIR}/npm/libdyn.d.ts)
install(FILES ${PROJECT_BINARY_DIR}/npm/libdyn.d.ts ${PROJECT_BINARY_DIR}/bin/dyn_module.js ${PROJECT_BINARY_DIR}/bin/dyn_module.wasm ${PROJECT_SOURCE_DIR}/LICENSE
  DESTINATION npm)
install(FILES capi/js/package.json capi/js/README.md capi/js/libdyn.js capi/js/layout.js capi/js/marshal.js capi/js/live.js DESTINATION npm)
