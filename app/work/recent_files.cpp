#include "app/work/recent_files.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace fettle::app {

std::string userFolder(const char* variable, const char* under_home) {
  namespace fs = std::filesystem;
  fs::path folder;
  if (const char* named = std::getenv(variable); named != nullptr && *named != '\0')
    folder = named;
  else if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    folder = fs::path(home) / under_home;
  else
    return {};
  folder /= "fettle";
  std::error_code error;
  fs::create_directories(folder, error);
  return error ? std::string() : folder.string();
}

std::string settingsFolder() {
  return userFolder("XDG_CONFIG_HOME", ".config");
}

std::string recentFile() {
  const std::string folder = settingsFolder();
  return folder.empty() ? std::string() : folder + "/recent.txt";
}

RecentFiles::RecentFiles(std::string file) : file_(std::move(file)) {
  std::ifstream in(file_);
  for (std::string line; paths_.size() < kMost && std::getline(in, line);)
    if (!line.empty()) paths_.push_back(line);
}

void RecentFiles::add(const std::string& path) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(path, error);
  const std::string kept = error ? path : absolute.lexically_normal().string();
  if (kept.find('\n') != std::string::npos) return;
  std::erase(paths_, kept);
  paths_.insert(paths_.begin(), kept);
  if (paths_.size() > kMost) paths_.resize(kMost);
  if (file_.empty()) return;
  std::ofstream out(file_, std::ios::trunc);
  for (const std::string& p : paths_) out << p << '\n';
}

}  // namespace fettle::app
