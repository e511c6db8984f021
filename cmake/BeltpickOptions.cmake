# Compiler settings that hold for every target of the project.
option(BELTPICK_TESTS "Build the tests and benches" ON)
option(BELTPICK_FIRMWARE "Cross-compile the trigger firmware with avr-gcc" OFF)
option(BELTPICK_FUZZ "Build the fuzz targets with libFuzzer (clang)" OFF)
set(BELTPICK_SANITIZE "" CACHE STRING "Sanitizers to build with, as for -fsanitize=")

set(CMAKE_CXX_STANDARD 23)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 11)
if(NOT BELTPICK_FIRMWARE)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
endif()

find_program(BELTPICK_CCACHE ccache)
if(BELTPICK_CCACHE)
  set(CMAKE_C_COMPILER_LAUNCHER "${BELTPICK_CCACHE}")
  set(CMAKE_CXX_COMPILER_LAUNCHER "${BELTPICK_CCACHE}")
endif()

# Line tables are enough for a backtrace from the field and halve the build's disk and link time.
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O2 -g1 -DNDEBUG")
set(CMAKE_CXX_FLAGS_DEBUG "-O1 -g1")

add_library(beltpick_warnings INTERFACE)
target_compile_options(beltpick_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  -Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual -Werror)

if(BELTPICK_SANITIZE)
  add_compile_options(-fsanitize=${BELTPICK_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=undefined)
  add_link_options(-fsanitize=${BELTPICK_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    # GCC 12 reports false positives for these once sanitizer code is in the way.
    add_compile_options(-Wno-error=maybe-uninitialized -Wno-error=stringop-overflow -Wno-error=array-bounds)
  endif()
endif()
