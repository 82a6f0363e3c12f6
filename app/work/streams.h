#pragma once

#include <functional>
#include <memory>
#include <string>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::app {

/// "-": standard input where a scan is read, standard output where one is written. Both use a file in a
/// temporary folder (in $TMPDIR, else /tmp), because a format is recognised by a file's content, read from
/// several positions and completed at the end: so every format can be streamed, and the output is complete.
[[nodiscard]] bool isStream(const std::string& path) noexcept;

/// How messages name a path: "-" is standard input, standard output.
[[nodiscard]] std::string shownInput(const std::string& path);
[[nodiscard]] std::string shownOutput(const std::string& path);

/// A folder for one run, readable by the user only, removed with its content.
class ScratchFolder {
 public:
  /// In the folder `in`, else in that for temporary files. Errors (kFailed): it cannot be written.
  [[nodiscard]] static engine::Result<ScratchFolder> create(const std::string& in = {});
  ScratchFolder(ScratchFolder&&) noexcept = default;
  ScratchFolder& operator=(ScratchFolder&&) noexcept = default;

  [[nodiscard]] const std::string& path() const noexcept { return *path_; }

 private:
  explicit ScratchFolder(std::string path);
  std::shared_ptr<const std::string> path_;  // its deleter removes the folder
};

/// Standard input up to its end, in a file that exists as long as this object.
class StandardInput {
 public:
  /// `extension` with its dot, or empty: the name the file gets. Errors: kInput, it was read before in this
  /// process or cannot be read; kFailed, no room for it; kCancelled, within a tenth of a second.
  [[nodiscard]] static engine::Result<StandardInput> read(const std::string& extension,
                                                          engine::JobControl& job);
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// Gives the file this extension, with its dot: a format that was recognised by the content. Errors: kFailed.
  [[nodiscard]] engine::Status nameAs(const std::string& extension);

  /// The error with "standard input" in the place of the file's path.
  [[nodiscard]] engine::Error renamed(engine::Error error) const;

 private:
  StandardInput(ScratchFolder folder, std::string path);
  ScratchFolder folder_;
  std::string path_;
};

/// From the first call on, what the program prints on standard output goes to standard error, so that only
/// data is on standard output. Call before anything is printed.
void keepStandardOutputForData();

/// Calls write(path) and returns its status. With "-" the path is that of a file with this extension (with
/// its dot), which is then copied to standard output; nothing is written there when `write` fails. Errors of
/// standard output: kFailed for a full disk and for a reader that closed it.
[[nodiscard]] engine::Status writeTo(const std::string& path, const std::string& extension,
                                     engine::JobControl& job,
                                     const std::function<engine::Status(const std::string&)>& write);

}  // namespace fettle::app
