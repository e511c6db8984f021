# Cross-compiles the trigger firmware with Debian's clang, as a second opinion on its source. avr-libc's headers and
# start-up code are avr-gcc's, and avr-gcc links.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR avr)
set(CMAKE_C_COMPILER avr-gcc)
set(CMAKE_CXX_COMPILER clang++-16)
set(CMAKE_CXX_COMPILER_TARGET avr)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_CXX_LINK_EXECUTABLE "avr-gcc <LINK_FLAGS> <OBJECTS> -o <TARGET> <LINK_LIBRARIES>")

set(CMAKE_CXX_FLAGS_INIT "-nostdlibinc -isystem /usr/lib/avr/include -fno-exceptions -fno-rtti -fno-threadsafe-statics -ffunction-sections -fdata-sections")
