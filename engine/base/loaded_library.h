#pragma once

#include <string>

#include "engine/base/error.h"

namespace fettle::engine {

/// A shared library that is loaded on use instead of with the program, so that what does not need it starts without it and
/// without what it needs in turn. It stays loaded: what libraries register (types, drivers, threads) cannot be taken back.
/// scripts/debian/opened-libraries reads file and package from where an object is made.
class LoadedLibrary {
 public:
  /// `file`: its name with the number of its interface, "libcairo.so.2"; `package`: the Debian package that has it.
  LoadedLibrary(const char* file, const char* package);

  /// Sets `call` to the function of that name, also of the libraries that it needs itself; null where there is none.
  template <class Call>
  void find(const char* name, Call& call) {
    call = reinterpret_cast<Call>(address(name));
  }

  /// Whether it was loaded and all that was looked for was found. Errors (kFailed): the loader's reason, also where the file
  /// is there and a library that it needs is not. `what` cannot be done then, on `where`; `instead`: what can be done besides the
  /// remedy, as ", or write .html", or empty.
  [[nodiscard]] Status status(const char* what, const char* where, const char* instead) const;

 private:
  void* address(const char* name);

  const char* file_;
  const char* package_;
  void* handle_;
  std::string missing_;
};

}  // namespace fettle::engine
