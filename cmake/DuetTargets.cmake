# duet_add_library(NAME SOURCES ... LINK ... [PRIVATE_LINK ...]): one library a folder, duet::NAME.
# duet_add_test(NAME SOURCES ... LINK ... [LABELS ...] [COST SECONDS]): one GoogleTest program, one
# CTest test. COST is its time on one core where that is more than a few seconds: ctest starts the
# longest first, and no core waits at the end (a fresh build folder knows no times of its own).

add_custom_target(unit_tests)  # all programs with the label unit
# Of these what CI builds with sanitizers: without the label numeric, which compile for minutes then and whose
# code the others run too, from recordings to both estimators.
add_custom_target(sanitizer_tests)

add_library(duet_warnings INTERFACE)
target_compile_options(duet_warnings INTERFACE -Wall -Wextra -Wshadow -Wconversion
                       -Wno-sign-conversion $<$<BOOL:${DUET_WERROR}>:-Werror>)
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # What a source keeps in its unnamed namespace counts as of a header there.
  target_compile_options(duet_warnings INTERFACE -Wno-subobject-linkage)
endif()
if(DUET_SANITIZE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC's manual: code that sanitizers add makes it see uninitialized values where there are none.
  target_compile_options(duet_warnings INTERFACE -Wno-maybe-uninitialized)
endif()

if(DUET_PRECOMPILED_HEADERS)
  file(WRITE "${PROJECT_BINARY_DIR}/precompiled/empty.cc" "")
  add_library(duet_precompiled OBJECT "${PROJECT_BINARY_DIR}/precompiled/empty.cc")
  target_link_libraries(duet_precompiled PRIVATE Eigen3::Eigen)
  target_precompile_headers(duet_precompiled PRIVATE
    <Eigen/Dense> <algorithm> <array> <cmath> <cstdint> <functional> <map> <memory>
    <optional> <span> <sstream> <string> <string_view> <unordered_map> <vector>
    "${PROJECT_SOURCE_DIR}/common/support/eigen_products.h")
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(duet_precompiled PRIVATE -fpch-preprocess)
  endif()
endif()

function(duet_configure_target target)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/generated>)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:duet_warnings>)
  if(DUET_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM duet_precompiled)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      target_compile_options(${target} PRIVATE -fpch-preprocess)
    endif()
  endif()
endfunction()

function(duet_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(duet_${name} STATIC ${ARG_SOURCES})
  add_library(duet::${name} ALIAS duet_${name})
  set_target_properties(duet_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(duet_${name} INTERFACE
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/duet>)
  duet_configure_target(duet_${name})
  target_link_libraries(duet_${name} PUBLIC ${ARG_LINK} PRIVATE ${ARG_PRIVATE_LINK})
  set_property(GLOBAL APPEND PROPERTY DUET_LIBRARIES duet_${name})
endfunction()

function(duet_add_test name)
  cmake_parse_arguments(ARG "" "COST" "SOURCES;LINK;LABELS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  # Where sources are compiled in batches: nearly always one for a program, so that what its sources
  # share is instantiated once.
  set_target_properties(${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 12)
  duet_configure_target(${name})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} duet_test_main GTest::gmock GTest::gtest)
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}")
  if(ARG_COST)
    set_tests_properties(${name} PROPERTIES COST ${ARG_COST})
  endif()
  if("unit" IN_LIST ARG_LABELS)
    add_dependencies(unit_tests ${name})
    if(NOT "numeric" IN_LIST ARG_LABELS)
      add_dependencies(sanitizer_tests ${name})
    endif()
  endif()
endfunction()
