# Build-wide choices. Every one of them is recorded in a run's manifest.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
# One spelling for libraries and programs (not CMAKE_POSITION_INDEPENDENT_CODE, which is -fPIE for
# programs): they share one precompiled header.
add_compile_options(-fPIC)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

set(DUET_ARCH "x86-64-v2" CACHE STRING
    "Argument of -march on x86 (empty: the compiler's own baseline)")
set(DUET_SANITIZE "" CACHE STRING "Argument of -fsanitize, e.g. address,undefined")
option(DUET_WERROR "Warnings are errors" OFF)
option(DUET_PRECOMPILED_HEADERS "Precompile the Eigen and standard headers" ON)
option(DUET_FUZZERS "Build the libFuzzer targets (clang only)" OFF)

# The same bytes on every run of a binary: no contraction that depends on
# inlining; never -ffast-math.
add_compile_options(-ffp-contract=off)
# A debug build without any optimization makes Eigen forty times slower.
set(CMAKE_CXX_FLAGS_DEBUG "-O1 -g")
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
if(DUET_ARCH AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  add_compile_options(-march=${DUET_ARCH})
endif()
# AVX widens Eigen's alignment and with it the layout of objects that cross the
# boundary to the distribution's Ceres, which is built for plain x86-64.
add_compile_definitions(EIGEN_MAX_ALIGN_BYTES=16)
if(DUET_SANITIZE)
  # Line tables alone: all that a report needs, and a tenth off the time to build.
  add_compile_options(-fsanitize=${DUET_SANITIZE} -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=${DUET_SANITIZE})
  if(DUET_SANITIZE MATCHES "undefined")
    add_compile_options(-fno-sanitize-recover=undefined)
    if(DUET_SANITIZE MATCHES "address")
      # Checks before every access, a third of the time to compile; AddressSanitizer stops at null
      # pointers and beyond objects too, and x86 needs no alignment that Eigen does not ask for.
      add_compile_options(-fno-sanitize=null,alignment,object-size,vptr)
    endif()
  endif()
endif()

find_program(DUET_CCACHE ccache)
if(DUET_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
      CCACHE_NOHASHDIR=1 ${DUET_CCACHE})
endif()
