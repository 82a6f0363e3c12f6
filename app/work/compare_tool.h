#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/work/beside_the_field.h"
#include "app/work/loop_client.h"
#include "app/work/nominal_compare.h"
#include "app/work/scan_reading.h"
#include "engine/measure/align.h"

namespace fettle::app {

/// Another scan, or a nominal mesh, beside the field that is worked on: brought onto it, as `fettle align` does, and what the field deviates from it. The field stays
/// as it is, so that this is no step; it is worked out in the background while the hand goes on. A form over either of them
/// counts: both are compared as they were measured. Threading: main.
class CompareTool {
 public:
  /// Edited by the panel.
  struct Options {
    std::optional<engine::AlignMoves> moves =
        engine::AlignMoves{};                      ///< none: the other scan stays where it is
    engine::Region region = engine::Region::kAll;  ///< samples of the field that count
    NominalChoice nominal;                         ///< of a mesh
  };
  Options options;
  bool shown = true;  ///< colours are the deviation from it

  struct Compared {
    std::string path;
    engine::Version moved;    ///< at the samples of the field; a hole where it has no height
    engine::Version other;    ///< the same, as it is seen under `under`
    engine::FieldForm under;  ///< the form over the field, or null
    bool restored = false;    ///< a form over one of them counts
    std::optional<engine::Alignment> alignment;         ///< none: it was not moved
    double rms_mm = 0.0, mean_mm = 0.0, most_mm = 0.0;  ///< of the field less the other
    std::int64_t samples = 0;                           ///< that both have
    /// Of a mesh: within, above and below the tolerance, where there is one.
    std::optional<std::array<std::int64_t, 3>> tolerated;
    double tolerance_mm = 0.0;
    std::vector<std::string> remarks;  ///< on a mesh
  };

  /// Reads a scan and brings it onto the newest field. One of which nothing lies over the field is refused by a notice of poll().
  void compareWith(const LoopClient& client, std::string path, const ScanOptions& reading);
  /// The same scan with the newest field.
  void again(const LoopClient& client) {
    if (compared() != nullptr) compareWith(client, compared()->path, reading_);
  }
  void cancel() noexcept { work_.cancel(); }
  /// Takes over results. True when something visible changed.
  [[nodiscard]] bool poll(const LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] bool busy() const noexcept { return work_.busy(); }
  [[nodiscard]] WorkProgress progress() const { return work_.progress(); }
  /// What it is at: reading the file that takes long first, or comparing.
  [[nodiscard]] std::string doing() const;
  /// Null before, and of another document.
  [[nodiscard]] const Compared* compared() const noexcept {
    return work_.get() != nullptr ? &work_.get()->compared : nullptr;
  }
  /// The other scan as the field is seen, for its colours; null until it is known under the form over the field.
  [[nodiscard]] const engine::Version* beside(const engine::Version& field) const noexcept;
  /// Whether the field has changed since.
  [[nodiscard]] bool outdated() const noexcept { return work_.outdated(); }
  /// Lines of what was found, as `fettle align` prints them.
  [[nodiscard]] const std::vector<std::string>& lines() const noexcept { return lines_; }
  /// Forgets the other scan.
  void clear();

 private:
  struct Work {
    Compared compared;
    engine::Version samples;  // of the field, without a form
    engine::Version field;    // as it is seen
  };
  [[nodiscard]] static engine::Result<Work> withScan(const engine::Version& field, const std::string& path,
                                                     const ScanOptions& reading, const Options& what,
                                                     std::atomic<bool>& read, engine::JobControl& job);
  [[nodiscard]] static engine::Result<Work> withMesh(const engine::Version& field, const std::string& path,
                                                     const Options& what, engine::JobControl& job);
  [[nodiscard]] static engine::Status see(Work& work, const engine::Version& field, engine::JobControl& job);
  void followForm(const LoopClient& client);

  std::string path_;                         // that is compared, or was
  std::shared_ptr<std::atomic<bool>> read_;  // whether that scan has been read
  ScanOptions reading_;
  std::vector<std::string> lines_;
  bool following_ = false;  // what works is followForm()
  BesideTheField<Work> work_;
};

}  // namespace fettle::app
