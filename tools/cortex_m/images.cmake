# The images that QEMU runs as tests: dyn_core, one robot in flash, and what a PC computed of it (DYN_BOARD_TABLES: where dyn_board_tables wrote that);
# and the same linked for an STM32H743, <image>_stm32h743.elf, where they fit.
# Nothing allocates: malloc and its kind are renamed to what nobody defines, so that an image that called one would not link.
set(DYN_BOARD_TABLES "" CACHE PATH "Output of dyn_board_tables")
set(cortex_m ${PROJECT_SOURCE_DIR}/tools/cortex_m)
foreach(name malloc calloc realloc free aligned_alloc _malloc_r _calloc_r _realloc_r _free_r _sbrk _sbrk_r)
  list(APPEND no_heap -Wl,--wrap=${name})
endforeach()

function(dyn_link image board)
  set(elf ${image}_${board})
  add_executable(${elf} $<TARGET_OBJECTS:${image}_objects>)
  target_link_libraries(${elf} PRIVATE $<IF:$<BOOL:${x_DYN_H}>,dyn_board,dyn_core_static> -lc -lm -lgcc)
  target_link_options(${elf} PRIVATE -nostdlib -Wl,--no-enum-size-warning -L ${cortex_m} -T ${board}.ld ${no_heap} -Wl,--print-memory-usage -Wl,-Map=${elf}.map)
  set_target_properties(${elf} PROPERTIES LINK_DEPENDS "${cortex_m}/${board}.ld;${cortex_m}/sections.ld" SUFFIX .elf)
endfunction()

# kind robot BOARDS boards DEFINES definitions
function(dyn_image kind robot)
  cmake_parse_arguments(x "" "" "BOARDS;DEFINES" ${ARGN})
  set(image ${kind}_${robot})
  string(TOUPPER "${kind}" upper)
  string(SUBSTRING ${upper} 0 1 first)
  string(SUBSTRING ${kind} 1 -1 rest)
  set(work ${first}${rest})
  if(kind STREQUAL "contact")
    set(work Steps)
  endif()
  add_library(${image}_objects OBJECT ${PROJECT_SOURCE_DIR}/tests/boards/image.cpp ${cortex_m}/start.cpp)
  target_include_directories(${image}_objects PRIVATE ${PROJECT_SOURCE_DIR}/tests ${cortex_m} ${DYN_BOARD_TABLES})
  target_compile_definitions(${image}_objects PRIVATE DYN_TABLES="${image}.hpp" DYN_FIGURES=${kind}_figures DYN_WORK=${work} ${x_DEFINES})
  target_link_libraries(${image}_objects PRIVATE dyn_core_static dyn_warnings)
  foreach(board IN LISTS x_BOARDS)
    dyn_link(${image} ${board})
  endforeach()
  add_test(NAME ${image} COMMAND qemu-system-arm -M mps2-an500 -nographic -monitor none -serial none -icount shift=0 -semihosting-config enable=on,target=native
           -kernel $<TARGET_FILE:${image}_mps2>)
  set_tests_properties(${image} PROPERTIES TIMEOUT 600)
endfunction()

dyn_image(rnea arm BOARDS mps2 stm32h743)
dyn_image(dynamics arm BOARDS mps2 stm32h743)
dyn_image(dynamics quadruped BOARDS mps2 stm32h743)
dyn_image(contact quadruped BOARDS mps2 DEFINES DYN_SLOW_MEMORY)
