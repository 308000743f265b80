# dyn_level(level arch): the sources compiled for one instruction set. dyn_libraries(level...): libdyn.so and libdyn.a of all of them.

# All .cpp files directly in these folders of the project, sorted.
function(dyn_glob result)
  set(files)
  foreach(folder IN LISTS ARGN)
    if(NOT EXISTS ${PROJECT_SOURCE_DIR}/${folder})
      message(FATAL_ERROR "dyn_glob: ${folder} does not exist")
    endif()
    file(GLOB found CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
    list(APPEND files ${found})
  endforeach()
  set(${result} "${files}" PARENT_SCOPE)
endfunction()

# Compiles the sources of a target in a few large files, a folder at a time: from nothing that takes a fraction of the time, for most of it
# is reading headers. Their local names have to differ. size: sources in a file. (tests/fuzz replaces objects of a folder.)
function(dyn_together target size)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${DYN_TOGETHER} UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${source})
    get_filename_component(folder ${folder} DIRECTORY)
    string(MAKE_C_IDENTIFIER "${folder}" folder)
    math(EXPR before_${folder} "0${before_${folder}} + 1")
    math(EXPR part "${before_${folder}} / ${size}")
    set_property(SOURCE ${source} PROPERTY UNITY_GROUP ${folder}_${part})
  endforeach()
endfunction()

# Tables of what dyn.h declares, for all that includes src/table/enums.hpp.
find_program(DYN_PYTHON python3 REQUIRED)
set(DYN_TABLES ${PROJECT_BINARY_DIR}/tables)
set(tables members names statuses enums algorithms functions interface)
list(TRANSFORM tables REPLACE "(.+)" "${DYN_TABLES}/table/\\1.inc")
list(APPEND tables ${DYN_TABLES}/table/functions.def)
file(GLOB makers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/table/*.py)
add_custom_command(OUTPUT ${tables}
  COMMAND ${DYN_PYTHON} -B ${PROJECT_SOURCE_DIR}/src/table/reflect.py ${PROJECT_SOURCE_DIR}/include/dyn.h ${DYN_TABLES}/table
  DEPENDS ${makers} ${PROJECT_SOURCE_DIR}/include/dyn.h VERBATIM)
add_custom_target(dyn_tables DEPENDS ${tables})

# The floating-point rules, the instruction set and the include folders: one set for everything that sees internal headers, for an inline
# function must be the same function everywhere.
function(dyn_flags target arch)
  target_compile_features(${target} INTERFACE cxx_std_20)
  target_compile_options(${target} INTERFACE -fno-math-errno -fno-trapping-math -Wno-psabi
                         -ffp-contract=$<IF:$<BOOL:${DYN_REPRODUCIBLE}>,off,fast>
                         $<$<BOOL:${arch}>:-march=${arch}>)
  # GCC's generic tuning moves vectors through general registers: ABA takes 1.2 (v3) to 1.4 (v4) times as long
  if(arch MATCHES "x86-64-v[34]")
    target_compile_options(${target} INTERFACE $<$<CXX_COMPILER_ID:GNU>:-mtune=icelake-server>)
  endif()
  target_compile_definitions(${target} INTERFACE $<$<BOOL:${DYN_CHECKED}>:DYN_CHECKED=1> $<$<BOOL:${DYN_REPRODUCIBLE}>:DYN_REPRODUCIBLE=1>
                             $<$<PLATFORM_ID:Windows>:DYN_STATIC>)
  target_include_directories(${target} INTERFACE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/capi ${PROJECT_SOURCE_DIR}/src ${DYN_TABLES})
  add_dependencies(${target} dyn_tables)
  target_include_directories(${target} SYSTEM INTERFACE $<TARGET_PROPERTY:Eigen3::Eigen,INTERFACE_INCLUDE_DIRECTORIES>)
endfunction()

function(dyn_objects target sources)
  if(NOT sources)
    set(sources ${PROJECT_BINARY_DIR}/empty.cpp)
    file(CONFIGURE OUTPUT ${sources} CONTENT "// no sources yet\n")
  endif()
  add_library(${target} OBJECT ${sources})
  target_compile_options(${target} PRIVATE -ffunction-sections -fdata-sections)
  # each object's frames beside it, for tools/stack; what loads runs before anything that must not stop
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT target MATCHES "host" AND NOT DYN_SANITIZE)
    target_compile_options(${target} PRIVATE -fstack-usage)
  endif()
endfunction()

# What reads files of others: writes past an array end the program, they do not go on.
function(dyn_harden target)
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND NOT DYN_SANITIZE)
    target_compile_options(${target} PRIVATE -fstack-protector-strong $<$<CONFIG:Release>:-U_FORTIFY_SOURCE> $<$<CONFIG:Release>:-D_FORTIFY_SOURCE=2>)
    target_compile_definitions(${target} PRIVATE _GLIBCXX_ASSERTIONS)
  endif()
endfunction()

# dyn_core dyn_host dyn_host_text dyn_capi (of another level than plain: dyn_core_v3 ...), and dyn_internal: the archive of their objects, for tests of
# internal headers
function(dyn_level level arch)
  if(NOT level STREQUAL "plain")
    set(suffix _${level})
  endif()
  add_library(dyn_flags${suffix} INTERFACE)
  dyn_flags(dyn_flags${suffix} "${arch}")

  dyn_objects(dyn_core${suffix} "${DYN_CORE_SOURCES}")
  target_compile_options(dyn_core${suffix} PRIVATE -fno-exceptions -fno-rtti)
  dyn_objects(dyn_host${suffix} "${DYN_HOST_SOURCES}")
  dyn_objects(dyn_host_text${suffix} "${DYN_TEXT_SOURCES}")
  target_compile_options(dyn_host_text${suffix} PRIVATE $<$<CONFIG:Release>:-O1>)  # -O3 loads a fifth faster and compiles for half as long again
  foreach(part host host_text)
    dyn_harden(dyn_${part}${suffix})
    dyn_together(dyn_${part}${suffix} 24)
    target_include_directories(dyn_${part}${suffix} SYSTEM PRIVATE ${DYN_URDFDOM_INCLUDE} ${DYN_TINYXML2_INCLUDE} ${DYN_CCD_INCLUDE})
    target_compile_definitions(dyn_${part}${suffix} PRIVATE $<$<PLATFORM_ID:Windows>:URDFDOM_STATIC>)
  endforeach()
  dyn_objects(dyn_capi${suffix} "${DYN_CAPI_SOURCES}")
  dyn_together(dyn_capi${suffix} 24)
  if(NOT arch)
    set(arch ${CMAKE_SYSTEM_PROCESSOR})
  endif()
  target_compile_definitions(dyn_capi${suffix} PRIVATE DYN_ARCH_NAME="${arch}")

  set(objects)
  foreach(part core host host_text capi)
    target_link_libraries(dyn_${part}${suffix} PRIVATE dyn_flags${suffix} dyn_warnings)
    list(APPEND objects $<TARGET_OBJECTS:dyn_${part}${suffix}>)
  endforeach()
  set(DYN_OBJECTS_${level} "${objects}" PARENT_SCOPE)

  add_library(dyn_internal${suffix} STATIC EXCLUDE_FROM_ALL ${objects})
  set_target_properties(dyn_internal${suffix} PROPERTIES LINKER_LANGUAGE CXX)
  target_compile_definitions(dyn_internal${suffix} INTERFACE DYN_STATIC)
  target_include_directories(dyn_internal${suffix} PUBLIC ${PROJECT_SOURCE_DIR}/include)
  target_link_libraries(dyn_internal${suffix} INTERFACE dyn_flags${suffix} ${DYN_HOST_LIBRARIES})
endfunction()

# Several levels: one object of each level, and the functions of dyn.h that lead to the one that is used (capi/level).
function(dyn_join_levels result levels)
  set(folder ${PROJECT_BINARY_DIR}/level)
  set(source ${PROJECT_SOURCE_DIR}/capi/level)
  set(list "// Levels of the library, the best last.\n")
  set(objects)
  foreach(level IN LISTS levels)
    set(object ${folder}/${level}.o)
    add_custom_command(OUTPUT ${object} VERBATIM COMMAND_EXPAND_LISTS
      COMMAND ${source}/object.sh ${CMAKE_LINKER} ${CMAKE_OBJCOPY} ${level} ${DYN_TABLES}/table/functions.inc ${object} ${DYN_OBJECTS_${level}}
      DEPENDS ${DYN_OBJECTS_${level}} ${source}/object.sh ${DYN_TABLES}/table/functions.inc)
    list(APPEND objects ${object})
    string(APPEND list "LEVEL(${level}, \"${DYN_ARCH_${level}}\")\n")
  endforeach()
  file(CONFIGURE OUTPUT ${folder}/levels.inc CONTENT "${list}")
  add_library(dyn_level OBJECT ${source}/choose.c ${source}/stubs.S)
  target_include_directories(dyn_level PRIVATE ${folder} ${DYN_TABLES})
  target_compile_options(dyn_level PRIVATE $<$<COMPILE_LANGUAGE:C>:-ffunction-sections>)
  set_source_files_properties(${source}/stubs.S PROPERTIES OBJECT_DEPENDS "${folder}/levels.inc;${DYN_TABLES}/table/functions.inc")
  add_dependencies(dyn_level dyn_tables)
  set_source_files_properties(${objects} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
  set(${result} ${objects} $<TARGET_OBJECTS:dyn_level> PARENT_SCOPE)
endfunction()

# dyn and dyn_static
function(dyn_libraries)
  set(levels ${ARGN})
  list(LENGTH levels count)
  if(count GREATER 1)
    dyn_join_levels(objects "${levels}")
  else()
    set(objects ${DYN_OBJECTS_${levels}})
  endif()

  # libdyn.so.1: what dyn.map exports, nothing undefined, nothing unused, nothing to be looked up at a first call
  set(map ${PROJECT_SOURCE_DIR}/capi/dyn.map)
  add_library(dyn SHARED ${objects})
  set_target_properties(dyn PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR} LINK_DEPENDS ${map} LINKER_LANGUAGE CXX)
  if(WIN32)  # dyn.dll, and dyn.lib to link with
    target_sources(dyn PRIVATE ${DYN_TABLES}/table/functions.def)
    set_target_properties(dyn PROPERTIES PREFIX "" IMPORT_PREFIX "" IMPORT_SUFFIX .lib)
    target_link_options(dyn PRIVATE -static -Wl,--gc-sections)
  else()
    target_link_options(dyn PRIVATE -Wl,--version-script=${map} -Wl,--gc-sections -Wl,--as-needed -Wl,-O1 -Wl,-z,now)
    if(NOT DYN_SANITIZE)
      target_link_options(dyn PRIVATE -Wl,-z,defs)
    endif()
  endif()
  target_link_libraries(dyn PRIVATE ${DYN_HOST_LIBRARIES})

  # libdyn.a: the same objects
  add_library(dyn_static STATIC ${objects})
  set_target_properties(dyn_static PROPERTIES OUTPUT_NAME dyn EXPORT_NAME static LINKER_LANGUAGE CXX)
  target_compile_definitions(dyn_static INTERFACE DYN_STATIC)
  foreach(item IN LISTS DYN_HOST_LIBRARIES)
    target_link_libraries(dyn_static INTERFACE $<BUILD_INTERFACE:${item}>)
  endforeach()
  target_link_libraries(dyn_static INTERFACE $<INSTALL_INTERFACE:urdfdom_model> $<INSTALL_INTERFACE:console_bridge> $<INSTALL_INTERFACE:tinyxml2> ${CMAKE_DL_LIBS})
  foreach(target dyn dyn_static)
    target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    if(count GREATER 1)
      add_dependencies(${target} dyn_tables)
    endif()
  endforeach()
endfunction()
