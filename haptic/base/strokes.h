#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "haptic/base/tools.h"

namespace fettle::haptic {

/// One tick of a recorded stylus session.
struct StrokeSample {
  double t = 0.0;          ///< [s] as recorded; the replay runs one tick per row whatever the value
  glm::dvec3 tip_mm{0.0};  ///< endpoint in field coordinates [mm] (see engine::Grid)
  Tool tool = Tool::kFeel;

  friend bool operator==(const StrokeSample&, const StrokeSample&) = default;
};

/// The result of one tick.
struct ForceSample {
  double t = 0.0;            ///< [s]
  glm::dvec3 proxy_mm{0.0};  ///< point on the surface while in contact, else the endpoint [mm]
  glm::dvec3 force_n{0.0};   ///< force on the hand [N], clamped to the scene's limit
  bool contact = false;

  friend bool operator==(const ForceSample&, const ForceSample&) = default;
};

/// Reads a strokes file: CSV, first line exactly `t,x,y,z,tool`, then one row per tick; LF or CRLF; a last
/// line without line end and blank lines at the end are accepted. Numbers in any form std::from_chars
/// accepts,
/// "nan" and "inf" included (a recorded dropout: the tick treats it as no input).
/// Errors (kInput, naming the line, counted from 1 with the header): unreadable path, wrong header, wrong
/// number of columns, a field that is not a number, a number outside double's range, an unknown tool.
/// Memory: the file plus 40 bytes per row. Thread: any.
[[nodiscard]] engine::Result<std::vector<StrokeSample>> readStrokes(const std::string& path);

/// Writes a strokes file, whole or not at all. Numbers are the shortest that read back to the same double.
/// Errors: kInput, the path cannot be written; kFailed, full disk.
[[nodiscard]] engine::Status writeStrokes(const std::string& path, std::span<const StrokeSample> strokes);

/// A strokes file written during a session: whole or not at all, as writeStrokes. A program that is killed
/// leaves the temporary file in the folder of the final path: a strokes file with all rows that were flushed.
/// Threading: one thread at a time; writes to the disk, so not on the loop's thread. Errors as writeStrokes.
class StrokesWriter {
 public:
  [[nodiscard]] static engine::Result<StrokesWriter> create(const std::string& path);
  StrokesWriter(StrokesWriter&&) noexcept;
  StrokesWriter& operator=(StrokesWriter&&) noexcept;
  ~StrokesWriter();  ///< without commit(): the temporary file is removed

  [[nodiscard]] engine::Status append(const StrokeSample& row);
  /// Passes all rows so far to the operating system.
  [[nodiscard]] engine::Status flush();
  /// Renames the file to its final path; at most once, last.
  [[nodiscard]] engine::Status commit();

 private:
  class Rows;
  explicit StrokesWriter(std::unique_ptr<Rows> rows) noexcept;
  std::unique_ptr<Rows> rows_;
};

/// Writes a forces file, whole or not at all: CSV `t,proxy_x,proxy_y,proxy_z,fx,fy,fz,contact`; seconds,
/// millimetres, newtons, contact 0 or 1. Errors as writeStrokes.
[[nodiscard]] engine::Status writeForces(const std::string& path, std::span<const ForceSample> forces);

}  // namespace fettle::haptic
