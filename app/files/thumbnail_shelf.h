#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <optional>
#include <string>

#include "app/files/scan_thumbnail.h"
#include "app/work/background.h"
#include "app/work/scan_reading.h"

namespace fettle::app {

/// Pictures of scans that are not open, read one after the other in the background and kept: the least recently asked for
/// is dropped first. Threading: main.
class ThumbnailShelf {
 public:
  static constexpr int kSide = 160;         ///< pixels
  static constexpr std::size_t kMost = 32;  ///< kept

  /// What is known of a scan.
  struct Shown {
    const ScanThumbnail* picture = nullptr;  ///< null: not read yet, or cannot be
    const engine::Error* problem = nullptr;  ///< why it cannot be read
  };

  /// The picture of a scan as `reading` reads it; asks for it where it is not there, the newest request first.
  /// Valid until poll() or forget().
  [[nodiscard]] Shown find(const std::string& path, const ScanOptions& reading);
  /// A picture that was made elsewhere.
  void put(const std::string& path, const ScanOptions& reading, ScanThumbnail picture);
  /// True when something was read.
  bool poll();
  [[nodiscard]] bool busy() const noexcept { return job_.busy() || wanted_.has_value(); }
  /// Nothing more is read, and what was is dropped: files may have changed.
  void forget();

 private:
  struct Key {
    std::string path, reading;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct Kept {
    Key key;
    std::optional<ScanThumbnail> picture;
    std::optional<engine::Error> problem;
  };
  struct Request {
    Key key;
    ScanOptions reading;
  };

  void begin();
  void keep(Kept kept);

  std::list<Kept> kept_;           // most recently asked for first
  std::optional<Request> wanted_;  // next
  std::optional<Key> reading_;     // now
  Background<ScanThumbnail> job_;
};

}  // namespace fettle::app
