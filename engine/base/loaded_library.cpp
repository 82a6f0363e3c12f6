#include "engine/base/loaded_library.h"

#include <utility>

#include <dlfcn.h>
#include <fmt/format.h>

namespace fettle::engine {

LoadedLibrary::LoadedLibrary(const char* file, const char* package)
    : LoadedLibrary(std::span(&static_cast<const std::string&>(std::string(file)), 1),
                    fmt::format("install the package {}", package)) {}

LoadedLibrary::LoadedLibrary(std::span<const std::string> files, std::string remedy)
    : remedy_(std::move(remedy)) {
  for (const std::string& file : files) {
    // Lazily, as a program is: with RTLD_NOW all functions of all libraries would be looked up.
    handle_ = dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (handle_ != nullptr) {
      file_ = file;
      missing_.clear();
      return;
    }
    const char* why = dlerror();
    missing_ += fmt::format("{}{}", missing_.empty() ? "" : "; ",
                            why != nullptr ? why : fmt::format("{}: cannot be loaded", file));
  }
}

void* LoadedLibrary::address(const char* name) {
  if (handle_ == nullptr) return nullptr;
  void* found = dlsym(handle_, name);
  if (found == nullptr && missing_.empty()) missing_ = fmt::format("{}: it has no {}", file_, name);
  return found;
}

Status LoadedLibrary::status(const char* what, const char* where, const char* instead) const {
  if (missing_.empty()) return {};
  return failure(fmt::format("{}: {}", what, missing_), where, remedy_ + instead);
}

}  // namespace fettle::engine
