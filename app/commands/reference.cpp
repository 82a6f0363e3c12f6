#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/chrono.h>

#include "app/commands/command.h"
#include "app/reference/completion.h"
#include "app/reference/man_page.h"
#include "app/reference/reference_page.h"
#include "app/reference/report_schema.h"
#include "engine/io/files/atomic_file.h"

namespace fettle::app {

namespace {

// One file of the folder, by its path in it.
engine::Status write(const std::string& folder, const std::string& name, const std::string& text) {
  const std::filesystem::path path = std::filesystem::path(folder) / name;
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  if (error)
    return engine::inputError("the folder cannot be created: " + error.message(), path.parent_path().string(),
                              "name a folder with write permission");
  return engine::writeFileAtomically(path.string(), text);
}

// The day that SOURCE_DATE_EPOCH names [s since 1970, UTC], as builds state the date of their source: pages of one source are the
// same whenever they are made. Empty without it.
std::string sourceDate() {
  const char* const typed =
      std::getenv("SOURCE_DATE_EPOCH");  // NOLINT(concurrency-mt-unsafe): no thread sets it
  const std::string text = typed == nullptr ? "" : typed;
  std::int64_t seconds = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  constexpr std::int64_t kMost = 253'402'300'799;  // year 9999
  if (error != std::errc{} || end != text.data() + text.size() || seconds < 0 || seconds > kMost) return {};
  return fmt::format("{:%F}", std::chrono::sys_seconds(std::chrono::seconds(seconds)));
}

engine::Result<Report> reference(const std::string& folder, const CommandTable& root) {
  const ManVersion version{"fettle " FETTLE_VERSION, sourceDate()};
  int pages = 0;
  engine::Status status;
  forEachCommand(root, [&](const CommandTable& command) {
    if (!status) return;
    status = write(folder, "man/" + manName(command) + ".1", manPage(command, root, version));
    ++pages;
  });
  std::vector<std::pair<std::string, std::string>> others = {
      {"completion/fettle.bash", completionScript(root, Shell::kBash)},
      {"completion/_fettle", completionScript(root, Shell::kZsh)},
      {"completion/fettle.fish", completionScript(root, Shell::kFish)},
      {"reference.md", referencePage(root)},
      {"parameters.json", tableReport(root).dump(2) + "\n"}};
  for (const ReportSchema& schema : reportSchemas())
    others.emplace_back("schema/" + schemaFile(schema), schemaReport(schema).dump(2) + "\n");
  for (const auto& [name, text] : others)
    if (status) status = write(folder, name, text);
  if (!status) return tl::unexpected(status.error());
  int parameters = 0;
  forEachCommand(root, [&](const CommandTable& c) { parameters += static_cast<int>(c.parameters.size()); });
  return Report{{"folder", folder},
                {"man_pages", pages},
                {"parameters", parameters},
                {"schemas", reportSchemas().size()}};
}

}  // namespace

void addReference(Command root, Chosen& chosen) {
  auto folder = std::make_shared<std::string>();
  Command command =
      addCommand(root, chosen, "reference",
                 "Write man pages, completions for bash, zsh and fish, the reference of all commands, and "
                 "the schemas of "
                 "--json",
                 [folder, root](engine::JobControl&) { return reference(*folder, root.table()); });
  command.add({{.name = "DIR",
                .to = folder.get(),
                .text = "Folder for them, created if missing",
                .kind = ValueKind::kFolder,
                .required = true}});
  command.examples(
      {{"fettle reference pages", "Then: source pages/completion/fettle.bash, man pages/man/fettle.1"}});
}

}  // namespace fettle::app
