#pragma once

#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/formats/formats.h"

namespace fettle::engine {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInf = std::numeric_limits<float>::infinity();

inline void writeBytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

inline std::string readBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline Result<Imported> load(const std::string& path, const ImportOptions& options = {}) {
  JobControl job;
  return importField(path, options, job);
}

inline Result<Exported> save(const Version& field, const std::string& path,
                             const ExportOptions& options = {}) {
  JobControl job;
  return exportField(field, path, options, job);
}

/// Sample by row and column from the first STORED row of a top-down file.
inline float stored(const Version& field, std::int32_t row, std::int32_t column) {
  return field.reader().heightAt(column, field.grid().height - 1 - row);
}

inline bool warned(const std::vector<std::string>& warnings, const std::string& part) {
  for (const std::string& warning : warnings)
    if (warning.find(part) != std::string::npos) return true;
  return false;
}

/// The heights of a field, row 0 first.
inline std::vector<float> heightsOf(const Version& field) {
  std::vector<float> heights(static_cast<std::size_t>(field.grid().samples()));
  field.reader().readHeights(0, 0, field.grid().width, field.grid().height, heights.data(),
                             field.grid().width);
  return heights;
}

inline Grid gridOf(std::int32_t width, std::int32_t height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  return grid;
}

}  // namespace fettle::engine

/// Declares `var`, the Imported of a file that must be readable.
#define FETTLE_LOAD(var, ...)                                                                        \
  ::fettle::engine::Result<::fettle::engine::Imported> var##_ = ::fettle::engine::load(__VA_ARGS__); \
  ASSERT_TRUE(var##_) << var##_.error().line();                                                      \
  [[maybe_unused]] const ::fettle::engine::Imported& var = *var##_
