#pragma once

#include <string>

#include <tl/expected.hpp>

namespace fettle::engine {

/// Kind of an Error; it decides the exit status of a command.
enum class ErrorKind {
  kInput,      ///< bad usage, bad input file, path that cannot be read or written: exit 2
  kFailed,     ///< the system failed (full disk, out of memory, no Vulkan device): exit 1
  kCancelled,  ///< the user cancelled; nothing was written: exit 1
};

/// A failure from outside the program (file, device, GPU, user), as a value. Callers' bugs are asserts, not
/// Errors. The three texts form the line shown to the user: "fettle: error: what, where, remedy". No text
/// ends in a full stop or contains a line break.
struct Error {
  ErrorKind kind = ErrorKind::kFailed;
  std::string what;    ///< what went wrong, e.g. "the file ends inside row 37"
  std::string where;   ///< the file, option or device concerned; may be empty
  std::string remedy;  ///< what to do about it; may be empty

  /// The three texts joined by ", ", empty ones left out, control characters replaced by spaces.
  [[nodiscard]] std::string line() const;
};

template <class T>
using Result = tl::expected<T, Error>;

using Status = tl::expected<void, Error>;

[[nodiscard]] tl::unexpected<Error> inputError(std::string what, std::string where, std::string remedy = {});
[[nodiscard]] tl::unexpected<Error> failure(std::string what, std::string where, std::string remedy = {});
[[nodiscard]] tl::unexpected<Error> cancelled();

}  // namespace fettle::engine
