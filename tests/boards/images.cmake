# The images that QEMU runs as tests: libdyn, one robot in flash, and what a PC computed of it (DYN_BOARD_TABLES: where dyn_board_tables wrote that).
# images.txt lists them for `report`: name, board, file.
# Nothing allocates: malloc and its kind are renamed to what nobody defines, so that an image that called one would not link.
set(DYN_BOARD_TABLES "" CACHE PATH "Output of dyn_board_tables")
foreach(name malloc calloc realloc free aligned_alloc _malloc_r _calloc_r _realloc_r _free_r _sbrk _sbrk_r)
  list(APPEND no_heap -Wl,--wrap=${name})
endforeach()

# The toolchain file names QEMU's machine, the linker scripts (tools/bare_metal; that of the machine first), the start-up code and the libraries.
set(folder ${PROJECT_SOURCE_DIR}/tools/bare_metal)
string(REGEX REPLACE "g\\+\\+$" "" prefix ${CMAKE_CXX_COMPILER})
set(emulator ${DYN_QEMU} -nographic -monitor none -serial none -icount shift=0,sleep=off -semihosting-config enable=on,target=native -kernel)
list(JOIN emulator " " command)
set(images "prefix ${prefix}\nrun ${command}\n")

function(dyn_elf elf board library)  # of objects and sources
  add_executable(${elf} ${ARGN})
  target_link_libraries(${elf} PRIVATE ${library} ${DYN_BOARD_LIBRARIES})
  target_link_options(${elf} PRIVATE -nostdlib -L ${folder} -T ${board}.ld ${no_heap} -Wl,-Map=${elf}.map)
  set_target_properties(${elf} PROPERTIES LINK_DEPENDS "${folder}/${board}.ld;${folder}/sections.ld" SUFFIX .elf LINKER_LANGUAGE CXX)
endfunction()

# NAME_BOARD.elf for each board, of the object libraries NAME_objects and, if it is there, NAME_parts.
function(dyn_link name library)
  set(objects $<TARGET_OBJECTS:${name}_objects>)
  if(TARGET ${name}_parts)
    list(APPEND objects $<TARGET_OBJECTS:${name}_parts>)
  endif()
  foreach(board IN LISTS ARGN)
    dyn_elf(${name}_${board} ${board} ${library} ${objects})
    string(APPEND images "image ${name} ${board} $<TARGET_FILE:${name}_${board}>\n")
  endforeach()
  list(GET ARGN 0 board)
  add_test(NAME ${name} COMMAND ${emulator} $<TARGET_FILE:${name}_${board}>)
  set_tests_properties(${name} PROPERTIES TIMEOUT 600)
  set(images "${images}" PARENT_SCOPE)
endfunction()

function(dyn_objects_of name library)  # SOURCES files DEFINES definitions
  cmake_parse_arguments(x "" "" "SOURCES;DEFINES" ${ARGN})
  add_library(${name}_objects OBJECT ${x_SOURCES} ${folder}/start.cpp ${folder}/${DYN_START})
  target_include_directories(${name}_objects PRIVATE ${PROJECT_SOURCE_DIR}/tests ${folder} ${DYN_BOARD_TABLES})
  target_compile_definitions(${name}_objects PRIVATE DYN_TICKS=${DYN_TICKS} ${x_DEFINES})
  target_link_libraries(${name}_objects PRIVATE ${library} dyn_warnings)
endfunction()

# An image on internal headers: kind robot BOARDS boards DEFINES definitions
set(work_rnea Rnea)
set(work_dynamics Dynamics)
set(work_contact Steps)
macro(dyn_image kind robot)
  cmake_parse_arguments(x "" "" "BOARDS;DEFINES" ${ARGN})
  dyn_objects_of(${kind}_${robot} dyn_core_static SOURCES ${CMAKE_CURRENT_LIST_DIR}/image.cpp
                 DEFINES DYN_TABLES="${kind}_${robot}.hpp" DYN_FIGURES=${kind}_figures DYN_WORK=${work_${kind}} ${x_DEFINES})
  dyn_link(${kind}_${robot} dyn_core_static ${x_BOARDS})
endmacro()

# A program that includes dyn.h alone: name SOURCES files PARTS parts BOARDS boards DEFINES definitions MESSAGES kind. What depends on
# the parts and on messages is compiled for them.
macro(dyn_program name)
  cmake_parse_arguments(x "" "MESSAGES" "SOURCES;PARTS;BOARDS;DEFINES" ${ARGN})
  dyn_objects_of(${name} dyn_board SOURCES ${x_SOURCES} DEFINES ${x_DEFINES} $<$<BOOL:${DYN_REPRODUCIBLE}>:DYN_LANES=4>)
  set(messages full ${x_MESSAGES})
  list(GET messages -1 messages)
  set(own data guard)
  if(x_MESSAGES)  # all that it keeps of what makes messages, in front of the library's
    list(APPEND own dynamics image kinematics message model reflection structs)
  endif()
  list(TRANSFORM own REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/capi/\\1.cpp")
  dyn_objects(${name}_parts "${own}")
  target_link_libraries(${name}_parts PRIVATE dyn_flags dyn_warnings)
  target_compile_options(${name}_parts PRIVATE $<$<BOOL:${DYN_SMALL}>:-Os>)
  dyn_parts_definition(parts ${x_PARTS})
  dyn_messages_level(level ${messages})
  target_compile_definitions(${name}_parts PRIVATE "${parts}" DYN_MESSAGES=${level})
  dyn_link(${name} dyn_board ${x_BOARDS})
  if(x_MESSAGES)
    list(GET x_BOARDS 0 board)
    target_link_options(${name}_${board} PRIVATE -Wl,--allow-multiple-definition)
  endif()
endmacro()

dyn_program(rnea_dyn_h SOURCES ${CMAKE_CURRENT_LIST_DIR}/rnea_dyn_h.cpp PARTS INVERSE BOARDS ${DYN_BOARDS} DEFINES DYN_TABLES="rnea_arm.hpp")
dyn_image(rnea arm BOARDS ${DYN_BOARDS})
list(GET DYN_BOARDS 0 board)
option(DYN_ALL_IMAGES "Images with other messages, and of the quadruped on internal headers" ON)
if(DYN_ALL_IMAGES)
  foreach(messages short none)
    dyn_program(rnea_dyn_h_${messages} SOURCES ${CMAKE_CURRENT_LIST_DIR}/rnea_dyn_h.cpp PARTS INVERSE BOARDS ${board}
                MESSAGES ${messages} DEFINES DYN_TABLES="rnea_arm.hpp" DYN_REFUSAL_${messages})
  endforeach()
endif()
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "cortex-m7")
  # every function that boards have: it links without a heap and without the C library's streams
  set(list ${PROJECT_BINARY_DIR}/functions_of_boards.inc)
  add_custom_command(OUTPUT ${list} DEPENDS ${PROJECT_SOURCE_DIR}/include/dyn.h ${CMAKE_CURRENT_LIST_DIR}/functions
    COMMAND ${CMAKE_CURRENT_LIST_DIR}/functions ${CMAKE_C_COMPILER} ${PROJECT_SOURCE_DIR}/include/dyn.h ${list} VERBATIM)
  dyn_objects_of(all_dyn_h dyn_board SOURCES ${CMAKE_CURRENT_LIST_DIR}/all_dyn_h.cpp ${list})
  target_include_directories(all_dyn_h_objects PRIVATE ${PROJECT_BINARY_DIR})
  dyn_link(all_dyn_h dyn_board mps2)
  dyn_image(dynamics arm BOARDS ${DYN_BOARDS})
  dyn_program(contact_dyn_h SOURCES ${CMAKE_CURRENT_LIST_DIR}/contact_dyn_h.cpp PARTS SIMULATION CONSTRAINTS COLLISION CHOLESKY BOARDS ${DYN_BOARDS}
              DEFINES DYN_TABLES="contact_quadruped.hpp")
  dyn_program(distances_dyn_h SOURCES ${CMAKE_CURRENT_LIST_DIR}/distances_dyn_h.cpp PARTS COLLISION BOARDS mps2
              DEFINES DYN_TABLES="distances_shapes.hpp")
  if(DYN_ALL_IMAGES)
    dyn_image(dynamics quadruped BOARDS ${DYN_BOARDS})
    dyn_image(contact quadruped BOARDS mps2 DEFINES DYN_SLOW_MEMORY)
  endif()
endif()
file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/images.txt CONTENT "${images}")

# The table of worst cases (tools/boards --worst). Steps take more flash than an an547 has.
add_custom_target(worst)
set(worst "run ${command}\n")
string(COMPARE NOTEQUAL ${board} an547 steps)
foreach(robot arm quadruped humanoid)
  dyn_objects_of(worst_${robot} dyn_board SOURCES ${CMAKE_CURRENT_LIST_DIR}/worst_dyn_h.cpp
                 DEFINES DYN_TABLES="worst_${robot}.hpp" DYN_STEPS=${steps})
  dyn_elf(worst_${robot} ${board} dyn_board $<TARGET_OBJECTS:worst_${robot}_objects>)
  set_target_properties(worst_${robot}_objects worst_${robot} PROPERTIES EXCLUDE_FROM_ALL ON)
  add_dependencies(worst worst_${robot})
  string(APPEND worst "image ${robot} $<TARGET_FILE:worst_${robot}>\n")
endforeach()
file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/worst.txt CONTENT "${worst}")

# `report` builds it, and expects that the linker refuses malloc
dyn_elf(allocating ${board} dyn_board ${CMAKE_CURRENT_LIST_DIR}/allocating.cpp ${folder}/start.cpp ${folder}/${DYN_START})
target_include_directories(allocating PRIVATE ${folder})
target_compile_definitions(allocating PRIVATE DYN_TICKS=${DYN_TICKS})
set_target_properties(allocating PROPERTIES EXCLUDE_FROM_ALL ON)
