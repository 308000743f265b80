# dyn_library(suffix arch folder): the same sources compiled for one instruction set, four targets.

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

# Compiles the sources of a target in a few large files: from nothing that takes a fraction of the time, for most of it is reading headers.
# Their local names have to differ.
function(dyn_together target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${DYN_TOGETHER} UNITY_BUILD_BATCH_SIZE 10)
endfunction()

# Tables of what dyn.h declares, for all that includes src/table/enums.hpp.
find_program(DYN_PYTHON python3 REQUIRED)
set(DYN_TABLES ${PROJECT_BINARY_DIR}/tables)
set(tables members names enums algorithms interface)
list(TRANSFORM tables REPLACE "(.+)" "${DYN_TABLES}/table/\\1.inc")
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
  target_compile_definitions(${target} INTERFACE $<$<BOOL:${DYN_CHECKED}>:DYN_CHECKED=1> $<$<BOOL:${DYN_REPRODUCIBLE}>:DYN_REPRODUCIBLE=1>)
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

function(dyn_library suffix arch folder)
  add_library(dyn_flags${suffix} INTERFACE)
  dyn_flags(dyn_flags${suffix} "${arch}")

  dyn_objects(dyn_core${suffix} "${DYN_CORE_SOURCES}")
  target_compile_options(dyn_core${suffix} PRIVATE -fno-exceptions -fno-rtti)
  dyn_objects(dyn_host${suffix} "${DYN_HOST_SOURCES}")
  target_include_directories(dyn_host${suffix} SYSTEM PRIVATE ${DYN_URDFDOM_INCLUDE} ${DYN_TINYXML2_INCLUDE} ${DYN_CCD_INCLUDE})
  dyn_objects(dyn_capi${suffix} "${DYN_CAPI_SOURCES}")
  if(arch)
    set(name ${arch})
  else()
    set(name ${CMAKE_SYSTEM_PROCESSOR})
  endif()
  target_compile_definitions(dyn_capi${suffix} PRIVATE DYN_ARCH_NAME="${name}")

  set(objects)
  foreach(part core host capi)
    target_link_libraries(dyn_${part}${suffix} PRIVATE dyn_flags${suffix} dyn_warnings)
    list(APPEND objects $<TARGET_OBJECTS:dyn_${part}${suffix}>)
  endforeach()
  set(host_libraries ${DYN_URDFDOM_LIBRARY} ${DYN_CONSOLE_BRIDGE_LIBRARY} ${DYN_TINYXML2_LIBRARY} ${CMAKE_DL_LIBS})

  # libdyn.so.1: what dyn.map exports, nothing undefined, nothing unused, nothing to be looked up at a first call
  set(map ${PROJECT_SOURCE_DIR}/capi/dyn.map)
  add_library(dyn${suffix} SHARED ${objects})
  set_target_properties(dyn${suffix} PROPERTIES OUTPUT_NAME dyn VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR} EXPORT_NAME dyn
    LIBRARY_OUTPUT_DIRECTORY ${folder} LINK_DEPENDS ${map} LINKER_LANGUAGE CXX)
  target_link_options(dyn${suffix} PRIVATE -Wl,--version-script=${map} -Wl,--gc-sections -Wl,--as-needed -Wl,-O1 -Wl,-z,now)
  if(NOT DYN_SANITIZE)
    target_link_options(dyn${suffix} PRIVATE -Wl,-z,defs)
  endif()
  target_link_libraries(dyn${suffix} PRIVATE ${host_libraries})
  target_include_directories(dyn${suffix} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)

  # libdyn.a: the same objects; internal headers may be used with it in this build
  add_library(dyn_static${suffix} STATIC ${objects})
  set_target_properties(dyn_static${suffix} PROPERTIES OUTPUT_NAME dyn EXPORT_NAME static ARCHIVE_OUTPUT_DIRECTORY ${folder} LINKER_LANGUAGE CXX)
  target_compile_definitions(dyn_static${suffix} INTERFACE DYN_STATIC)
  target_include_directories(dyn_static${suffix} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  foreach(item dyn_flags${suffix} ${host_libraries})
    target_link_libraries(dyn_static${suffix} INTERFACE $<BUILD_INTERFACE:${item}>)
  endforeach()
  target_link_libraries(dyn_static${suffix} INTERFACE $<INSTALL_INTERFACE:urdfdom_model> $<INSTALL_INTERFACE:console_bridge> $<INSTALL_INTERFACE:tinyxml2> ${CMAKE_DL_LIBS})
  if(suffix)
    set_target_properties(dyn_static${suffix} PROPERTIES EXCLUDE_FROM_ALL ON)
  endif()
endfunction()
