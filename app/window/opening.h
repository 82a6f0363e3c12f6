#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/files/scan_thumbnail.h"
#include "app/work/background.h"
#include "app/work/coarse_slot.h"
#include "app/work/open_document.h"
#include "engine/base/stopwatch.h"

namespace fettle::app {

/// Times since opening the newest scan was requested [ms]: it was read, it could be touched, it was visible,
/// and all of it was on the device; 0: not yet.
struct OpeningTimes {
  engine::Stopwatch since_asked;
  double coarse_ms = 0.0;  ///< a coarse picture was visible; 0: there was none
  double read_ms = 0.0, touched_ms = 0.0, seen_ms = 0.0, whole_ms = 0.0;
};

/// A scan or session that was read.
struct Opened {
  Document document;
  /// Its picture, where something about its numbers was guessed and nobody has said yet that it is right.
  std::shared_ptr<const ScanThumbnail> guessed;
};

/// Whether a person is asked where something about a scan was guessed.
enum class Guesses : std::uint8_t { kTake, kAsk };

/// A scan or session that is being opened: read in the background, with a coarse picture shown until then if
/// nothing else is open. The coarse picture can be viewed from all sides, nothing else: it is not a document,
/// no loop runs, nothing can be touched, changed or saved. Threading: main.
class Opening {
 public:
  /// Begins to read; cancels a reading in progress. `instead`: a document is open and stays until this one is
  /// read. Requires dropCoarse() for the previous coarse picture.
  void start(const std::string& path, Recovery recovery, const ScanOptions& reading, Guesses guesses,
             bool instead);
  void cancel() { loading_.cancel(); }
  /// The result of reading, once.
  [[nodiscard]] std::optional<engine::Result<Opened>> take() { return loading_.take(); }
  [[nodiscard]] bool busy() const noexcept { return loading_.busy(); }
  [[nodiscard]] WorkProgress progress() const { return loading_.progress(); }
  [[nodiscard]] const char* stage() const noexcept { return loading_.stage(); }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::string fileName() const;

  /// Takes a coarse picture, unless a document is `open`. True when a new one was taken.
  [[nodiscard]] bool takeCoarse(bool open);
  [[nodiscard]] const engine::Preview* coarse() const noexcept { return coarse_ ? &*coarse_ : nullptr; }
  [[nodiscard]] std::string coarseText() const;
  /// Ends it. False when there is none.
  bool dropCoarse();

  [[nodiscard]] const OpeningTimes& times() const noexcept { return times_; }
  /// The newest scan was read; `instead` of a document.
  void noteRead(bool instead);
  void noteTouched() { times_.touched_ms = times_.since_asked.ms(); }
  /// The first picture is being drawn, as announced by the frame before it.
  void noteAnnounced() noexcept { announced_ = true; }
  [[nodiscard]] bool announced() const noexcept { return announced_; }
  /// A frame was shown: of the coarse picture; of the document; of the document completely on the device.
  enum class Frame : std::uint8_t { kNothing, kCoarse, kDocument, kWhole };
  void noteFrame(Frame frame);

 private:
  [[nodiscard]] static Background<Opened>::Work work(const std::string& path, Recovery recovery,
                                                     const ScanOptions& reading, Guesses guesses,
                                                     std::shared_ptr<CoarseSlot> slot, bool coarse_first);

  std::string path_;
  engine::Stopwatch since_asked_;
  std::shared_ptr<CoarseSlot> slot_;  // of the newest reading
  std::optional<engine::Preview> coarse_;
  OpeningTimes times_;
  bool announced_ = false;
  Background<Opened> loading_;
};

}  // namespace fettle::app
