// session_hand_driver FILE SEED create|resume READY
// A person at work on a session, on the real loop, until the program is killed. Reports on stdout, a line
// each:
//   ready             the loop runs; the file READY is made as well
//   doing             something is begun
//   kept NUMBER HASH  state NUMBER, of that content, is the field now, and nothing waits to be written

#include <cstdio>
#include <cstdlib>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "app/work/open_document.h"
#include "tests/app/work/hand_play.h"
#include "tests/app/work/part.h"

using namespace fettle;

namespace {

// Straight to the system: what was written stays written when the process is killed next.
void report(const std::string& text) {
  if (write(STDOUT_FILENO, text.data(), text.size()) < 0) std::exit(0);
}

int refuse(const engine::Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());
  return 1;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 5) return 2;
  const std::string path = arguments[1];
  const bool creates = arguments[3] == std::string("create");
  app::Document document;
  if (creates) {
    document.path = path + ".tif";
    document.original = tests::roughPart();
    document.history = engine::History(document.original);
  } else {
    engine::JobControl job;
    auto opened = app::openDocument(path, {}, app::Recovery::kLeave, std::size_t{1} << 28, job);
    if (!opened) return refuse(opened.error());
    document = *std::move(opened);
    if (!document.writer) return refuse({engine::ErrorKind::kFailed, document.warnings.front(), path, ""});
  }
  const engine::History history = document.history;
  app::SessionKeeper keeper(document);
  if (creates) keeper.saveAs(path, engine::OriginalStorage::kEmbedded);
  auto client = app::LoopClient::start(history, document.original, tests::brushScene(), {}, &keeper);
  if (!client) return refuse(client.error());
  tests::HandPlay play(**client, keeper, std::strtoull(arguments[2], nullptr, 10));
  report("ready\n");
  if (std::FILE* ready = std::fopen(arguments[4], "w")) std::fclose(ready);
  std::string before;  // written with what follows it, in one write
  for (;;) {
    report(before + "doing\n");
    static_cast<void>(play.act());
    play.settle();
    play.untilKept();
    if (const auto error = keeper.error()) return refuse(*error);
    const engine::History& now = (*client)->history();
    before = fmt::format("kept {} {:016x}\n", now.number(), tests::storedHash(now.current()));
  }
}
