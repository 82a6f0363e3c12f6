# Options that every room shares. A room is one static library; it sees only what it links.

# Hidden symbols, and the promise that no definition is replaced at load time (-fno-semantic-interposition), keep calls
# and inlining of position-independent code as they are in a program: docs/decisions/python-module.md has the figures.
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)

add_library(fettle_options INTERFACE)
target_compile_features(fettle_options INTERFACE cxx_std_20)
target_include_directories(fettle_options INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(fettle_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wno-float-conversion
  -Wnon-virtual-dtor -Woverloaded-virtual -Werror
  # Same bits on every compiler and optimisation level: a fused multiply-add rounds once where
  # the written code rounds twice, so contraction is never left to the compiler.
  -ffp-contract=off
  # One set of objects for the program and for the Python module, a shared library.
  -fPIC -fno-semantic-interposition)

set(FETTLE_SANITIZE "" CACHE STRING "address,undefined or thread; empty for none")
if(FETTLE_SANITIZE)
  target_compile_options(fettle_options INTERFACE
    -fsanitize=${FETTLE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(fettle_options INTERFACE -fsanitize=${FETTLE_SANITIZE})
endif()

# clang, for scripts/fuzz alone: the project's warnings are gcc's.
option(FETTLE_FUZZ "Build for coverage-guided fuzzing" OFF)
if(FETTLE_FUZZ)
  target_compile_options(fettle_options INTERFACE
    -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -w)
  target_link_options(fettle_options INTERFACE -fsanitize=address,undefined)
endif()

# For scripts/mutate alone: tests tell which planted errors they come past.
option(FETTLE_PLANTED "Some sources have planted errors" OFF)

# fettle_room(name LINKS targets...): a room's library; its folders add sources with target_sources.
function(fettle_room name)
  cmake_parse_arguments(ARG "" "" "LINKS" ${ARGN})
  add_library(fettle_${name} STATIC)
  target_link_libraries(fettle_${name} PUBLIC fettle_options ${ARG_LINKS})
endfunction()

# For test programs and what only they link. Optimising the expectations of a test takes longer than running them, with
# a sanitizer's checks in them twice as long as not to; what they call is optimised as the program is. Reference filters
# that run for seconds do without this.
function(fettle_test_options target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  if(FETTLE_SANITIZE)
    target_compile_options(${target} PRIVATE -O0)
  endif()
  if(target STREQUAL fettle_test_support)
    target_precompile_headers(${target} PRIVATE ${FETTLE_COMMON_HEADERS} <gtest/gtest.h>)
  else()
    # Their macros are part of what was compiled.
    target_link_libraries(${target} PRIVATE fettle_test_support)
    target_precompile_headers(${target} REUSE_FROM fettle_test_support)
  endif()
endfunction()

# Adds a test program to a target that builds a part of the tests.
function(fettle_group group program)
  if(NOT TARGET ${group})
    add_custom_target(${group})
  endif()
  add_dependencies(${group} ${program})
endfunction()

# fettle_test(name SOURCES files... LINKS targets... [LABELS label] [DRAWS] [SERIAL]): one test program.
# SERIAL: its cases play in real time, so none runs at the same time as another test.
# Every case is its own CTest entry, so a failure names the sentence that broke. The first label says what the program
# needs; DRAWS programs need a Vulkan device.
function(fettle_test name)
  cmake_parse_arguments(ARG "DRAWS;SERIAL" "TIMEOUT" "SOURCES;LINKS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  add_executable(${name})
  fettle_sources(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} GTest::gtest_main)
  if(FETTLE_PLANTED)
    target_link_libraries(${name} PRIVATE fettle_map_cases)
  endif()
  fettle_test_options(${name})
  # What scripts/test builds of a preset that does not run everything.
  if(ARG_LABELS MATCHES "^(concurrency|live)$")
    fettle_group(concurrency_tests ${name})
  endif()
  if(ARG_LABELS STREQUAL "numeric")
    fettle_group(numeric_tests ${name})
  endif()
  if(NOT ARG_DRAWS AND NOT ARG_LABELS STREQUAL "instructions")
    fettle_group(sanitized_tests ${name})
    # What scripts/test calls a part of them: the tests of a folder, by the libraries that they need.
    file(RELATIVE_PATH folder ${CMAKE_SOURCE_DIR}/tests ${CMAKE_CURRENT_SOURCE_DIR})
    if(folder MATCHES "^engine/")
      fettle_group(sanitized_tests_engine ${name})
    elseif(folder MATCHES "^(app|bench|docs|end_to_end)(/|$)")
      fettle_group(sanitized_tests_app ${name})
    else()
      fettle_group(sanitized_tests_hand ${name})
    endif()
  endif()
  # Only properties with a value, and no more than one label: CTest's script is made from a flat list, in which an
  # empty value swallows the name of the next property and a second label is taken for one.
  set(properties TIMEOUT ${ARG_TIMEOUT})
  if(ARG_LABELS)
    list(APPEND properties LABELS "${ARG_LABELS}")
  endif()
  if(ARG_SERIAL)
    list(APPEND properties RUN_SERIAL TRUE)
  endif()
  # Libraries that the Vulkan loader brings in and unloads again leak a little at exit, without a name left to
  # suppress them by: programs that draw are checked for everything but leaks.
  if(ARG_DRAWS)
    list(APPEND properties ENVIRONMENT LSAN_OPTIONS=detect_leaks=0)
  endif()
  # What scripts/test does not build of a sanitizer's preset has one entry, which it leaves out by its label.
  if(FETTLE_SANITIZE AND (ARG_DRAWS OR ARG_LABELS STREQUAL "instructions"))
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES ${properties})
  else()
    gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 PROPERTIES ${properties})
  endif()
endfunction()
