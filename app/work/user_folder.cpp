#include "app/work/user_folder.h"

#include <cstdlib>
#include <filesystem>
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

}  // namespace fettle::app
