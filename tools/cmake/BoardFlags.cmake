# Writes dyn.mk of a toolchain file:  cmake -DTOOLCHAIN=file -DFOLDER=folder -P BoardFlags.cmake
include(${TOOLCHAIN})
list(JOIN DYN_QEMU " " qemu)
list(JOIN DYN_BOARD_LIBRARIES " " libraries)
string(REGEX REPLACE "gcc$" "size" size ${CMAKE_C_COMPILER})
file(WRITE ${FOLDER}/dyn.mk "# libdyn for ${CMAKE_SYSTEM_PROCESSOR}
DYN_FOLDER := $(patsubst %/,%,$(dir $(lastword $(MAKEFILE_LIST))))
DYN_CC = ${CMAKE_C_COMPILER}
DYN_CXX = ${CMAKE_CXX_COMPILER}
DYN_SIZE = ${size}
DYN_FLAGS = ${CMAKE_C_FLAGS_INIT} -DDYN_STATIC -DDYN_BARE -DDYN_TICKS=${DYN_TICKS} -I$(DYN_FOLDER)/include -I$(DYN_FOLDER)/startup
DYN_CXXFLAGS = -std=c++20 -fno-exceptions -fno-rtti -fno-threadsafe-statics
DYN_LINK = -nostdlib -L$(DYN_FOLDER)/startup -Wl,--gc-sections $(DYN_FOLDER)/lib/libdyn.a ${libraries}
DYN_STARTUP = start.cpp ${DYN_START}
DYN_QEMU = ${qemu}
")
