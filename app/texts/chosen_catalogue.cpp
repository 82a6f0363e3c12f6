#include "app/texts/chosen_catalogue.h"

#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

std::string wordOf(const char* variable) {
  const char* const value = std::getenv(variable);  // NOLINT(concurrency-mt-unsafe): no thread sets it
  return value != nullptr ? value : "";
}

}  // namespace

LanguageWords languageWords() {
  LanguageWords words{wordOf("FETTLE_TEXTS"), wordOf("LANGUAGE"), ""};
  for (const char* variable : {"LC_ALL", "LC_MESSAGES", "LANG"})
    if (words.locale.empty()) words.locale = wordOf(variable);
  return words;
}

std::vector<std::string> catalogueNames(const LanguageWords& words) {
  std::vector<std::string> names;
  const std::string_view locale = words.locale;
  if (locale.empty() || locale == "POSIX" || locale.substr(0, locale.find('.')) == "C") return names;
  for (std::string_view rest = words.language.empty() ? locale : std::string_view(words.language);
       !rest.empty();) {
    const std::size_t colon = rest.find(':');
    const std::string_view each = rest.substr(0, colon);
    rest = colon == std::string_view::npos ? std::string_view() : rest.substr(colon + 1);
    const std::string_view place = each.substr(0, each.find_first_of(".@")),
                           tongue = place.substr(0, place.find('_'));
    // No name leads out of the folders.
    if (tongue.empty() || place.find('/') != std::string_view::npos) continue;
    if (tongue == "en") break;
    names.emplace_back(place);
    if (tongue != place) names.emplace_back(tongue);
  }
  return names;
}

std::vector<std::string> catalogueFolders() {
  std::vector<std::string> folders;
  const std::string own = wordOf("XDG_DATA_HOME"), home = wordOf("HOME");
  if (!own.empty())
    folders.push_back(own + "/fettle/texts");
  else if (!home.empty())
    folders.push_back(home + "/.local/share/fettle/texts");
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) folders.push_back((program.parent_path().parent_path() / "share/fettle/texts").string());
  return folders;
}

engine::Result<std::optional<Catalogue>> chosenCatalogue(const LanguageWords& words,
                                                         const std::vector<std::string>& folders) {
  std::string path = words.file;
  std::error_code error;
  if (path.empty()) {
    for (const std::string& name : catalogueNames(words))
      for (const std::string& folder : folders)
        if (const fs::path file = fs::path(folder) / (name + ".mo"); path.empty() && fs::exists(file, error))
          path = file.string();
    if (path.empty()) return std::nullopt;
  }
  auto catalogue = Catalogue::read(path);
  if (!catalogue) return tl::unexpected(catalogue.error());
  return std::optional(*std::move(catalogue));
}

}  // namespace fettle::app
