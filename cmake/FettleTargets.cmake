# Options that every room shares. A room is one static library; it sees only what it links.

add_library(fettle_options INTERFACE)
target_compile_features(fettle_options INTERFACE cxx_std_20)
target_include_directories(fettle_options INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(fettle_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wno-float-conversion
  -Wnon-virtual-dtor -Woverloaded-virtual -Werror
  # Same bits on every compiler and optimisation level: a fused multiply-add rounds once where
  # the written code rounds twice, so contraction is never left to the compiler.
  -ffp-contract=off)

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

# fettle_room(name LINKS targets...): a room's library; its folders add sources with target_sources.
function(fettle_room name)
  cmake_parse_arguments(ARG "" "" "LINKS" ${ARGN})
  add_library(fettle_${name} STATIC)
  target_link_libraries(fettle_${name} PUBLIC fettle_options ${ARG_LINKS})
endfunction()

# fettle_test(name SOURCES files... LINKS targets... [LABELS label] [DRAWS] [SERIAL]): one test program.
# SERIAL: its cases play in real time, so none runs beside another test.
# Every case is its own CTest entry, so a failure names the sentence that broke.
function(fettle_test name)
  cmake_parse_arguments(ARG "DRAWS;SERIAL" "TIMEOUT" "SOURCES;LINKS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} fettle_test_support GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE FETTLE_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  if(ARG_LABELS MATCHES "^(concurrency|live)$")
    if(NOT TARGET concurrency_tests)
      add_custom_target(concurrency_tests)  # what the thread sanitizer runs; see .ci/run
    endif()
    add_dependencies(concurrency_tests ${name})
  endif()
  if(ARG_LABELS STREQUAL "numeric")
    if(NOT TARGET numeric_tests)
      add_custom_target(numeric_tests)  # what is run without optimisation; see scripts/test
    endif()
    add_dependencies(numeric_tests ${name})
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
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 PROPERTIES ${properties})
endfunction()
