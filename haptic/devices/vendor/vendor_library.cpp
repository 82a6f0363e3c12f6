#include "haptic/devices/vendor/vendor_library.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace fettle::haptic {

namespace {

// libdhd.so, libdhd.so.3, libdhd.so.3.17.6, but not libdhd.so.txt.
bool isLibrary(const std::string& name, std::string_view file) {
  return name.starts_with(file) && name.find_first_not_of(".0123456789", file.size()) == std::string::npos;
}

// Shortest name first: the one without a version is what the maker links against.
std::vector<std::string> sorted(std::vector<std::string> files) {
  std::ranges::sort(files, [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  return files;
}

std::vector<std::string> filesIn(const std::filesystem::path& folder, std::string_view file) {
  std::vector<std::string> found;
  std::error_code error;
  for (auto it = std::filesystem::directory_iterator(folder, error);
       !error && it != std::filesystem::directory_iterator(); it.increment(error))
    if (isLibrary(it->path().filename().string(), file)) found.push_back(it->path().string());
  return sorted(std::move(found));
}

// Some levels only: a link to a parent, or a whole disk mounted there, must not hold up a listing.
std::vector<std::string> filesBelow(const std::filesystem::path& folder, std::string_view file) {
  constexpr int kDeepest = 6;
  std::vector<std::string> found;
  std::error_code error;
  auto it = std::filesystem::recursive_directory_iterator(
      folder, std::filesystem::directory_options::skip_permission_denied, error);
  for (; !error && it != std::filesystem::recursive_directory_iterator(); it.increment(error)) {
    if (it.depth() >= kDeepest) it.disable_recursion_pending();
    if (isLibrary(it->path().filename().string(), file)) found.push_back(it->path().string());
  }
  return sorted(std::move(found));
}

}  // namespace

VendorLibrary::VendorLibrary(const LibraryPlaces& places) : places_(places) {
  const std::string file(places.file);
  const char* const named = std::getenv(std::string(places.environment).c_str());
  if (named != nullptr && *named != '\0') {
    std::error_code error;
    if (std::filesystem::is_directory(named, error)) {
      // Where the maker's archive was unpacked.
      looked_.push_back(fmt::format("{} in {} and the folders in it ({})", file, named, places.environment));
      bool found = false;
      for (const std::string& path : filesBelow(named, places.file)) found = found || tryFile(path);
    } else {
      looked_.push_back(fmt::format("{} ({})", named, places.environment));
      tryFile(named);
    }
  } else {
    looked_.push_back(fmt::format("{} in LD_LIBRARY_PATH and the system's folders", file));
    bool found = tryFile(file);
    for (const char* folder : {"/usr/lib", "/usr/local/lib"}) {
      if (found) break;
      looked_.push_back(folder);
      for (const std::string& path : filesIn(folder, places.file)) found = found || tryFile(path);
    }
    if (!found && !places.tree.empty()) {
      looked_.push_back(fmt::format("{} and the folders in it", places.tree));
      for (const std::string& path : filesBelow(places.tree, places.file)) found = found || tryFile(path);
    }
  }
  if (handle_ != nullptr) return;
  problem_ = loader_.empty() ? fmt::format("{} is not installed", file)
                             : fmt::format("{} cannot be loaded: {}", file, loader_);
}

bool VendorLibrary::tryFile(const std::string& path) {
  // The name alone is searched by the loader; its message is then only that there is none.
  std::error_code error;
  const bool exists = path.find('/') != std::string::npos && std::filesystem::exists(path, error);
  if (path.find('/') != std::string::npos && !exists) return false;
  handle_ = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (handle_ != nullptr) {
    path_ = path;
    return true;
  }
  const char* const why = dlerror();
  if (why == nullptr) return false;
  // Found by the loader's own search, but a library that it needs is not there.
  const std::string words = why;
  if (exists || !words.starts_with(places_.file)) loader_ = words;
  return false;
}

std::string VendorLibrary::remedy() const {
  if (handle_ != nullptr)
    return fmt::format("install a current version of {}; {} was loaded", places_.package, path_);
  return fmt::format("install {}, or name its file or folder with {}; looked for {}", places_.package,
                     places_.environment, fmt::join(looked_, ", "));
}

void* VendorLibrary::symbol(const char* name) const noexcept {
  return handle_ == nullptr ? nullptr : dlsym(handle_, name);
}

void VendorLibrary::noteMissing(const char* name) {
  if (problem_.empty()) problem_ = fmt::format("{} has no call {}", path_, name);
}

}  // namespace fettle::haptic
