#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/work/background.h"
#include "app/work/loop_client.h"
#include "app/work/scan_reading.h"
#include "engine/measure/align.h"
#include "engine/mosaic/blended.h"

namespace fettle::app {

/// Joins other scans to the field that is worked on, as `fettle mosaic` does; the field stays where it is. The result has more samples than the
/// steps that led to the field, so that it is a session of its own beside the scan; the work here stays as it is. Threading: main.
class JoinTool {
 public:
  /// Edited by the panel.
  struct Options {
    engine::AlignMoves moves;
    engine::Blend blend = engine::Blend::kFade;
    int columns = 0;        ///< of scans in a row; 0: by the places that files state, else searched for
    double overlap = 20.0;  ///< with columns: share of a side that neighbours have in common [%]
  };
  Options options;

  /// A scan to be joined, and how it is to be read.
  struct Scan {
    std::string path;
    ScanOptions reading;
  };
  /// In the order of rows, after the field.
  [[nodiscard]] const std::vector<Scan>& scans() const noexcept { return scans_; }
  void add(Scan scan) { scans_.push_back(std::move(scan)); }
  void remove(std::size_t place) { scans_.erase(scans_.begin() + static_cast<std::ptrdiff_t>(place)); }

  /// Writes the session `path`, which must not exist.
  void write(const LoopClient& client, std::string path);
  void cancel() noexcept { working_.cancel(); }
  /// The session that was written, once, and a notice with how well overlaps fit.
  [[nodiscard]] std::optional<std::string> poll(std::vector<Notice>& notices);

  [[nodiscard]] bool busy() const noexcept { return working_.busy(); }
  [[nodiscard]] WorkProgress progress() const { return working_.progress(); }
  /// Forgets the scans.
  void clear() {
    working_.cancel();
    scans_.clear();
  }

 private:
  struct Work {
    std::string path;
    std::string outcome;
    std::string left_out;  // why no form lies over it; empty: nothing is to be said
  };
  std::vector<Scan> scans_;
  Background<Work> working_;
};

}  // namespace fettle::app
