#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fettle::haptic {

/// Where a maker's installer puts a library.
struct LibraryPlaces {
  std::string_view file;         ///< "libHD.so"; a version may follow in the file's name
  std::string_view environment;  ///< variable that names the file, or a folder with it, instead of all places
  std::string_view tree;         ///< folder that is searched with all below it, as "/opt/OpenHaptics"
  std::string_view package;      ///< what the maker calls what has to be installed
};

/// A library that its maker installs, opened when it is asked for. None of it is part of Fettle: the calls are
/// declared here by what is documented of them. It stays loaded until the program ends, since such libraries
/// leave threads behind.
///
/// Search: the file that the environment names, and then nothing else; otherwise the loader's own places
/// (LD_LIBRARY_PATH, /etc/ld.so.conf), /usr/lib, /usr/local/lib, and the maker's tree.
class VendorLibrary {
 public:
  explicit VendorLibrary(const LibraryPlaces& places);

  [[nodiscard]] bool loaded() const noexcept { return handle_ != nullptr; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// Places that were tried, in order, for the user.
  [[nodiscard]] const std::vector<std::string>& looked() const noexcept { return looked_; }

  /// What is wrong, as one sentence: not found, not loadable (the loader's words), or without a call that is
  /// needed. Empty when nothing is.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }
  /// What to do about it.
  [[nodiscard]] std::string remedy() const;

  /// Looks up a call that is needed; without it the library cannot be used.
  template <class Call>
  void find(const char* name, Call& call) {
    call = reinterpret_cast<Call>(symbol(name));
    if (call == nullptr) noteMissing(name);
  }
  /// Null when the library has none.
  template <class Call>
  void findOptional(const char* name, Call& call) {
    call = reinterpret_cast<Call>(symbol(name));
  }

 private:
  [[nodiscard]] void* symbol(const char* name) const noexcept;
  void noteMissing(const char* name);
  bool tryFile(const std::string& path);

  LibraryPlaces places_;
  void* handle_ = nullptr;
  std::string path_;
  std::string problem_;
  std::string loader_;  // why a file that exists cannot be loaded
  std::vector<std::string> looked_;
};

}  // namespace fettle::haptic
