#include "engine/base/loaded_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

namespace fettle::engine {

// Lazily, as a program is: with RTLD_NOW all functions of all libraries would be looked up.
LoadedLibrary::LoadedLibrary(const char* file, const char* package)
    : file_(file), package_(package), handle_(dlopen(file, RTLD_LAZY | RTLD_LOCAL)) {
  if (handle_ != nullptr) return;
  const char* why = dlerror();
  missing_ = why != nullptr ? why : fmt::format("{}: cannot be loaded", file);
}

void* LoadedLibrary::address(const char* name) {
  if (handle_ == nullptr) return nullptr;
  void* found = dlsym(handle_, name);
  if (found == nullptr && missing_.empty()) missing_ = fmt::format("{}: it has no {}", file_, name);
  return found;
}

Status LoadedLibrary::status(const char* what, const char* where, const char* instead) const {
  if (missing_.empty()) return {};
  return failure(fmt::format("{}: {}", what, missing_), where,
                 fmt::format("install the package {}{}", package_, instead));
}

}  // namespace fettle::engine
