#include "engine/base/error.h"

#include <utility>

namespace fettle::engine {

std::string Error::line() const {
  std::string text;
  for (const std::string* part : {&what, &where, &remedy}) {
    if (part->empty()) continue;
    if (!text.empty()) text += ", ";
    text += *part;
  }
  // A file name may contain any byte; an error remains one line on the terminal.
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return text;
}

tl::unexpected<Error> inputError(std::string what, std::string where, std::string remedy) {
  return tl::unexpected(Error{ErrorKind::kInput, std::move(what), std::move(where), std::move(remedy)});
}

tl::unexpected<Error> failure(std::string what, std::string where, std::string remedy) {
  return tl::unexpected(Error{ErrorKind::kFailed, std::move(what), std::move(where), std::move(remedy)});
}

tl::unexpected<Error> cancelled() {
  return tl::unexpected(Error{ErrorKind::kCancelled, "cancelled", {}, "nothing was written"});
}

}  // namespace fettle::engine
