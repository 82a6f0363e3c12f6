# What keeps an empty compiler cache cheap: most of the time a file of this project takes to compile goes into the
# standard library's and other libraries' headers, and into template code that every file makes again.

# fettle_sources(target files... [APART files...]): adds sources of the current folder to a target. The files are
# compiled together, some fifteen to a translation unit, so names in anonymous namespaces are unique within a folder.
# APART: each by itself, for kernels whose code must not depend on their neighbours and for -inl.h files that are
# included once per instruction set. With FETTLE_TOGETHER=OFF every file is apart (what clang-tidy reads).
# Sources with planted errors (scripts/mutate) are compiled once and run for less than that takes.
function(fettle_planted target unit)
  foreach(file ${ARGN})
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${file}.planted)
      set_source_files_properties(${unit} TARGET_DIRECTORY ${target} PROPERTIES
        COMPILE_OPTIONS "-O1;-finline-small-functions")
    endif()
  endforeach()
endfunction()

option(FETTLE_TOGETHER "Compile the files of a folder together" ON)
function(fettle_sources target)
  cmake_parse_arguments(ARG "" "" "APART" ${ARGN})
  set(together ${ARG_UNPARSED_ARGUMENTS})
  target_sources(${target} PRIVATE ${ARG_APART})
  foreach(file ${ARG_APART})
    fettle_planted(${target} ${file} ${file})
  endforeach()
  list(LENGTH together count)
  if(NOT FETTLE_TOGETHER OR count LESS 2)
    target_sources(${target} PRIVATE ${together})
    foreach(file ${together})
      fettle_planted(${target} ${file} ${file})
    endforeach()
    return()
  endif()
  file(RELATIVE_PATH folder ${CMAKE_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  math(EXPR units "(${count} + 14) / 15")
  foreach(unit RANGE 1 ${units})
    math(EXPR begin "${count} * (${unit} - 1) / ${units}")
    math(EXPR length "${count} * ${unit} / ${units} - ${begin}")
    list(SUBLIST together ${begin} ${length} files)
    list(GET files 0 first)
    set(planted ${files})
    string(REGEX REPLACE "[./]" "_" first ${first})
    # Paths within the tree, not of this machine: the compiler cache then serves every checkout.
    list(TRANSFORM files REPLACE "(.+)" "#include \"${folder}/\\1\"\n")
    list(JOIN files "" text)
    set(path ${CMAKE_CURRENT_BINARY_DIR}/together/${target}_${first}.cpp)
    file(CONFIGURE OUTPUT ${path} CONTENT "${text}" @ONLY)
    target_sources(${target} PRIVATE ${path})
    fettle_planted(${target} ${path} ${planted})
  endforeach()
endfunction()

# Headers that nearly every file includes, compiled once. None of the project's own: those change.
set(FETTLE_COMMON_HEADERS
  <algorithm> <array> <atomic> <bit> <chrono> <cmath> <condition_variable> <cstdint> <cstring> <filesystem> <fstream> <functional>
  <limits> <map> <memory> <mutex> <numeric> <optional> <span> <sstream> <string> <string_view> <thread> <tuple>
  <unordered_map> <utility> <variant> <vector> <fmt/format.h> <tl/expected.hpp>)
