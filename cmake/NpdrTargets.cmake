# One helper per kind of target, so that every target of a kind is built alike.
include(GoogleTest OPTIONAL)

# Flags that every target of the project shares.
add_library(npdr_flags INTERFACE)
target_compile_features(npdr_flags INTERFACE cxx_std_20)
target_include_directories(npdr_flags INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                $<INSTALL_INTERFACE:include/npdr>)
# errno and floating-point traps are not used here; giving them up lets loops over lanes vectorize.
# Nothing that changes the value of a result (such as -ffast-math) is allowed.
target_compile_options(npdr_flags INTERFACE
  $<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion;-Wno-sign-conversion;-Wnon-virtual-dtor>
  -fno-math-errno -fno-trapping-math)
# GCC 12 warns inside its own std::string where strings are joined (GCC bugs 105329, 105651), also of
# system headers when they are precompiled.
target_compile_options(npdr_flags INTERFACE -Wno-restrict -Wno-array-bounds
                       -Wno-stringop-overflow -Wno-stringop-overread)
# GCC collects its garbage from 600 MB on, not again and again behind the precompiled headers, which
# alone take 200 MB: a seventh of the time, and 0.1 GB more for the largest files.
target_compile_options(npdr_flags INTERFACE
  $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=600000>>)
if(NPDR_NATIVE)
  # GCC 12 warns inside its own AVX-512 header (GCC bug 105593).
  target_compile_options(npdr_flags INTERFACE -Wno-uninitialized -Wno-maybe-uninitialized)
  target_compile_options(npdr_flags INTERFACE -march=native -mprefer-vector-width=512)
elseif(NPDR_BASELINE)
  target_compile_options(npdr_flags INTERFACE -march=${NPDR_BASELINE})
endif()
if(NPDR_WERROR)
  target_compile_options(npdr_flags INTERFACE $<BUILD_INTERFACE:-Werror>)
endif()
if(NPDR_SANITIZE)
  target_compile_options(npdr_flags INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all
                         -fno-omit-frame-pointer)
  target_link_options(npdr_flags INTERFACE -fsanitize=address,undefined)
endif()
if(NPDR_FUZZ)
  target_compile_options(npdr_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()

# What nearly every file includes is compiled once for all libraries, by npdr_core, and once more, with JSON,
# for the upper layers of the pipeline, by npdr_artefacts; for those of them that are compiled quickly by
# npdr_config and npdr_report, and with command lines by npdr_apps; for tests likewise (tests/CMakeLists.txt).
# Benchmarks use npdr_core's, or npdr_apps's with a command line of their own. Those who share it must have the
# owner's flags and definitions. Files still include all that they use: CMAKE_DISABLE_PRECOMPILE_HEADERS with
# NPDR_UNITY=OFF, as in the preset asan and scripts/tidy, shows whether they do.
set(NPDR_COMMON_HEADERS <Eigen/Core> <algorithm> <cmath> <filesystem> <fmt/format.h> <fstream>
                        <functional> <map> <memory> <optional> <set> <string> <vector>)

# npdr_library(<name> [FOLDER <...>] [HEADERS_OF <target>] [WITHOUT <folder>] LINK <...> PRIVATE_LINK <...>): one
# library per folder, of all sources in it and, where the folder isn't given, below the current one, without those
# of the folder WITHOUT. HEADERS_OF: whose precompiled headers it uses, npdr_core's unless given; its own name: it
# makes them itself.
function(npdr_library name)
  cmake_parse_arguments(ARG "" "FOLDER;HEADERS_OF;WITHOUT" "LINK;PRIVATE_LINK" ${ARGN})
  if(NOT ARG_HEADERS_OF)
    set(ARG_HEADERS_OF npdr_core)
  endif()
  if(ARG_FOLDER)
    file(GLOB sources CONFIGURE_DEPENDS ${ARG_FOLDER}/*.cpp)
  else()
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
  endif()
  if(ARG_WITHOUT)
    list(FILTER sources EXCLUDE REGEX "/${ARG_WITHOUT}/[^/]*$")
  endif()
  add_library(${name} STATIC ${sources})
  target_link_libraries(${name} PUBLIC npdr_flags ${ARG_LINK} PRIVATE fmt::fmt ${ARG_PRIVATE_LINK})
  if(NOT name STREQUAL ARG_HEADERS_OF)
    target_precompile_headers(${name} REUSE_FROM ${ARG_HEADERS_OF})
  endif()
endfunction()

# npdr_executable(<name> SOURCES <...> LINK <...>): a program that users call; installed.
function(npdr_executable name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} fmt::fmt)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  install(TARGETS ${name} RUNTIME DESTINATION bin)
endfunction()

# Tests spend their time in the libraries: their own code is compiled quickly.
set(NPDR_TEST_OPTIONS -O1)

# npdr_test(<name> LINK <...> [HEADERS_OF <target>] [EACH_BY_ITSELF] [SUITES <...>]): a GoogleTest program of all
# sources in and below the folder; every TEST is a ctest of its own. Those of SUITES, whose tests share what takes
# long to set up, are one ctest a suite. Files are compiled eight at a time, unless EACH_BY_ITSELF: most of what they
# make the compiler do is the same in all.
function(npdr_test name)
  cmake_parse_arguments(ARG "EACH_BY_ITSELF" "HEADERS_OF" "LINK;SUITES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
  add_executable(${name} ${sources})
  if(NOT ARG_HEADERS_OF)
    set(ARG_HEADERS_OF npdr_test_headers)
  endif()
  if(NOT ARG_EACH_BY_ITSELF)
    set_target_properties(${name} PROPERTIES UNITY_BUILD ${NPDR_UNITY})
  endif()
  target_link_libraries(${name} PRIVATE ${ARG_LINK} npdr_core fmt::fmt GTest::gtest_main)
  target_compile_options(${name} PRIVATE ${NPDR_TEST_OPTIONS})
  target_precompile_headers(${name} REUSE_FROM ${ARG_HEADERS_OF})
  target_compile_definitions(${name} PRIVATE NPDR_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                             NPDR_BINARY_DIR="${PROJECT_BINARY_DIR}")
  foreach(suite ${ARG_SUITES})
    add_test(NAME ${name}/${suite} COMMAND ${name} --gtest_filter=${suite}.*)
    set_tests_properties(${name}/${suite} PROPERTIES TIMEOUT 600)
    string(APPEND elsewhere ":${suite}.*")
  endforeach()
  gtest_discover_tests(${name} TEST_PREFIX ${name}/ DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 600
                       TEST_FILTER "-${elsewhere}")
endfunction()

# npdr_bench(<name> SOURCES <...> LINK <...> [OWN_MAIN]): a Google Benchmark program, or with OWN_MAIN
# one with a command line of its own, compiled quickly; run by hand, never by ctest.
function(npdr_bench name)
  cmake_parse_arguments(ARG "OWN_MAIN" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} fmt::fmt)
  if(ARG_OWN_MAIN)
    target_include_directories(${name} SYSTEM PRIVATE ${CLI11_INCLUDE_DIR})
    target_compile_options(${name} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-O1>)
    target_precompile_headers(${name} REUSE_FROM npdr_apps)
  else()
    target_link_libraries(${name} PRIVATE benchmark::benchmark_main)
    target_precompile_headers(${name} REUSE_FROM npdr_core)
  endif()
endfunction()
