# What every folder's CMakeLists.txt is written in: pliant_library, pliant_test, pliant_bench.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
                                  ${CCACHE})
endif()

find_package(Eigen3 3.4 REQUIRED NO_MODULE)

# In the tree and installed, headers are included as "pliant/systems/block.h".
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/include)
file(CREATE_LINK ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/include/pliant SYMBOLIC)

# Compile and link options of all targets of the tree; nothing of it is exported.
add_library(pliant_options INTERFACE)
# A rule's parameter may have the name of the port it reads: -Wshadow forbids it, GCC's =local does not.
# GCC 12 sees overlaps and overflows in std::string that are not there (its bug 105651).
target_compile_options(pliant_options INTERFACE -Wall -Wextra
                       $<$<CXX_COMPILER_ID:GNU>:-Wshadow=local;-Wno-restrict;-Wno-stringop-overflow;-Wno-array-bounds>)
if(PLIANT_WERROR)
  target_compile_options(pliant_options INTERFACE -Werror)
endif()
if(PLIANT_SANITIZE)
  # A null pointer ends a program anyway, and this processor takes any alignment: to check each access
  # for both doubles the code. What is not initialized GCC guesses wrongly of code with such checks.
  target_compile_options(pliant_options INTERFACE -fsanitize=${PLIANT_SANITIZE} -fno-sanitize=null,alignment
                                                  -fno-omit-frame-pointer -fno-sanitize-recover=all
                                                  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(pliant_options INTERFACE -fsanitize=${PLIANT_SANITIZE})
endif()
if(PLIANT_COVERAGE)
  target_compile_options(pliant_options INTERFACE --coverage -fprofile-update=atomic
                                                  -fprofile-exclude-files=/usr/include/.*)
  target_link_options(pliant_options INTERFACE --coverage)
endif()

# pliant_library(FOLDER HEADERS … SOURCES … PUBLIC … PRIVATE …): the library pliant::FOLDER.
# HEADERS are installed; a header that is not listed is private to its folder. Libraries are shared, so
# what they link PRIVATE is no concern of their users, and show no symbol of an archive inside them:
# Simbody exports some of another SUNDIALS than ours, and each must find its own.
function(pliant_library name)
  cmake_parse_arguments(ARG "" "" "HEADERS;SOURCES;PUBLIC;PRIVATE" ${ARGN})
  if(ARG_SOURCES)
    add_library(pliant_${name} SHARED ${ARG_SOURCES})
    set(scope PUBLIC)
    target_compile_options(pliant_${name} PRIVATE -fno-semantic-interposition)
    # Parsed once for all libraries; a macro of its own would keep a library from using it.
    set_target_properties(pliant_${name} PROPERTIES DEFINE_SYMBOL "")
    if(TARGET pliant_systems AND NOT name STREQUAL "systems")
      target_precompile_headers(pliant_${name} REUSE_FROM pliant_systems)
    else()
      target_precompile_headers(pliant_${name} PRIVATE <Eigen/Core> <algorithm> <cmath> <functional>
                                <memory> <sstream> <string> <tuple> <unordered_map> <vector>)
    endif()
    set(symbols ${PROJECT_SOURCE_DIR}/cmake/symbols.map)
    target_link_options(pliant_${name} PRIVATE LINKER:--exclude-libs,ALL LINKER:--version-script=${symbols})
    # Clang's sanitizers stand in the program alone.
    if(NOT (PLIANT_SANITIZE AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang"))
      target_link_options(pliant_${name} PRIVATE LINKER:--no-undefined)
    endif()
    set_target_properties(pliant_${name} PROPERTIES INSTALL_RPATH "$ORIGIN" LINK_DEPENDS ${symbols}
                                                    VERSION ${PROJECT_VERSION}
                                                    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
    target_link_libraries(pliant_${name} PRIVATE $<BUILD_INTERFACE:pliant_options> ${ARG_PRIVATE})
  else()
    add_library(pliant_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(pliant::${name} ALIAS pliant_${name})
  set_target_properties(pliant_${name} PROPERTIES EXPORT_NAME ${name})
  target_link_libraries(pliant_${name} ${scope} ${ARG_PUBLIC})
  target_compile_features(pliant_${name} ${scope} cxx_std_20)
  target_include_directories(pliant_${name} ${scope}
                             $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include> $<INSTALL_INTERFACE:include>)
  install(TARGETS pliant_${name} EXPORT pliant LIBRARY COMPONENT runtime NAMELINK_COMPONENT dev)
  install(FILES ${ARG_HEADERS} DESTINATION include/pliant/${name} COMPONENT dev)
  list(TRANSFORM ARG_HEADERS PREPEND ${PROJECT_BINARY_DIR}/include/pliant/${name}/)
  set_property(GLOBAL APPEND PROPERTY pliant_public_headers ${ARG_HEADERS})
endfunction()

# A test's own code runs once: compiling it at -O3 or with the checks of undefined behaviour, which are for
# the libraries and the command, takes half as long again and more.
set(pliant_test_options $<$<CONFIG:Release>:-O1>)
if(PLIANT_SANITIZE MATCHES undefined)
  list(APPEND pliant_test_options -fno-sanitize=undefined)
endif()

# What no test takes [s].
set(pliant_test_timeout 600)
if(PLIANT_SANITIZE OR PLIANT_COVERAGE)
  set(pliant_test_timeout 3600)
endif()

# pliant_test(FOLDER/NAME_test.cc [LIBRARIES …] [LABELS …]): one test program, one CTest entry FOLDER/NAME.
function(pliant_test source)
  cmake_parse_arguments(ARG "" "" "LIBRARIES;LABELS" ${ARGN})
  string(REGEX REPLACE "_test\\.cc$" "" name ${source})
  string(REPLACE "/" "_" target ${name}_test)
  add_executable(${target} ${source})
  target_link_libraries(${target} PRIVATE pliant_options ${ARG_LIBRARIES} GTest::gmock GTest::gtest_main)
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  target_compile_definitions(${target} PRIVATE PLIANT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_compile_options(${target} PRIVATE ${pliant_test_options})
  target_precompile_headers(${target} REUSE_FROM pliant_precompiled)
  add_test(NAME ${name} COMMAND ${target})
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${pliant_test_timeout})
endfunction()

# pliant_bench(NAME.cc [LIBRARIES …]): one Google Benchmark program.
function(pliant_bench source)
  cmake_parse_arguments(ARG "" "" "LIBRARIES" ${ARGN})
  cmake_path(GET source STEM name)
  add_executable(${name} ${source})
  target_link_libraries(${name} PRIVATE pliant_options ${ARG_LIBRARIES} benchmark::benchmark_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bench)
endfunction()
